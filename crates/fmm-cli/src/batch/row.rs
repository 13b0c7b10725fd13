//! The row of one record.

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use clap::Parser;
use fmm_fit::{EstimateStatus, Options};
use fmm_identify::{Comparison, Experiment, Finding, Origin, compare_observed, search_observed};
use serde::{Deserialize, Serialize};

use super::campaign::{Campaign, write_at_once};
use crate::input::{Given, Question};

/// What `fmm identify` is told of one record.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, args_override_self = true, allow_negative_numbers = true, disable_help_flag = true)]
pub(crate) struct OfRecord {
    #[command(flatten)]
    given: Given,
    #[command(flatten)]
    question: Question,
}

/// What became of one record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) file: PathBuf,
    /// What describes it, by column of the manifest.
    pub(crate) description: BTreeMap<String, String>,
    /// What was found.
    pub(crate) found: Option<Found>,
    /// Why nothing was.
    pub(crate) refused: Option<String>,
}

/// What was found in a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Found {
    /// The channel and what it was taken for.
    pub(crate) origin: String,
    pub(crate) law: String,
    pub(crate) is_decided: bool,
    pub(crate) findings: Vec<Told>,
    pub(crate) rms_residual: f64,
    pub(crate) unit: String,
    pub(crate) half_swings: usize,
    pub(crate) warnings: Vec<String>,
}

/// A quantity of the machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Told {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) value: f64,
    /// Standard uncertainty, if the record determines it.
    pub(crate) u: Option<f64>,
    /// Without it, infinitely many.
    pub(crate) degrees_of_freedom: Option<f64>,
}

impl Row {
    /// Identifies the record of this index.
    pub(crate) fn of(campaign: &Campaign, index: usize) -> Self {
        let entry = &campaign.entries[index];
        let options = campaign.options.iter().chain(&entry.options).cloned();
        let arguments = OfRecord::try_parse_from(options.chain(["--".to_owned(), entry.file.display().to_string()]));
        let found =
            arguments.map_err(|error| first_line(&error.to_string()).into()).and_then(|arguments| found(&arguments));
        let (found, refused) = match found {
            Ok(found) => (Some(found), None),
            Err(error) => (None, Some(error.to_string())),
        };
        Self { file: entry.file.clone(), description: entry.description.clone(), found, refused }
    }

    fn path(folder: &Path, index: usize) -> PathBuf {
        folder.join("rows").join(format!("{index:07}.json"))
    }

    /// The row of this index in a folder, if it was written.
    pub(crate) fn read(folder: &Path, index: usize) -> Option<Self> {
        serde_json::from_str(&std::fs::read_to_string(Self::path(folder, index)).ok()?).ok()
    }

    pub(crate) fn write(&self, folder: &Path, index: usize) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(write_at_once(&Self::path(folder, index), &serde_json::to_string(self)?)?)
    }

    /// What was found of a quantity of this name.
    pub(crate) fn value(&self, name: &str) -> Option<&Told> {
        self.found.as_ref()?.findings.iter().find(|value| value.name == name)
    }
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned()
}

fn found(arguments: &OfRecord) -> Result<Found, Box<dyn Error>> {
    let OfRecord { given, question } = arguments;
    let input = given.read()?;
    let preparation = given.preparation().gain_uncertainty(question.scale_u);
    let decay = question.seen(Experiment::ring_down(&input.record, &preparation)?)?;
    let (machine, candidates) = (question.machine(false)?, question.candidates()?);
    let decays = std::slice::from_ref(&decay);
    let go_on = |_: &str, _: &fmm_fit::Progress<'_>| ControlFlow::Continue(());
    let comparison: Comparison = if candidates.is_empty() {
        search_observed(&machine, decays, &question.search()?, &Options::default(), go_on)?
    } else {
        compare_observed(&machine, decays, &candidates, &Options::default(), go_on)?
    };
    let preferred = comparison.preferred();
    let is_of_machine =
        |finding: &&Finding| !finding.is_of_record() && finding.origin() != Origin::Fitted(EstimateStatus::Fixed);
    let value = |finding: &Finding| Told {
        name: finding.parameter().name().to_owned(),
        unit: finding.parameter().unit().to_owned(),
        value: finding.value(),
        u: finding.uncertainty(),
        degrees_of_freedom: Some(finding.degrees_of_freedom()).filter(|freedom| freedom.is_finite()),
    };
    let warnings = input.warnings.into_iter().chain(comparison.warnings().iter().map(ToString::to_string));
    Ok(Found {
        origin: input.origin,
        law: preferred.law().to_owned(),
        is_decided: comparison.is_decided(),
        findings: preferred.findings().iter().filter(is_of_machine).map(value).collect(),
        rms_residual: preferred.rms_residual(),
        unit: decay.record().unit().to_owned(),
        half_swings: decay.summary().half_swings,
        warnings: warnings.collect(),
    })
}
