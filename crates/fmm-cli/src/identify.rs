//! Friction out of the record of a vibration: `fmm identify FILE` and `fmm compare FILE`.
//!
//! Reads a record of displacement, velocity or acceleration, prepares it, fits it by one law or by several, and gives
//! out findings, their uncertainties, and the limits of the record. The quantity of a channel follows from its unit, a
//! word in its name, or options; a guess is refused.

use std::error::Error;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use crate::figure::{drawn, histogram, label};
use crate::files;
use crate::input::{Choice, DRIVE, Given, Question};
use crate::output::{Output, print, print_json, spinner, while_busy};
use crate::posterior::Posterior;
use crate::report::{self, Curve, Found, Pictures};
use clap::Args;
use fmm_fit::Progress;
use fmm_identify::{Candidate, Comparison, Drive, Experiment, FrictionCurve, ImpactTrial, Preparation};
use fmm_record::{Column, Quantity, Record};
use serde::Serialize;

/// Identifies the friction of a machine from the record of its free vibration.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    given: Given,
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

/// Two frequencies (Hz), the lower one first.
fn band(text: &str) -> Result<(f64, f64), String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([low, high]) if low < high && *low >= 0.0 => Ok((*low, *high)),
        _ => Err(format!("a band is two frequencies in Hz, the lower one first, such as 1,4, but this is {text:?}")),
    }
}

/// The force that was measured in `channel` of the file.
fn measured(arguments: &Arguments, channel: &Column, quantity: Option<Quantity>) -> Result<Record, Box<dyn Error>> {
    let file = arguments.given.file.as_ref().ok_or("the bundled record is one of a free vibration; give a file")?;
    let (time, rate) = (arguments.given.choice.time.clone(), arguments.given.choice.rate);
    let choice = Choice { channel: Some(channel.clone()), time, rate, quantity, is_drive: true, ..Choice::default() };
    Ok(choice.read(file)?.record)
}

/// The experiment of the record, with its drive and its sensor.
fn experiment(arguments: &Arguments, record: &Record, preparation: &Preparation) -> Result<Experiment, Box<dyn Error>> {
    let force = |channel: &Column| measured(arguments, channel, Some(Quantity::Force));
    let experiment = if let Some(channel) = &arguments.impact {
        let trial = ImpactTrial::prepare(&force(channel)?, record)?;
        match arguments.mobility {
            Some(_) => Experiment::mobility(&trial, arguments.mobility)?,
            None => Experiment::impact(&trial)?,
        }
    } else if let Some(channel) = &arguments.force {
        Experiment::driven(record, Drive::force(&force(channel)?)?, preparation)?
    } else if let Some(channel) = &arguments.base {
        Experiment::driven(record, Drive::base(&measured(arguments, channel, None)?)?, preparation)?
    } else {
        Experiment::ring_down(record, preparation)?
    };
    arguments.question.seen(experiment)
}

/// Fits all candidates while a line on standard error shows how far they are.
fn fitted(arguments: &Arguments, decay: &Experiment, candidates: &[Candidate]) -> Result<Comparison, Box<dyn Error>> {
    let bar = spinner()?;
    let samples = decay.summary().samples as f64;
    let show = |law: &str, progress: &Progress<'_>| {
        let rms = (progress.sum_of_squares() / samples).sqrt();
        bar.set_message(format!("{law}: step {}, rms residual {rms:.4e}", progress.iterations()));
        ControlFlow::Continue(())
    };
    let comparison = arguments.question.answer(std::slice::from_ref(decay), candidates, show);
    bar.finish_and_clear();
    comparison
}

/// The record with the preferred fit, the decay of its amplitude, and the residuals.
fn pictures(found: &Found) -> Result<Vec<(&'static str, String)>, Box<dyn Error>> {
    let pictures = Pictures::of(&found.decay, &found.comparison)?;
    let unit = label("residual", found.decay.record().unit());
    let curve = found.curve_panels().map(|panels| ("friction_curve.svg", drawn(&panels)));
    let pictures = [
        ("fit.svg", drawn(&pictures.fit)),
        ("amplitude.svg", drawn(&pictures.amplitude)),
        ("residuals.svg", histogram(&unit, "residuals", &pictures.residuals)),
    ];
    Ok(pictures.into_iter().chain(curve).collect())
}

