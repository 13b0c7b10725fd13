//! Pictures of modes: stabilisation.svg, fit.svg.

use fmm_frf::{Complex64, DiagramPole, FrequencyResponse, MeasuredResponse, ModalFit};

use crate::figure::{Panel, Role, drawn, label};

/// Responses that are drawn at most; more do not fit on a page.
const DRAWN: usize = 6;

/// The stabilisation diagram above the sum of all responses, and the fit of each response.
pub(super) fn pictures(responses: &[MeasuredResponse], fit: &ModalFit) -> Vec<(String, String)> {
    let fits: Vec<Panel> =
        responses.iter().zip(fit.fitted()).take(DRAWN).map(|(one, fitted)| panel(one, fitted)).collect();
    vec![
        ("stabilisation.svg".to_owned(), drawn(&[diagram(fit), sum(responses, fit)])),
        ("fit.svg".to_owned(), drawn(&fits)),
    ]
}

/// Poles over the order: grey, ink where the frequency is stable, red where the damping is as well.
fn diagram(fit: &ModalFit) -> Panel {
    let diagram = fit.diagram();
    let lines = fit.fitted()[0].frequencies();
    let poles = |is_kind: fn(&DiagramPole) -> bool| {
        let kind = diagram.poles().iter().filter(move |pole| is_kind(pole));
        kind.map(|pole| (pole.pole.natural_frequency(), pole.order as f64))
    };
    let top = diagram.order() as f64;
    let panel = Panel::new("", "order", 360.0)
        // The axis is that of the responses below.
        .with(Role::Measured, "", [(lines[0], 0.0), (lines[lines.len() - 1], 0.0)])
        .with(Role::Points, "pole", poles(|pole| !pole.is_stable_in_frequency))
        .with(
            Role::ResidualPoints,
            "stable in frequency",
            poles(|pole| pole.is_stable_in_frequency && !pole.is_stable_in_damping),
        )
        .with(Role::FittedPoints, "stable in frequency and damping", poles(DiagramPole::is_stable));
    fit.modes().iter().fold(panel, |panel, mode| {
        let frequency = mode.natural_frequency.value;
        panel.with(Role::Fitted, "mode", [(frequency, 0.0), (frequency, top)])
    })
}

/// Decibels of a magnitude.
fn level(value: f64) -> f64 {
    20.0 * value.max(f64::MIN_POSITIVE).log10()
}

/// The root of the sum of squares of all responses, measured and fitted.
fn sum(responses: &[MeasuredResponse], fit: &ModalFit) -> Panel {
    let lines = fit.fitted()[0].frequencies();
    let (low, high) = (lines[0], lines[lines.len() - 1]);
    let total = |all: &[&FrequencyResponse]| -> Vec<(f64, f64)> {
        let at = |line: usize| all.iter().map(|one| one.values()[line].norm_sqr()).sum::<f64>().sqrt();
        (0..lines.len()).map(|line| (lines[line], level(at(line)))).collect()
    };
    let measured: Vec<FrequencyResponse> =
        responses.iter().filter_map(|one| one.values().within(low, high).ok()).collect();
    let form = fit.fitted()[0].form();
    let name = if responses.len() == 1 { "measured" } else { "root of the sum of squares, measured" };
    Panel::new("frequency / Hz", format!("|{form}| / (dB re 1 {})", form.unit()), 320.0)
        .with(Role::Measured, name, total(&measured.iter().collect::<Vec<_>>()))
        .with(Role::Fitted, "fitted modes", total(&fit.fitted().iter().collect::<Vec<_>>()))
}

/// A response with its fit.
fn panel(measured: &MeasuredResponse, fitted: &FrequencyResponse) -> Panel {
    let lines = fitted.frequencies();
    let shown = measured.values().within(lines[0], lines[lines.len() - 1]).unwrap_or_else(|_| fitted.clone());
    let points = |response: &FrequencyResponse| -> Vec<(f64, f64)> {
        let of = |(frequency, value): (&f64, &Complex64)| (*frequency, level(value.norm()));
        response.frequencies().iter().zip(response.values()).map(of).collect()
    };
    let (form, place) = (fitted.form(), measured.response());
    let name = format!("dB re 1 {}", form.unit());
    Panel::new("frequency / Hz", label(format_args!("|{form}|"), &name), 300.0)
        .with(Role::Measured, format!("measured at {place}"), points(&shown))
        .with(Role::Fitted, "fitted modes", points(fitted))
}
