//! The frequency response of an impact test: `fmm frf FILES...`.
//!
//! Each file is one trial with a channel of force and one of the response. Gives out the impulses, the resonances with
//! frequency, damping and coherence, and what is doubtful, or all lines of H1, H2 and coherence.

mod analysis;
mod figures;
#[cfg(test)]
mod tests;
mod trials;

use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;

use crate::files::named;
use crate::output::{Output, print, while_busy};
use analysis::{Analysis, Window};
use clap::Args;
use fmm_frf::{FrequencyResponse, RationalFit, ResponseForm};
use fmm_record::Quantity;
use serde_json::json;
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
    #[command(flatten)]
    output: Output,
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

fn document(trials: &[Trial], analysis: &Analysis) -> serde_json::Value {
    let lines = |response: &FrequencyResponse| {
        let part = |part: fn(&fmm_frf::Complex64) -> f64| response.values().iter().map(part).collect::<Vec<_>>();
        json!({ "real": part(|value| value.re), "imag": part(|value| value.im) })
    };
    let measured = |value: fmm_frf::Estimated| json!({ "value": value.value, "u": value.uncertainty });
    let modes = analysis.peaks.iter().filter_map(|peak| {
        let mode = peak.fit.as_ref()?;
        Some(json!({
            "peak_hz": peak.line.frequency,
            "natural_frequency_hz": measured(mode.natural_frequency),
            "damping_ratio": measured(mode.damping_ratio),
        }))
    });
    let pulses = analysis.pulses.iter().map(|pulse| {
        json!({
            "level_n": pulse.level,
            "time_s": pulse.time,
            "width_s": pulse.width,
            "further_hits": pulse.further_hits.len(),
        })
    });
    json!({
        "trials": trials.iter().map(|trial| &trial.name).collect::<Vec<_>>(),
        "form": analysis.h1.form().to_string(),
        "unit": analysis.h1.form().unit(),
        "window": analysis.window,
        "decay_rate_per_s": analysis.h1.decay_rate(),
        "averages": analysis.coherence.averages(),
        "impulses_ns": analysis.impulses,
        "pulses": pulses.collect::<Vec<_>>(),
        "frequencies_hz": analysis.h1.frequencies(),
        "h1": lines(&analysis.h1),
        "h1_u": analysis.uncertainty,
        "h2": lines(&analysis.h2),
        "coherence": analysis.coherence.values(),
        "usable_hz": analysis.usable,
        "resonances_hz": analysis.peaks.iter().map(|peak| peak.line.frequency).collect::<Vec<_>>(),
        "modes": modes.collect::<Vec<_>>(),
        "warnings": analysis.warnings,
    })
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let read = |path: &PathBuf| arguments.channels.read(path).map_err(named(path));
    let trials = arguments.files.iter().map(read).collect::<Result<Vec<Trial>, _>>()?;
    let form = form(&trials)?;
    let analysis = while_busy("averaging and fitting modes", || {
        Analysis::of(&trials, form, arguments.window, arguments.exponential_end)
    })??;
    let text =
        if arguments.output.json { document(&trials, &analysis).to_string() } else { report(&trials, &analysis)? };
    print(text.trim_end())?;
    arguments.output.draw("{trials,response,magnitude}.svg", || Ok(figures::pictures(&trials, &analysis)))
}
