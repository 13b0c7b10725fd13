//! What stands for a posterior in builds without one.

use std::error::Error;

use fmm_identify::{Experiment, Identification};
use serde::Serialize;

/// A posterior of which there is none.
#[derive(Serialize)]
pub(crate) enum Posterior {}

impl Posterior {
    /// Refuses.
    pub(crate) fn require() -> Result<(), Box<dyn Error>> {
        Err("this program was built without the posterior, which takes a minute more to compile: run cargo with \
             `--features posterior`"
            .into())
    }

    /// Refuses.
    pub(crate) fn of(_: &Identification, _: &Experiment) -> Result<Self, Box<dyn Error>> {
        Err(Self::require().map_or_else(|error| error, |()| "there is no posterior".into()))
    }

    pub(crate) fn text(&self) -> String {
        match *self {}
    }

    pub(crate) fn html(&self) -> String {
        match *self {}
    }
}
