//! The frequency response of an impact test: `fmm frf FILES...`.
//!
//! Each file is one trial with a channel of force and one of the response. Gives out the impulses, the resonances with
//! frequency, damping and coherence, and what is doubtful, or all lines of H1, H2 and coherence. With `--modes`, all
//! modes are fitted at once, to these trials or to responses that were measured already.

mod analysis;
mod figures;
#[cfg(feature = "modes")]
pub(crate) mod modes;
#[cfg(test)]
mod tests;
mod trials;

use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;

use crate::answer::{Answer, Detail, Document};
use crate::host::Host;
use crate::output::Output;
use crate::refusal::placed;
use analysis::{Analysis, Window};
use clap::Args;
use fmm_frf::{Estimated, FrequencyResponse, RationalFit, ResponseForm};
use fmm_record::Quantity;
use serde::Serialize;
use trials::{Channels, Trial};

/// Estimates the frequency response of a machine from impact tests.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The trials: .csv, .tsv, .txt, .mat, .uff, .unv, .58, .npy or .npz, all of one rate and length
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    channels: Channels,
    /// Weights on the samples
    #[arg(long, value_enum, default_value = "none")]
    window: Window,
    /// Value of an exponential window at the end of the record
    #[arg(long, value_name = "FRACTION", default_value_t = 0.01)]
    exponential_end: f64,
    #[cfg(feature = "modes")]
    #[command(flatten)]
    modes: modes::Choices,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// The form of the response that all trials have.
fn form(trials: &[Trial]) -> Result<ResponseForm, Box<dyn Error>> {
    let quantity = trials.first().map_or(Quantity::Other, |trial| trial.response.quantity());
    if let Some(other) = trials.iter().find(|trial| trial.response.quantity() != quantity) {
        return Err(format!(
            "{}: its response is: {}, where that of others is: {quantity}",
            other.name,
            other.response.quantity()
        )
        .into());
    }
    match quantity {
        Quantity::Displacement => Ok(ResponseForm::Receptance),
        Quantity::Velocity => Ok(ResponseForm::Mobility),
        Quantity::Acceleration => Ok(ResponseForm::Accelerance),
        other => Err(format!("a response that is a {other} has no form").into()),
    }
}

fn report(trials: &[Trial], analysis: &Analysis) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let (form, unit) = (analysis.h1.form(), analysis.h1.form().unit());
    writeln!(text, "{:<24} {:>12} {:>10} {:>11}", "trial", "impulse N s", "level N", "width ms")?;
    for ((trial, pulse), impulse) in trials.iter().zip(&analysis.pulses).zip(&analysis.impulses) {
        writeln!(text, "{:<24} {impulse:>12.6} {:>10.3} {:>11.4}", trial.name, pulse.level, 1e3 * pulse.width)?;
    }
    if let Some(trial) = trials.first() {
        writeln!(text, "channels {}", trial.origin)?;
    }
    let lines = analysis.h1.frequencies();
    let (step, last) = (lines.get(1).map_or(0.0, |second| second - lines[0]), lines[lines.len() - 1]);
    writeln!(text, "\nH1, {form}: lines every {step:.6} Hz up to {last:.6} Hz, window {}", analysis.window)?;
    if let Some(median) =
        analysis.coherence.median(step, analysis.usable).filter(|_| analysis.coherence.is_meaningful())
    {
        let averages = analysis.coherence.averages();
        writeln!(text, "coherence: median {median:.4} up to {:.4} Hz, {averages} averages", analysis.usable)?;
    }
    if !analysis.peaks.is_empty() {
        let magnitude = format!("|H| {unit}");
        writeln!(text, "\n{:>10} {magnitude:>12} {:>9}   mode", "peak Hz", "coherence")?;
    }
    for peak in &analysis.peaks {
        let mode = peak.fit.as_ref().map_or_else(|| "-".to_owned(), RationalFit::to_string);
        let (frequency, magnitude) = (peak.line.frequency, peak.line.magnitude);
        writeln!(text, "{frequency:>10.4} {magnitude:>12.5} {:>9.4}   {mode}", peak.coherence)?;
    }
    for warning in &analysis.warnings {
        writeln!(text, "warning: {warning}")?;
    }
    Ok(text)
}

