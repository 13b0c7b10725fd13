//! Chapter 8: blows of a hammer on the machine with its contact, in the frequency domain.
//!
//! No raw data are published. The printed peaks and impulses of three levels, with the printed coefficient, are the
//! truth of simulated blows; they are analysed as in the thesis, and the coefficient is found again.

mod blows;
mod forces;
mod friction;
mod harmonics;
mod receptance;

use fmm_frf::{FrequencyResponse, SingleDegreeOfFreedom};

use crate::{Chapter, Found, Settings, printed};
use blows::{Blow, LEVELS, Spectra, Test};
use fmm_cli::figure::{Panel, Role, label};

/// The numbers of chapter 8 beside ours.
///
/// # Errors
/// If a simulation, a spectrum or a fit cannot be done.
pub fn chapter(settings: &Settings<'_>) -> Found<Chapter> {
    let mut chapter = Chapter::new("8 Impact");
    let mut spectra = Spectra::new()?;
    let blows = LEVELS.into_iter().map(|level| Blow::of(level, COEFFICIENT)).collect::<Found<Vec<_>>>()?;
    settings.done(0.05);
    let count = settings.repetitions(10, 3);
    let mut tests = Vec::new();
    for (index, level) in LEVELS.into_iter().enumerate() {
        let seed = settings.seed().wrapping_mul(1_000_003).wrapping_add(100 * index as u64);
        tests.push(Test::of(level, count, seed, &mut spectra)?);
        settings.done(0.05 + 0.1 * (index + 1) as f64);
    }
    forces::add(&mut chapter, &blows, &tests)?;
    receptance::add(&mut chapter, &blows, &tests, &mut spectra)?;
    settings.done(0.4);
    friction::add(&mut chapter, &blows, &tests, &mut spectra, settings)?;
    harmonics::add(&mut chapter, &blows, &tests, &mut spectra)?;
    settings.done(1.0);
    Ok(chapter)
}

/// μ of section 8.3, the same at all levels (1).
const COEFFICIENT: f64 = 0.113;
/// Normal load (N).
const LOAD: f64 = printed::LOADS[4];

/// Mass, stiffness and mean damping of Table 2 without the contact.
fn linear() -> Found<SingleDegreeOfFreedom> {
    let [mass, stiffness, damping] = printed::MACHINE;
    Ok(SingleDegreeOfFreedom::new(mass, damping, stiffness)?)
}

/// μ N (N).
fn friction_force() -> f64 {
    COEFFICIENT * LOAD
}

/// Real and imaginary part of responses over frequency, in panels one below the other.
///
/// The first of each role names it, and the values are multiplied by `factor` into `unit`.
fn parts(name: &str, unit: &str, factor: f64, curves: &[(Role, &str, &FrequencyResponse)]) -> [Panel; 2] {
    let panel = |part: &str, of: fn(&fmm_frf::Complex64) -> f64, x: &str| {
        let axes = Panel::new(x, label(format!("{part} of {name}"), unit), 260.0);
        curves.iter().fold(axes, |axes, (role, text, response)| {
            axes.with(*role, *text, over_frequency(response, |value| factor * of(value)))
        })
    };
    [panel("real part", |value| value.re, ""), panel("imaginary part", |value| value.im, "frequency / Hz")]
}

/// A curve of what `of` makes of each value of a response.
fn over_frequency(response: &FrequencyResponse, of: impl Fn(&fmm_frf::Complex64) -> f64) -> Vec<(f64, f64)> {
    response.frequencies().iter().zip(response.values()).map(|(frequency, value)| (*frequency, of(value))).collect()
}

/// 20 log₁₀.
fn decibels(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}
