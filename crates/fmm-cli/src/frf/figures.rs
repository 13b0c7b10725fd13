//! Pictures of a test: trials.svg, response.svg, magnitude.svg.

use std::path::Path;

use fmm_frf::{Complex64, FrequencyResponse};

use super::analysis::Analysis;
use super::trials::Trial;
use crate::figure::{self, Layer, Panel, Role};

/// Draws force and response, real and imaginary part, and magnitude with phase and coherence, into `folder`.
///
/// # Errors
/// If a file cannot be written.
pub(crate) fn draw(folder: &Path, trials: &[Trial], analysis: &Analysis) -> std::io::Result<()> {
    figure::stacked(&folder.join("trials.svg"), &trial_panels(trials, analysis))?;
    // Beyond the force there is only noise, and at zero frequency only offsets.
    let lines = analysis.h1.clone().without_zero_frequency();
    let shown = lines.within(0.0, 1.05 * analysis.usable).unwrap_or(lines);
    figure::stacked(&folder.join("response.svg"), &complex_panels(&shown, analysis))?;
    figure::stacked(&folder.join("magnitude.svg"), &magnitude_panels(&shown, analysis))
}

/// The first trial, as the others hide it: the force around its pulse, and the response.
fn trial_panels(trials: &[Trial], analysis: &Analysis) -> Vec<Panel> {
    let (Some(trial), Some(pulse)) = (trials.first(), analysis.pulses.first()) else { return Vec::new() };
    let (force, response) = (&trial.force, &trial.response);
    let margin = 2 * pulse.samples.len();
    let around = pulse.samples.start.saturating_sub(margin)..(pulse.samples.end + margin).min(force.len());
    let values = |record: &fmm_record::Record, scale: f64, range: std::ops::Range<usize>| -> Vec<(f64, f64)> {
        range.map(|i| (record.time(i) * scale, record.values()[i])).collect()
    };
    let impulse = analysis.impulses[0];
    vec![
        Panel::new("time / ms", figure::label("force", "N"), 300.0).with(Layer::new(
            Role::Measured,
            format!("{}: J = {impulse:.5} N s", trial.name),
            values(force, 1e3, around),
        )),
        Panel::new("time / s", figure::label(response.quantity(), response.unit()), 300.0).with(Layer::new(
            Role::Measured,
            format!("{}: response", trial.name),
            values(response, 1.0, 0..response.len()),
        )),
    ]
}

/// A part of the response in grey, and the fitted modes in red where they were fitted.
fn curves(panel: Panel, shown: &FrequencyResponse, analysis: &Analysis, part: impl Fn(Complex64) -> f64) -> Panel {
    let lines = shown.frequencies().iter().zip(shown.values());
    let measured = lines.map(|(frequency, value)| (*frequency, part(*value))).collect();
    let mut panel = panel.with(Layer::new(Role::Measured, "H1", measured));
    let mut role = Role::Fitted;
    for peak in &analysis.peaks {
        let Some(fit) = &peak.fit else { continue };
        let frequency = |i: u32| peak.band.0 + (peak.band.1 - peak.band.0) * f64::from(i) / 200.0;
        let fitted = (0..=200).map(|i| (frequency(i), part(fit.value(frequency(i))))).collect();
        panel = panel.with(Layer::new(role, "fitted modes", fitted));
        role = Role::FittedAgain;
    }
    panel
}

fn complex_panels(shown: &FrequencyResponse, analysis: &Analysis) -> Vec<Panel> {
    let (form, unit) = (shown.form(), shown.form().unit());
    let panel = |x: &str, part: &str| Panel::new(x, figure::label(format_args!("{part} {form}"), unit), 300.0);
    vec![
        curves(panel("", "real"), shown, analysis, |value| value.re),
        curves(panel("frequency / Hz", "imaginary"), shown, analysis, |value| value.im),
    ]
}

fn magnitude_panels(shown: &FrequencyResponse, analysis: &Analysis) -> Vec<Panel> {
    let decibels = |value: Complex64| 20.0 * value.norm().max(f64::MIN_POSITIVE).log10();
    // Cut at −90°, as a phase between resonances is 0° or 180° and noise must not make it jump.
    let degrees = |value: Complex64| (value.arg().to_degrees() + 90.0).rem_euclid(360.0) - 90.0;
    let label = format!("|{}| / (dB re 1 {})", shown.form(), shown.form().unit());
    let coherence = analysis.coherence.frequencies().iter().zip(analysis.coherence.values());
    let last = shown.frequencies().last().copied().unwrap_or(0.0);
    let inside = coherence.filter(|(frequency, _)| **frequency > 0.0 && **frequency <= last);
    let averages = format!("γ² of {} averages", analysis.coherence.averages());
    let points = inside.map(|(frequency, value)| (*frequency, *value)).collect();
    vec![
        curves(Panel::new("", label, 340.0), shown, analysis, decibels),
        curves(Panel::new("", "phase / °", 220.0), shown, analysis, degrees),
        Panel::new("frequency / Hz", "coherence γ²", 250.0).with(Layer::new(Role::Residual, averages, points)),
    ]
}
