//! Friction out of the records of a motion: `fmm identify FILE ..` and `fmm compare FILE ..`.
//!
//! Reads a record of displacement, velocity or acceleration, prepares it, fits it by one law or by several, and gives
//! out findings, their uncertainties, and the limits of the record. The quantity of a channel follows from its unit, a
//! word in its name, or options; a guess is refused.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use crate::answer::{Answer, Detail, Document, FittedRecord};
use crate::figure::{drawn, histogram, label};
use crate::host::Host;
use crate::input::{Choice, DRIVE, Given, Question};
use crate::output::{Output, Wanted};
use crate::posterior::Posterior;
use crate::refusal::{Kind, placed};
use crate::report::{self, Curve, Found, Pictures};
use clap::Args;
use fmm_fit::Minimizer;
use fmm_identify::{Candidate, Comparison, Drive, Experiment, ImpactTrial, Preparation};
use fmm_record::{Column, Quantity, Record};
use serde::Serialize;

/// Identifies the friction of a machine from the record of its free vibration.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    given: Given,
    /// Further records of the same machine, read by the same options: all are fitted together, with an initial state
    /// and an offset for each
    #[arg(value_name = "FILE", conflicts_with = DRIVE)]
    further: Vec<PathBuf>,
    /// The normal load (N) on the contact in each record, in the order of the files
    #[arg(long, value_name = "N,..", value_delimiter = ',', conflicts_with = "normal_load")]
    normal_loads: Vec<f64>,
    #[command(flatten)]
    question: Question,
    /// The channel with the measured force (N) that drives the machine; without it and --base, the machine vibrates
    /// freely. Without mass and stiffness, both are found
    #[arg(long, value_name = "NAME|INDEX", group = DRIVE)]
    force: Option<Column>,
    /// The channel with the measured motion of the base that drives the machine, best its acceleration
    #[arg(long, value_name = "NAME|INDEX", group = DRIVE)]
    base: Option<Column>,
    /// The channel with the force (N) of a hammer whose impact the machine answers. With --mass and --stiffness
    /// friction is found, without them mass and stiffness as well
    #[arg(long, value_name = "NAME|INDEX", group = DRIVE)]
    impact: Option<Column>,
    /// Fit the lines of the mobility between two frequencies (Hz) in place of the motion after the impact
    #[arg(long, value_name = "LOW,HIGH", requires = "impact", value_parser = band)]
    mobility: Option<(f64, f64)>,
    /// Draw from the posterior of the preferred law: its intervals beside the others, and records that it predicts
    /// beside the measured one; in builds with the feature `posterior`
    #[arg(long)]
    posterior: bool,
    #[command(flatten)]
    output: Output,
    /// Write a page with everything into this file: record, fit, residuals, findings, laws, warnings, and how it was
    /// made
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
}

impl Arguments {
    /// Forms in which the answer is wanted.
    pub(crate) fn wanted(&self) -> Wanted {
        Wanted { output: self.output.clone(), report: self.report.clone() }
    }
}

/// Two frequencies (Hz), the lower one first.
fn band(text: &str) -> Result<(f64, f64), String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([low, high]) if low < high && *low >= 0.0 => Ok((*low, *high)),
        _ => Err(format!("a band is two frequencies in Hz, the lower one first, such as 1,4, but this is {text:?}")),
    }
}

/// The force that was measured in `channel` of the file.
fn measured(
    arguments: &Arguments,
    channel: &Column,
    quantity: Option<Quantity>,
    host: &Host<'_>,
) -> Result<Record, Box<dyn Error>> {
    let file = arguments.given.file.as_ref().ok_or("the bundled record is one of a free vibration; give a file")?;
    let (time, rate) = (arguments.given.choice.time.clone(), arguments.given.choice.rate);
    let choice = Choice { channel: Some(channel.clone()), time, rate, quantity, is_drive: true, ..Choice::default() };
    Ok(choice.read(file, host)?.record)
}

/// The experiment of the record, with its drive and its sensor.
fn experiment(
    arguments: &Arguments,
    record: &Record,
    preparation: &Preparation,
    host: &Host<'_>,
) -> Result<Experiment, Box<dyn Error>> {
    let force = |channel: &Column| measured(arguments, channel, Some(Quantity::Force), host);
    let experiment = if let Some(channel) = &arguments.impact {
        let trial = ImpactTrial::prepare(&force(channel)?, record)?;
        match arguments.mobility {
            Some(_) => Experiment::mobility(&trial, arguments.mobility)?,
            None => Experiment::impact(&trial)?,
        }
    } else if let Some(channel) = &arguments.force {
        Experiment::driven(record, Drive::force(&force(channel)?)?, preparation)?
    } else if let Some(channel) = &arguments.base {
        Experiment::driven(record, Drive::base(&measured(arguments, channel, None, host)?)?, preparation)?
    } else {
        return arguments.question.free(record, preparation);
    };
    arguments.question.seen(experiment)
}