/// Document for programs: the comparison, and the posterior if there is one.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    #[serde(skip_serializing_if = "Option::is_none")]
    friction_curve: &'a Option<Curve>,
    #[serde(skip_serializing_if = "Option::is_none")]
    posterior: &'a Option<Posterior>,
}

/// Reads, prepares and fits the record; by a search unless there are `candidates`.
fn found(arguments: &Arguments, candidates: &[Candidate]) -> Result<Found, Box<dyn Error>> {
    let input = arguments.given.read_mode()?;
    input.warn();
    let preparation = arguments.given.preparation().gain_uncertainty(arguments.question.scale_u);
    let decay = experiment(arguments, &input.record, &preparation)?;
    let comparison = fitted(arguments, &decay, candidates)?;
    Ok(Found { origin: input.origin, decay, comparison, curve: None, posterior: None })
}

/// Finds the law that explains a record, or the parameters of those that are named.
pub(crate) fn identify(arguments: &Arguments, command: &str) -> Result<(), Box<dyn Error>> {
    give_out(arguments, &arguments.question.candidates()?, true, command)
}

/// Compares the laws that are named, or else viscous, dry and both.
pub(crate) fn compare(arguments: &Arguments, command: &str) -> Result<(), Box<dyn Error>> {
    give_out(arguments, &arguments.question.compared()?, false, command)
}

/// `command` is what was typed.
fn give_out(
    arguments: &Arguments,
    candidates: &[Candidate],
    with_curve: bool,
    command: &str,
) -> Result<(), Box<dyn Error>> {
    arguments.output.folder()?;
    if let (true, Some(refusal)) = (arguments.posterior, Posterior::REFUSAL) {
        return Err(refusal.into());
    }
    if let Some(path) = &arguments.report {
        files::require_writable(path)?;
        let is_page =
            path.extension().is_some_and(|ending| ["html", "htm"].iter().any(|page| ending.eq_ignore_ascii_case(page)));
        if !is_page {
            let path = path.display();
            let refusal = format!(
                "--report writes a page of HTML, but {path} is called otherwise; give a name that ends in .html, which a \
                 browser prints as PDF"
            );
            return Err(refusal.into());
        }
    }
    let begun = Instant::now();
    let mut found = found(arguments, candidates)?;
    let curve = || {
        if arguments.question.is_over(begun) {
            return Curve::Missing { missing: "the time limit is over".to_owned() };
        }
        match FrictionCurve::beside(found.comparison.preferred(), std::slice::from_ref(&found.decay)) {
            Ok(curve) => Curve::Found(Box::new(curve)),
            Err(error) => Curve::Missing { missing: error.to_string() },
        }
    };
    found.curve = if with_curve { Some(while_busy("friction over speed", curve)?) } else { None };
    let posterior = || Posterior::of(found.comparison.preferred(), &found.decay);
    let posterior = if arguments.posterior { while_busy("posterior", posterior)?.map(Some) } else { Ok(None) };
    // What was found is given out without one as well.
    let failed = match posterior {
        Ok(posterior) => {
            found.posterior = posterior;
            None
        }
        Err(error) => Some(error),
    };
    if arguments.output.json {
        print_json(&Document {
            comparison: &found.comparison,
            friction_curve: &found.curve,
            posterior: &found.posterior,
        })?;
    } else {
        let report = found.comparison.to_string();
        // The friction that the record shows, then the law that explains it.
        let curve = found.curve.as_ref().map_or_else(String::new, |curve| format!("{}\n", curve.text()));
        print(format_args!("{}\n{curve}{report}", found.origin))?;
        if let Some(posterior) = &found.posterior {
            print(posterior.text())?;
        }
    }
    arguments.output.draw(
        if found.curve_panels().is_some() {
            "{fit,amplitude,residuals,friction_curve}.svg"
        } else {
            "{fit,amplitude,residuals}.svg"
        },
        || pictures(&found),
    )?;
    if let Some(path) = &arguments.report {
        let bytes = arguments.given.bytes()?;
        let page = while_busy("report", || report::document(&found, &bytes, command))??;
        std::fs::write(path, page).map_err(|error| format!("cannot write {}: {error}", path.display()))?;
        eprintln!("report: {}", path.display());
    }
    failed.map_or(Ok(()), Err)
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
