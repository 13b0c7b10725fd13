//! Document of `fmm force`: the findings of measured forces, for programs.

use std::error::Error;

use fmm_identify::{Finding, ForceLoop, ForceRecord, Identification, Onset, SpeedBin, Validation};
use serde::Serialize;

use super::columns::Columns;
use super::{BINS, Found, LOADS};
use crate::answer::Detail;
use crate::output::pair;

/// Forces along motions for programs; units are those of each record, SI but for forces in volts and the like. A list
/// that ends in `_u` is a value and its standard uncertainty. Lists of lists have one list a record.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Content<'a> {
    columns: Vec<OfFile<'a>>,
    /// Number of all samples that were fitted.
    samples: usize,
    /// Friction over the speed without a law.
    friction_over_speed: Vec<Vec<Bin>>,
    loops: Vec<Vec<Loop>>,
    /// Onsets of sliding.
    onsets: Vec<Vec<OfOnset>>,
    models: Vec<Tried<'a>>,
    /// Model that is preferred.
    preferred: &'a str,
    /// `fit`, or `prediction` of the records to which nothing was fitted.
    preferred_by: &'static str,
    is_decided: bool,
    warnings: Vec<String>,
}

/// Columns of a file by their meaning.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct OfFile<'a> {
    file: String,
    columns: &'a Columns,
}

/// Friction at speeds that are alike.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Bin {
    speed: f64,
    friction_u: [f64; 2],
    /// Mean of both directions.
    offset_u: Option<[f64; 2]>,
    /// Normal load, where it was measured (N).
    load: Option<f64>,
    /// Friction over the load (1).
    coefficient_u: Option<[f64; 2]>,
    samples: usize,
}

/// A closed cycle of the motion.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Loop {
    /// Begin and end (s).
    span: [f64; 2],
    /// Least and largest position.
    range: [f64; 2],
    energy_u: [f64; 2],
    friction_u: [f64; 2],
    stiffness_u: [f64; 2],
}

/// A reversal up to where the contact slides.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct OfOnset {
    /// Begin (s).
    begin: f64,
    /// Direction of the motion, 1 or -1.
    direction: f64,
    stiffness_u: [f64; 2],
    breakaway_u: [f64; 2],
    sliding_u: [f64; 2],
    /// Way up to sliding.
    displacement: f64,
}

/// A model that was fitted.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Tried<'a> {
    model: &'a str,
    samples: usize,
    rms_residual: f64,
    /// Root mean square of the residuals over that of the force (1).
    share_of_force: Option<f64>,
    findings: Vec<OfFinding<'a>>,
    not_fitted: Vec<Predicted>,
    warnings: Vec<String>,
    /// Samples of each record, by `--json=full`.
    #[serde(skip_serializing_if = "Option::is_none")]
    fits: Option<Vec<Samples<'a>>>,
}

/// A quantity that was found.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct OfFinding<'a> {
    name: &'a str,
    unit: &'a str,
    value: f64,
    u: Option<f64>,
    interval_95: Option<(f64, f64)>,
    /// Why there is no interval.
    no_interval: Option<&'static str>,
}

/// Prediction by a model of a record to which it was not fitted.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Predicted {
    file: String,
    rms: f64,
    share_of_force: Option<f64>,
}

/// A record and its fit, sample by sample.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Samples<'a> {
    unit: &'a str,
    time_s: &'a [f64],
    velocity: &'a [f64],
    measured: &'a [f64],
    /// Fitted force of each sample; none where the model says nothing.
    fitted: Vec<Option<f64>>,
    /// Measured less fitted.
    residuals: Vec<Option<f64>>,
}

