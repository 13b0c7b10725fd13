//! The row of one record.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Display;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use fmm_fit::EstimateStatus;
use fmm_identify::{Finding, Identification, Origin, Severity, Source};
use fmm_record::Record;
use fmm_uq::Budget;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::campaign::{Campaign, Entry, RecordOptions};
use super::curve::RowCurve;
use crate::files;
use crate::host::Host;

/// Result of one record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Row {
    #[serde(serialize_with = "files::shown")]
    pub(crate) file: PathBuf,
    /// Description by column of the manifest.
    pub(crate) description: BTreeMap<String, String>,
    /// True for a record that the manifest leaves out.
    #[serde(default)]
    pub(crate) is_excluded: bool,
    #[serde(flatten)]
    pub(crate) outcome: Outcome<Found>,
}

/// Findings, or the reason of a refusal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub(crate) enum Outcome<T> {
    Found(T),
    Refused(String),
}

impl<T> Outcome<T> {
    /// The findings, unless there was a refusal.
    pub(crate) fn found(&self) -> Option<&T> {
        match self {
            Self::Found(found) => Some(found),
            Self::Refused(_) => None,
        }
    }
}

impl<T> From<Result<T, Box<dyn Error>>> for Outcome<T> {
    fn from(result: Result<T, Box<dyn Error>>) -> Self {
        result.map_or_else(|error| Self::Refused(error.to_string()), Self::Found)
    }
}

/// Findings of one record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Found {
    /// The channel and what it was taken for.
    pub(crate) origin: String,
    pub(crate) law: String,
    pub(crate) is_decided: bool,
    pub(crate) findings: Vec<Told>,
    /// Mass, stiffness, damping and load as they were declared, with their standard uncertainties.
    pub(crate) declared: BTreeMap<String, (f64, f64)>,
    /// Declared inputs with an uncertainty.
    pub(crate) stated: Vec<Stated>,
    pub(crate) rms_residual: f64,
    pub(crate) unit: String,
    /// Largest amplitude, in the unit of the record.
    pub(crate) amplitude: f64,
    pub(crate) half_swings: usize,
    pub(crate) rate_hz: f64,
    pub(crate) duration_s: f64,
    pub(crate) warnings: Vec<String>,
    /// Those of the warnings that doubt the fit.
    pub(crate) doubts: Vec<String>,
    /// Friction over the speed, no law assumed, or why there is none.
    pub(crate) friction_curve: Outcome<RowCurve>,
    /// SHA-256 of the samples as they were read, by which copies are known.
    pub(crate) samples: String,
}

/// A quantity of the machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Told {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) value: f64,
    /// Standard uncertainty, if the record determines it.
    pub(crate) u: Option<f64>,
    /// Without it, infinitely many.
    pub(crate) degrees_of_freedom: Option<f64>,
    /// Contributions to u by source.
    pub(crate) contributions: Vec<Part>,
}

/// A part of an uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Part {
    pub(crate) source: String,
    /// Contribution to the uncertainty, in the unit of the quantity.
    pub(crate) u: f64,
}

/// An input that was stated with an uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Stated {
    /// The source of uncertainty that it is.
    pub(crate) source: String,
    /// Value in the unit of its option, as u is.
    pub(crate) value: f64,
    pub(crate) u: f64,
}

impl Row {
    /// Identifies the record of this index.
    pub(crate) fn of(campaign: &Campaign, index: usize, host: &Host<'_>) -> Self {
        let entry = &campaign.entries[index];
        let outcome = match &entry.excluded {
            None => campaign.record(index).and_then(|record| found(&record, campaign.without_curves, host)).into(),
            Some(reason) if reason.is_empty() => Outcome::Refused("left out by the manifest".to_owned()),
            Some(reason) => Outcome::Refused(format!("left out by the manifest: {reason}")),
        };
        let is_excluded = entry.excluded.is_some();
        Self { file: entry.file.clone(), description: entry.description.clone(), is_excluded, outcome }
    }

    /// True if it counts in what the records say together: it was identified, and no warning doubts its fit, unless
    /// such records are asked for as well.
    pub(crate) fn counts(&self, with_doubtful: bool) -> bool {
        self.found().is_some_and(|found| with_doubtful || found.doubts.is_empty())
    }

    /// Findings of the record, unless it was refused.
    pub(crate) fn found(&self) -> Option<&Found> {
        self.outcome.found()
    }

    /// Refuses all but the first of rows with equal samples: copies are no further evidence.
    pub(crate) fn without_copies(mut rows: Vec<Self>) -> Vec<Self> {
        let mut first: BTreeMap<String, PathBuf> = BTreeMap::new();
        for row in &mut rows {
            let Some(samples) = row.found().map(|found| found.samples.clone()) else { continue };
            match first.get(&samples) {
                Some(file) => {
                    let why = format!("the same samples as {}, which counts for both", file.display());
                    row.outcome = Outcome::Refused(why);
                }
                None => drop(first.insert(samples, row.file.clone())),
            }
        }
        rows
    }

    fn path(folder: &Path, index: usize) -> PathBuf {
        folder.join("rows").join(format!("{index:07}.json"))
    }

    /// The row of this index in a folder, if it was written for this `entry` as it is.
    pub(crate) fn read(folder: &Path, index: usize, entry: &Entry) -> Option<Self> {
        let row: Self = serde_json::from_str(&std::fs::read_to_string(Self::path(folder, index)).ok()?).ok()?;
        let is_same = row.file.to_string_lossy() == entry.file.to_string_lossy();
        (is_same && row.description == entry.description).then_some(row)
    }