/// Fits all candidates and tells how far they are.
fn fitted(
    question: &Question,
    decays: &[Experiment],
    candidates: &[Candidate],
    host: &Host<'_>,
) -> Result<Comparison, Box<dyn Error>> {
    let samples = decays.iter().map(|decay| decay.summary().samples).sum::<usize>() as f64;
    host.while_working(|tell| {
        let show = |law: &str, progress: &Minimizer| {
            let rms = (progress.sum_of_squares() / samples).sqrt();
            tell(format!("{law}: step {}, rms residual {rms:.4e}", progress.iterations()))
        };
        question.answer(decays, candidates, show)
    })?
}

/// Document for programs: the comparison, and what was asked for beside it.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Content<'a> {
    /// The file, the channel, what it was taken for, and how its sampling rate was found.
    origin: &'a str,
    /// Faults of the file.
    remarks: &'a [String],
    /// Declared inputs of the machine: value and standard uncertainty of `mass` (kg), `stiffness` (N/m), `damping` (N
    /// s/m) and `normal_load` (N).
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    declared: &'a BTreeMap<String, (f64, f64)>,
    #[serde(flatten)]
    comparison: &'a Comparison,
    /// Friction over the speed, no law assumed; of `identify` alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    friction_curve: Option<&'a Curve>,
    /// Posterior of the preferred law, by `--posterior`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(with = "Option<serde_json::Value>"))]
    posterior: Option<&'a Posterior>,
    /// Samples of the preferred law, by `--json=full`.
    #[serde(skip_serializing_if = "Option::is_none")]
    fit: Option<Samples<'a>>,
    /// The same of the further records, in their order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    further_fits: Vec<Samples<'a>>,
}

/// The record that was fitted and its fit, sample by sample, in the unit of the record.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Samples<'a> {
    law: &'a str,
    unit: &'a str,
    time_s: Vec<f64>,
    measured: &'a [f64],
    fitted: Vec<f64>,
    /// Measured less fitted.
    residuals: Vec<f64>,
}

impl Found {
    /// The record of `decay` and the motion `fitted` to it, sample by sample.
    fn samples<'a>(&'a self, decay: &'a Experiment, fitted: Vec<f64>) -> Samples<'a> {
        let record = decay.record();
        let residuals = record.values().iter().zip(&fitted).map(|(measured, fit)| measured - fit).collect();
        let (law, unit) = (self.comparison.preferred().law(), record.unit());
        Samples { law, unit, time_s: record.times().collect(), measured: record.values(), fitted, residuals }
    }
}

impl Answer for Found {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        // The friction that the record shows, then the law that explains it.
        let curve = self.curve.as_ref().map_or_else(String::new, |curve| format!("{}\n", curve.text()));
        let posterior = self.posterior.as_ref().map_or_else(String::new, |posterior| format!("\n{}", posterior.text()));
        Ok(format!("{}\n{curve}{}{posterior}", self.origin, self.comparison))
    }

    fn document(&self, detail: Detail) -> Result<String, Box<dyn Error>> {
        let mut fits = match detail {
            Detail::Brief => Vec::new(),
            Detail::Full => {
                self.decays.iter().zip(self.fitted()?).map(|(decay, fitted)| self.samples(decay, fitted)).collect()
            }
        }
        .into_iter();
        let content = Content {
            origin: &self.origin,
            remarks: &self.remarks,
            declared: &self.declared,
            comparison: &self.comparison,
            friction_curve: self.curve.as_ref(),
            posterior: self.posterior.as_ref(),
            fit: fits.next(),
            further_fits: fits.collect(),
        };
        Document::new("identify-1", content).pretty()
    }

    /// The record with the preferred fit, the decay of its amplitude, the residuals, and the friction curve.
    fn pictures(&self) -> Result<Vec<(String, String)>, Box<dyn Error>> {
        let pictures = Pictures::of(self)?;
        let unit = label("residual", self.decays[0].record().unit());
        let curve = self.curve_panels().map(|panels| ("friction_curve.svg", drawn(&panels)));
        let pictures = [
            ("fit.svg", drawn(&pictures.fit)),
            ("amplitude.svg", drawn(&pictures.amplitude)),
            ("residuals.svg", histogram(&unit, "residuals", &pictures.residuals)),
        ];
        Ok(pictures.into_iter().chain(curve).map(|(name, svg)| (name.to_owned(), svg)).collect())
    }

    fn fits(&self) -> Result<Vec<FittedRecord>, Box<dyn Error>> {
        let fit = |(decay, fitted): (&Experiment, Vec<f64>)| {
            let record = decay.record();
            let (unit, time, measured) = (record.unit().to_owned(), record.times().collect(), record.values().to_vec());
            FittedRecord { unit, time, measured, fitted }
        };
        Ok(self.decays.iter().zip(self.fitted()?).map(fit).collect())
    }

    fn page(&self) -> Result<Option<String>, Box<dyn Error>> {
        report::document(self).map(Some)
    }

    fn remarks(&self) -> &[String] {
        &self.remarks
    }

    fn verdict(&self) -> Result<(), String> {
        self.failure.clone().map_or(Ok(()), Err)
    }
}