impl<'a> Content<'a> {
    pub(super) fn of(found: &'a Found, detail: Detail) -> Result<Self, Box<dyn Error>> {
        let columns = found.all().map(|read| OfFile { file: read.file.display().to_string(), columns: &read.columns });
        let of_warnings = found.compared.warnings().iter().map(ToString::to_string);
        let records = || found.fitted.iter().map(|read| &read.record);
        let files: Vec<String> = found.others.iter().map(|read| read.file.display().to_string()).collect();
        let model = |(identified, validations)| Tried::of(identified, &files, validations);
        let mut models: Vec<Tried<'a>> = found.models().map(model).collect();
        if detail == Detail::Full {
            for (model, (identified, _)) in models.iter_mut().zip(found.models()) {
                model.fits = Some(records().map(|record| Samples::of(record, identified)).collect::<Result<_, _>>()?);
            }
        }
        Ok(Self {
            columns: columns.collect(),
            samples: records().map(ForceRecord::len).sum(),
            friction_over_speed: records().map(speeds).collect(),
            loops: records().map(|record| record.loops().iter().map(Loop::of).collect()).collect(),
            onsets: records().map(|record| record.onsets().iter().map(OfOnset::of).collect()).collect(),
            models,
            preferred: found.compared.preferred().law(),
            preferred_by: if found.others.is_empty() { "fit" } else { "prediction" },
            is_decided: found.compared.is_decided(),
            warnings: found.remarks.iter().cloned().chain(of_warnings).collect(),
        })
    }
}

fn speeds(record: &ForceRecord) -> Vec<Bin> {
    let bin = |bin: &SpeedBin| Bin {
        speed: bin.speed,
        friction_u: pair(bin.friction),
        offset_u: bin.offset.map(pair),
        load: bin.load,
        coefficient_u: bin.coefficient().map(pair),
        samples: bin.samples,
    };
    record.friction_over_speed_and_load(BINS, LOADS).iter().map(bin).collect()
}

impl Loop {
    fn of(cycle: &ForceLoop) -> Self {
        Self {
            span: cycle.span,
            range: cycle.range,
            energy_u: pair(cycle.energy),
            friction_u: pair(cycle.friction),
            stiffness_u: pair(cycle.stiffness),
        }
    }
}

impl OfOnset {
    fn of(onset: &Onset) -> Self {
        Self {
            begin: onset.begin,
            direction: onset.direction,
            stiffness_u: pair(onset.stiffness),
            breakaway_u: pair(onset.breakaway),
            sliding_u: pair(onset.sliding),
            displacement: onset.displacement,
        }
    }
}

impl<'a> Tried<'a> {
    fn of(found: &'a Identification, files: &[String], validations: &[Validation]) -> Self {
        let finding = |finding: &'a Finding| OfFinding {
            name: finding.parameter().name(),
            unit: finding.parameter().unit(),
            value: finding.value(),
            u: finding.uncertainty(),
            interval_95: finding.interval(0.95),
            no_interval: finding.without_interval(),
        };
        let predicted = |(file, said): (&String, &Validation)| Predicted {
            file: file.clone(),
            rms: said.rms,
            share_of_force: said.share(),
        };
        let doubts = validations.iter().filter_map(|said| said.warning(found.law()));
        Self {
            model: found.law(),
            samples: found.samples(),
            rms_residual: found.rms_residual(),
            share_of_force: found.share_of_force(),
            findings: found.findings().iter().map(finding).collect(),
            not_fitted: files.iter().zip(validations).map(predicted).collect(),
            warnings: found.warnings().iter().map(ToString::to_string).chain(doubts.map(|w| w.to_string())).collect(),
            fits: None,
        }
    }
}

impl<'a> Samples<'a> {
    fn of(record: &'a ForceRecord, found: &Identification) -> Result<Self, Box<dyn Error>> {
        let (measured, fitted) = (record.forces(), found.predict(record)?);
        let residuals = measured.iter().zip(&fitted).map(|(force, said)| Some(force - (*said)?)).collect();
        let (time_s, velocity) = (record.times(), record.velocities());
        Ok(Self { unit: record.force_unit(), time_s, velocity, measured, fitted, residuals })
    }
}
