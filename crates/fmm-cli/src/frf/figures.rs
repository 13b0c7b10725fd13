//! Pictures of a test: trials.svg, response.svg, magnitude.svg.

use fmm_frf::{Complex64, FrequencyResponse};

use super::analysis::Analysis;
use super::trials::Trial;
use crate::figure::{Panel, Role, drawn, label};

/// Force and response, real and imaginary part, and magnitude with phase and coherence.
pub(crate) fn pictures(trials: &[Trial], analysis: &Analysis) -> Vec<(&'static str, String)> {
    // Beyond the force there is only noise, and at zero frequency only offsets.
    let lines = analysis.h1.clone().without_zero_frequency();
    let shown = lines.within(0.0, 1.05 * analysis.usable).unwrap_or(lines);
    vec![
        ("trials.svg", drawn(&trial_panels(trials, analysis))),
        ("response.svg", drawn(&complex_panels(&shown, analysis))),
        ("magnitude.svg", drawn(&magnitude_panels(&shown, analysis))),
    ]
}

/// The first trial, as the others hide it: the force around its pulse, and the response.
fn trial_panels(trials: &[Trial], analysis: &Analysis) -> Vec<Panel> {
    let (Some(trial), Some(pulse)) = (trials.first(), analysis.pulses.first()) else { return Vec::new() };
    let (force, response) = (&trial.force, &trial.response);
    let margin = 2 * pulse.samples.len();
    let around = pulse.samples.start.saturating_sub(margin)..(pulse.samples.end + margin).min(force.len());
    let pulse = around.map(|i| (1e3 * force.time(i), force.values()[i]));
    let blow = format!("{}: J = {:.5} N s", trial.name, analysis.impulses[0]);
    let answer = response.times().zip(response.values().iter().copied());
    vec![
        Panel::new("time / ms", label("force", "N"), 300.0).with(Role::Measured, blow, pulse),
        Panel::new("time / s", label(response.quantity(), response.unit()), 300.0).with(
            Role::Measured,
            format!("{}: response", trial.name),
            answer,
        ),
    ]
}

/// A part of the response in grey, and the fitted modes in red where they were fitted.
fn curves(panel: Panel, shown: &FrequencyResponse, analysis: &Analysis, part: impl Fn(Complex64) -> f64) -> Panel {
    let lines = shown.frequencies().iter().zip(shown.values());
    let measured = lines.map(|(frequency, value)| (*frequency, part(*value)));
    let mut panel = panel.with(Role::Measured, "H1", measured);
    for fitted in of_modes(analysis, part) {
        panel = panel.with(Role::Fitted, "fitted modes", fitted);
    }
    panel
}

/// The fitted modes where they were fitted.
fn of_modes(analysis: &Analysis, part: impl Fn(Complex64) -> f64) -> Vec<Vec<(f64, f64)>> {
    let mut curves = Vec::new();
    for peak in &analysis.peaks {
        let Some(fit) = &peak.fit else { continue };
        let frequency = |i: u32| peak.band.0 + (peak.band.1 - peak.band.0) * f64::from(i) / 200.0;
        curves.push((0..=200).map(|i| (frequency(i), part(fit.value(frequency(i))))).collect());
    }
    curves
}

/// Phases between −180° and 180°: points, and curves that end where they would leap from one end to the other.
fn phases(shown: &FrequencyResponse, analysis: &Analysis) -> Panel {
    let degrees = |value: Complex64| value.arg().to_degrees();
    let measured =
        shown.frequencies().iter().zip(shown.values()).map(|(frequency, value)| (*frequency, degrees(*value)));
    // The colours are those of the magnitude above.
    let panel = Panel::new("", "phase / °", 220.0).between(-180.0, 180.0).with(Role::Points, "", measured);
    of_modes(analysis, degrees).into_iter().fold(panel, |panel, curve| {
        let pieces = curve.chunk_by(|one, next| (one.1 - next.1).abs() < 180.0);
        pieces.fold(panel, |panel, piece| panel.with(Role::Fitted, "", piece.iter().copied()))
    })
}

fn complex_panels(shown: &FrequencyResponse, analysis: &Analysis) -> Vec<Panel> {
    let (form, unit) = (shown.form(), shown.form().unit());
    let panel = |x: &str, part: &str| Panel::new(x, label(format_args!("{part} {form}"), unit), 300.0);
    vec![
        curves(panel("", "real"), shown, analysis, |value| value.re),
        curves(panel("frequency / Hz", "imaginary"), shown, analysis, |value| value.im),
    ]
}

fn magnitude_panels(shown: &FrequencyResponse, analysis: &Analysis) -> Vec<Panel> {
    let decibels = |value: Complex64| 20.0 * value.norm().max(f64::MIN_POSITIVE).log10();
    let level = format!("|{}| / (dB re 1 {})", shown.form(), shown.form().unit());
    let coherence = analysis.coherence.frequencies().iter().zip(analysis.coherence.values());
    let last = shown.frequencies().last().copied().unwrap_or(0.0);
    let inside = coherence.filter(|(frequency, _)| **frequency > 0.0 && **frequency <= last);
    let averages = format!("γ² of {} averages", analysis.coherence.averages());
    let points = inside.map(|(frequency, value)| (*frequency, *value));
    vec![
        curves(Panel::new("", level, 340.0), shown, analysis, decibels),
        phases(shown, analysis),
        Panel::new("frequency / Hz", "coherence γ²", 250.0).with(Role::Residual, averages, points),
    ]
}
