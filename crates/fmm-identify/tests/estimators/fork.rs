//! A bicycle fork that others let swing, against the nonlinear fit of viscous and dry friction to the same record.

use std::f64::consts::PI;
use std::path::PathBuf;

use fmm_identify::{Experiment, Preparation, WeakForm, Windows, decrements, half_swing_losses_of};
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Reader, Record};

use crate::measurement::{close, line, statistics};

/// What the nonlinear fit finds: f₀ (Hz), c/m (1/s) and F/m (V/s) with their uncertainties.
const FREQUENCY: f64 = 0.6288;
const DAMPING: (f64, f64) = (0.0136, 0.0011);
const FRICTION: (f64, f64) = (0.029_92, 0.000_61);

fn fork() -> Record {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples/data/BrowserForkCompoundFirst1.mat");
    let reader = Reader::default().channel("data").quantity(Quantity::Velocity).unit("V");
    reader.read(path).unwrap().record
}

fn prepared() -> Experiment {
    Experiment::ring_down(&fork(), &Preparation::default()).unwrap()
}

/// Within two of the combined standard uncertainties, as the two weigh the record's slow errors differently.
#[test]
fn weak_form() {
    let found = WeakForm::default().estimate(&prepared()).unwrap();
    for (estimate, (value, u), what) in [(found.friction, FRICTION, "F/m (V/s)"), (found.damping, DAMPING, "c/m (1/s)")]
    {
        let error = (estimate.value - value) / estimate.uncertainty.hypot(u);
        assert!(error.abs() < 2.0, "{what}: {estimate} against {value} ± {u}");
        assert!((0.5..2.0).contains(&(estimate.uncertainty / u)), "{what}: {estimate}");
    }
    // The frequency of this pendulum rises by a percent as it calms down.
    close(found.natural_frequency.value, FREQUENCY, 2e-3, "natural frequency (Hz)");
    // The law misses something, as the residuals of the nonlinear fit do: 12 mV, of which 3 mV are white.
    let explained = found.explained_noise.unwrap();
    assert!((5e-3..20e-3).contains(&explained), "explained by {explained} V");
}

/// Dry friction F adds 4F/(π m V) to the damping of a cycle with the peak velocity V.
#[test]
fn decrement_and_windows() {
    let decay = prepared();
    let read = |points: Vec<(f64, f64)>, tolerance: f64, what: &str| {
        let (damping, slope, _) = line(&points);
        let error = (damping - DAMPING.0) / DAMPING.1;
        assert!(error.abs() < tolerance, "{what}: c/m = {damping} 1/s, off by {error} u");
        let error = (0.25 * PI * slope - FRICTION.0) / FRICTION.1;
        assert!(error.abs() < tolerance, "{what}: F/m = {} V/s, off by {error} u", 0.25 * PI * slope);
    };
    let cycles = decrements(&decay).unwrap();
    assert_eq!(cycles.len(), 17);
    read(cycles.iter().map(|cycle| (1.0 / cycle.peak_velocity, cycle.damping.value)).collect(), 2.0, "decrement");
    let windows = Windows::default().with_cycles(2).fit(&decay).unwrap();
    // A window is not short against the change of V, which moves some of the friction into the damping.
    read(windows.iter().map(|window| (1.0 / window.peak_velocity, window.damping.value)).collect(), 5.0, "windows");
}

#[test]
fn turning_points() {
    let machine = Oscillator::per_unit_mass(FREQUENCY).unwrap().with_damping(Damping::linear(DAMPING.0).unwrap());
    let losses = half_swing_losses_of(&prepared(), &machine).unwrap();
    let frictions: Vec<f64> = losses.iter().map(|half_swing| half_swing.friction.value).collect();
    let (mean, scatter) = statistics(&frictions);
    assert!((mean - FRICTION.0).abs() < 2.0 * FRICTION.1, "mean of the half swings {mean} V/s");
    assert!(scatter < 1e-3, "scatter {scatter} V/s");
}