/// Frequency response for programs; lists along the lines are as long as `frequencies_hz`.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Content<'a> {
    /// Names of the trials.
    trials: Vec<&'a str>,
    /// Receptance, mobility or accelerance.
    form: String,
    /// Unit of the response.
    unit: &'a str,
    /// Weights on the samples, in words.
    window: &'a str,
    /// Rate of an exponential window, which is taken out of the results again (1/s).
    decay_rate_per_s: f64,
    averages: f64,
    /// Impulses (N s), one a trial.
    impulses_ns: &'a [f64],
    pulses: Vec<OfPulse>,
    frequencies_hz: &'a [f64],
    h1: Lines,
    /// Standard uncertainty of real and imaginary part of H1; none for a single trial.
    h1_u: Option<&'a [f64]>,
    h2: Lines,
    coherence: &'a [f64],
    /// Frequency up to which the force excites (Hz).
    usable_hz: f64,
    /// Lines of the peaks (Hz).
    resonances_hz: Vec<f64>,
    modes: Vec<Mode>,
    warnings: &'a [String],
}

/// The pulse of a trial.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct OfPulse {
    level_n: f64,
    time_s: f64,
    width_s: f64,
    /// Number of hits after the first.
    further_hits: usize,
}

/// A response along the lines.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Lines {
    real: Vec<f64>,
    imag: Vec<f64>,
}

/// A mode that was fitted to a peak.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Mode {
    /// Line of the peak.
    peak_hz: f64,
    natural_frequency_hz: Measured,
    damping_ratio: Measured,
}

/// A value and its standard uncertainty.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Measured {
    value: f64,
    u: f64,
}

impl From<Estimated> for Measured {
    fn from(found: Estimated) -> Self {
        Self { value: found.value, u: found.uncertainty }
    }
}

impl<'a> Content<'a> {
    fn of(trials: &'a [Trial], analysis: &'a Analysis) -> Self {
        let lines = |response: &FrequencyResponse| Lines {
            real: response.values().iter().map(|value| value.re).collect(),
            imag: response.values().iter().map(|value| value.im).collect(),
        };
        let modes = analysis.peaks.iter().filter_map(|peak| {
            let mode = peak.fit.as_ref()?;
            Some(Mode {
                peak_hz: peak.line.frequency,
                natural_frequency_hz: mode.natural_frequency.into(),
                damping_ratio: mode.damping_ratio.into(),
            })
        });
        let pulses = analysis.pulses.iter().map(|pulse| OfPulse {
            level_n: pulse.level,
            time_s: pulse.time,
            width_s: pulse.width,
            further_hits: pulse.further_hits.len(),
        });
        Self {
            trials: trials.iter().map(|trial| trial.name.as_str()).collect(),
            form: analysis.h1.form().to_string(),
            unit: analysis.h1.form().unit(),
            window: &analysis.window,
            decay_rate_per_s: analysis.h1.decay_rate(),
            averages: analysis.coherence.averages(),
            impulses_ns: &analysis.impulses,
            pulses: pulses.collect(),
            frequencies_hz: analysis.h1.frequencies(),
            h1: lines(&analysis.h1),
            h1_u: analysis.uncertainty.as_deref(),
            h2: lines(&analysis.h2),
            coherence: analysis.coherence.values(),
            usable_hz: analysis.usable,
            resonances_hz: analysis.peaks.iter().map(|peak| peak.line.frequency).collect(),
            modes: modes.collect(),
            warnings: &analysis.warnings,
        }
    }
}

/// Trials and what they say together.
pub(crate) struct Found {
    trials: Vec<Trial>,
    analysis: Analysis,
}

pub(crate) fn frf(arguments: &Arguments, host: &Host<'_>) -> Result<Box<dyn Answer>, Box<dyn Error>> {
    #[cfg(feature = "modes")]
    if arguments.modes.are_wanted() {
        let measured = match arguments.modes.measured(&arguments.files, &arguments.channels, host)? {
            Some(measured) => measured,
            None => modes::Measured::of(&found(arguments, host)?)?,
        };
        return Ok(Box::new(arguments.modes.fit(measured, host)?));
    }
    Ok(Box::new(found(arguments, host)?))
}

fn found(arguments: &Arguments, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
    let read = |path: &PathBuf| arguments.channels.read(path, host).map_err(placed(path.display()));
    let trials = arguments.files.iter().map(read).collect::<Result<Vec<Trial>, _>>()?;
    let form = form(&trials)?;
    let analysis = host.while_busy("averaging and fitting modes", || {
        Analysis::of(&trials, form, arguments.window, arguments.exponential_end)
    })??;
    Ok(Found { trials, analysis })
}

impl Answer for Found {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        Ok(report(&self.trials, &self.analysis)?.trim_end().to_owned())
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("frf-1", Content::of(&self.trials, &self.analysis)).compact()
    }

    fn pictures(&self) -> Result<Vec<(String, String)>, Box<dyn Error>> {
        let pictures = figures::pictures(&self.trials, &self.analysis).into_iter();
        Ok(pictures.map(|(name, svg)| (name.to_owned(), svg)).collect())
    }
}