/// Finds the law that explains a record, or the parameters of those that are named; `command` is what was typed.
pub(crate) fn identify(arguments: &Arguments, command: &str, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
    let begun = Instant::now();
    let mut found = found(arguments, &arguments.question.candidates(host)?, command, host)?;
    let curve = || {
        let curve = arguments.question.friction_curve(found.comparison.preferred(), &found.decays, begun);
        curve.map_or_else(|missing| Curve::Missing { missing }, |curve| Curve::Found(Box::new(curve)))
    };
    found.curve = Some(host.while_busy("friction over speed", curve)?);
    with_posterior(found, arguments, host)
}

/// Compares the laws that are named, or else viscous, dry and both.
pub(crate) fn compare(arguments: &Arguments, command: &str, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
    let found = found(arguments, &arguments.question.compared(host)?, command, host)?;
    with_posterior(found, arguments, host)
}

/// Reads, prepares and fits the record; by a search unless there are `candidates`.
fn found(
    arguments: &Arguments,
    candidates: &[Candidate],
    command: &str,
    host: &Host<'_>,
) -> Result<Found, Box<dyn Error>> {
    if let (true, Some(refusal)) = (arguments.posterior, Posterior::REFUSAL) {
        return Err(refusal.into());
    }
    let further = arguments.further.iter().map(|file| Given { file: Some(file.clone()), ..arguments.given.clone() });
    let all: Vec<Given> = std::iter::once(arguments.given.clone()).chain(further).collect();
    let (mut origins, mut remarks, mut decays, mut digests) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for given in &all {
        let input = given.read_mode(host)?;
        let preparation = given.preparation().gain_uncertainty(arguments.question.scale_u);
        let named = |error: Box<dyn Error>| match all.len() {
            1 => error,
            _ => placed(given.name())(error).into(),
        };
        decays.push(experiment(arguments, &input.record, &preparation, host).map_err(named)?);
        origins.push(input.origin);
        remarks.extend(input.warnings);
        let digest = report::digest(&given.bytes(host)?);
        if let Some(first) = digests.iter().position(|other| *other == digest) {
            let (copy, first) = (given.name(), all[first].name());
            let what =
                format!("{copy} holds the same bytes as {first}, and a copy is no further evidence; leave it out");
            return Err(Kind::Contradiction.refusal(what).into());
        }
        digests.push(digest);
    }
    let mut questions = arguments.question.under(&arguments.normal_loads, all.len())?;
    let mut question = questions.remove(0);
    if !questions.is_empty() {
        let named = |(question, given): (Question, &Given)| (question, given.name());
        let questions: Vec<_> = std::iter::once(question).chain(questions).zip(&all).map(named).collect();
        let (together, factors) = Question::together(&questions)?;
        let loaded = decays.into_iter().zip(&factors).map(|(decay, factor)| decay.with_load_factor(*factor));
        decays = loaded.collect::<Result<_, _>>()?;
        question = together;
    }
    let comparison = fitted(&question, &decays, candidates, host)?;
    Ok(Found {
        origin: origins.join("\n"),
        remarks,
        declared: question.declared().collect(),
        decays,
        comparison,
        curve: None,
        posterior: None,
        failure: None,
        command: command.to_owned(),
        sha256: digests.join(" "),
    })
}

/// The same with the posterior, if it is asked for; what was found is given out without one as well.
fn with_posterior(mut found: Found, arguments: &Arguments, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
    if arguments.posterior {
        let posterior = || Posterior::of(found.comparison.preferred(), &found.decays);
        match host.while_busy("posterior", posterior)? {
            Ok(posterior) => found.posterior = Some(posterior),
            Err(error) => found.failure = Some(error.to_string()),
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::DRIVES;

    #[test]
    fn drives_are_the_options_of_their_group() {
        let mut command = Arguments::augment_args(clap::Command::new("identify"));
        command.build();
        let group = command.get_groups().find(|group| group.get_id() == DRIVE).unwrap();
        assert!(group.get_args().map(clap::Id::as_str).eq(DRIVES));
    }
}
