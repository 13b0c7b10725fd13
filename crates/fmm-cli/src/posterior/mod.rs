//! The posterior of what was found in a record, in builds with the feature `posterior`.

#[cfg(feature = "posterior")]
mod corner;
#[cfg(feature = "posterior")]
mod sampled;

#[cfg(feature = "posterior")]
pub(crate) use sampled::Posterior;
#[cfg(not(feature = "posterior"))]
pub(crate) use unavailable::Posterior;

/// Stand-in for a posterior in builds without one.
#[cfg(not(feature = "posterior"))]
mod unavailable {
    use std::error::Error;

    use fmm_identify::{Experiment, Identification};
    use serde::Serialize;

    const WHY: &str = "this program was built without the posterior, which takes a minute more to compile: run cargo \
                       with `--features posterior`";

    /// A posterior of which there is none.
    #[derive(Serialize)]
    pub(crate) enum Posterior {}

    impl Posterior {
        /// Why there is none, for whoever asks before the fit.
        pub(crate) const REFUSAL: Option<&'static str> = Some(WHY);

        /// Refuses.
        pub(crate) fn of(_: &Identification, _: &[Experiment]) -> Result<Self, Box<dyn Error>> {
            Err(WHY.into())
        }

        pub(crate) fn text(&self) -> String {
            match *self {}
        }

        pub(crate) fn html(&self) -> String {
            match *self {}
        }
    }
}