    /// True if the row of this index has to be made: there is none for this `entry`, or its record is newer.
    pub(crate) fn is_due(folder: &Path, index: usize, entry: &Entry) -> bool {
        let changed = |path: &Path| std::fs::metadata(path).and_then(|data| data.modified()).ok();
        let is_newer = || changed(&entry.file).zip(changed(&Self::path(folder, index))).is_some_and(|(a, b)| a > b);
        Self::read(folder, index, entry).is_none() || is_newer()
    }

    pub(crate) fn write(&self, folder: &Path, index: usize) -> Result<(), String> {
        let text = serde_json::to_string(self).map_err(|error| error.to_string())?;
        files::write(&Self::path(folder, index), &text)
    }

    /// Friction curve of the record, if it has one.
    pub(super) fn curve(&self) -> Option<&RowCurve> {
        self.found()?.friction_curve.found()
    }

    /// Finding of this name and unit, or what the friction curve states under it.
    pub(crate) fn told(&self, (name, unit): (&str, &str)) -> Option<&Told> {
        let stated = self.curve().into_iter().flat_map(|curve| &curve.stated);
        self.found()?.findings.iter().chain(stated).find(|told| told.name == name && told.unit == unit)
    }
}

/// A value with its unit, unless that is 1.
pub(super) fn in_unit(value: impl Display, unit: &str) -> String {
    if unit == "1" { value.to_string() } else { format!("{value} {unit}") }
}

/// Names and units of all quantities of `rows`, in the order in which they first appear.
pub(crate) fn quantities<'a>(rows: &[&'a Row]) -> Vec<(&'a str, &'a str)> {
    named(rows.iter().filter_map(|row| row.found()).flat_map(|found| &found.findings))
}

/// The same of what the friction curves state.
pub(super) fn curve_quantities(rows: &[Row]) -> Vec<(&str, &str)> {
    named(rows.iter().filter_map(Row::curve).flat_map(|curve| &curve.stated))
}

fn named<'a>(told: impl Iterator<Item = &'a Told>) -> Vec<(&'a str, &'a str)> {
    tally(told.map(|told| (told.name.as_str(), told.unit.as_str()))).into_iter().map(|(name, _)| name).collect()
}

/// Each of the items once, with how often it is there, in the order in which they first appear.
pub(super) fn tally<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<(T, usize)> {
    let mut counts: Vec<(T, usize)> = Vec::new();
    for item in items {
        match counts.iter_mut().find(|(other, _)| *other == item) {
            Some((_, count)) => *count += 1,
            None => counts.push((item, 1)),
        }
    }
    counts
}

/// Identifies one record.
fn found(record: &RecordOptions, without_curve: bool, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
    let begun = Instant::now();
    let (input, decay) = record.prepared(host)?;
    let candidates = record.question.candidates(host)?;
    let comparison =
        record.question.answer(std::slice::from_ref(&decay), &candidates, |_, _| ControlFlow::Continue(()))?;
    let preferred = comparison.preferred();
    let gain = Some((Source::Gain, record.given.choice.scale.unwrap_or(1.0), record.question.scale_u))
        .filter(|gain| gain.2 > 0.0);
    let clock = Some((Source::Clock, 1.0, record.given.choice.rate_u)).filter(|clock| clock.2 > 0.0);
    let stated = record.question.stated().chain(gain).chain(clock);
    let doubting = || comparison.warnings().iter().filter(|warning| warning.severity() == Severity::Doubt);
    let doubts = doubting().map(ToString::to_string).collect();
    let samples = fingerprint(&input.record);
    let friction_curve = if without_curve {
        Outcome::Refused("left out by --no-curves".to_owned())
    } else {
        let curve = record.question.friction_curve(preferred, std::slice::from_ref(&decay), begun);
        let of_record = doubting().filter(|warning| !warning.spares_curve()).map(ToString::to_string);
        curve.map_or_else(Outcome::Refused, |curve| Outcome::Found(RowCurve::of(&curve, of_record)))
    };
    let warnings = input.warnings.into_iter().chain(comparison.warnings().iter().map(ToString::to_string));
    Ok(Found {
        origin: input.origin,
        law: preferred.law().to_owned(),
        is_decided: comparison.is_conclusive(),
        findings: told(preferred),
        declared: record.question.declared().collect(),
        stated: stated.map(|(source, value, u)| Stated { source: source.to_string(), value, u }).collect(),
        rms_residual: preferred.rms_residual(),
        unit: decay.record().unit().to_owned(),
        amplitude: decay.summary().amplitudes.0,
        half_swings: decay.summary().half_swings,
        rate_hz: decay.record().rate(),
        duration_s: decay.record().duration(),
        warnings: warnings.collect(),
        doubts,
        friction_curve,
        samples,
    })
}

/// SHA-256 of the samples and their interval.
fn fingerprint(record: &Record) -> String {
    let mut digest = Sha256::new();
    for number in std::iter::once(record.interval()).chain(record.values().iter().copied()) {
        digest.update(number.to_le_bytes());
    }
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().concat()
}

/// Findings of the machine.
pub(super) fn told(found: &Identification) -> Vec<Told> {
    let is_of_machine =
        |finding: &&Finding| !finding.is_of_record() && finding.origin() != Origin::Fitted(EstimateStatus::Fixed);
    let value = |finding: &Finding| Told {
        name: finding.parameter().name().to_owned(),
        unit: finding.parameter().unit().to_owned(),
        value: finding.value(),
        u: finding.uncertainty(),
        degrees_of_freedom: Some(finding.degrees_of_freedom()).filter(|freedom| freedom.is_finite()),
        contributions: finding
            .budget()
            .iter()
            .flat_map(Budget::contributions)
            .map(|part| Part { source: part.input.name().to_owned(), u: part.uncertainty })
            .collect(),
    };
    found.findings().iter().filter(is_of_machine).map(value).collect()
}
