//! Options of one record in a campaign: what `fmm identify` is told of it.

use std::error::Error;
use std::path::Path;

use clap::Parser;
use fmm_identify::Experiment;

use crate::input::{Given, Input, Question};

/// The options of one record.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, args_override_self = true, allow_negative_numbers = true, disable_help_flag = true)]
pub(crate) struct RecordOptions {
    #[command(flatten)]
    pub(super) given: Given,
    #[command(flatten)]
    pub(super) question: Question,
}

impl RecordOptions {
    /// What these `options` tell of the record in a `file`.
    pub(super) fn of(options: impl Iterator<Item = String>, file: &Path) -> Result<Self, Box<dyn Error>> {
        let arguments = options.chain(["--".to_owned(), file.display().to_string()]);
        Ok(Self::try_parse_from(arguments).map_err(|error| first_line(&error.to_string()))?)
    }

    /// The record as it was read, and as it is fitted.
    pub(crate) fn prepared(&self) -> Result<(Input, Experiment), Box<dyn Error>> {
        let input = self.given.read_mode()?;
        let preparation = self.given.preparation().gain_uncertainty(self.question.scale_u);
        let experiment = self.question.seen(Experiment::ring_down(&input.record, &preparation)?)?;
        Ok((input, experiment))
    }
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned()
}
