//! Stand-ins for the free vibrations that were measured, and the fit of the thesis' program A1.

use fmm_fit::Residuals as _;
use fmm_friction::Coulomb;
use fmm_identify::Problem;
use fmm_model::{Bounds, Damping, Oscillator};
use fmm_record::Record;
use fmm_sim::{Sampling, Trajectory};

use crate::ring_down::{self, INTERVAL};
use crate::{Found, printed};

/// The free vibration of `machine` from an initial position (m) and velocity (m/s).
pub(super) fn motion(machine: Oscillator, start: (f64, f64), seconds: f64) -> Found<Trajectory> {
    let scenario = ring_down::scenario::<Coulomb>(machine, &[0.0], 1.0, start)?;
    ring_down::motion::<Coulomb>(&scenario, &Sampling::uniform(INTERVAL, samples(seconds))?)
}

/// Samples of a record that lasts `seconds`, both ends included.
pub(super) fn samples(seconds: f64) -> usize {
    (seconds / INTERVAL).round() as usize + 1
}

/// The machine of Table 2 with damping 0.2005 N s/m and a `quadratic` part (N s²/m²) of the instantaneous velocity.
pub(super) fn machine(quadratic: f64) -> Found<Oscillator> {
    let [mass, stiffness, _] = printed::MACHINE;
    Ok(Oscillator::new(mass, stiffness)?.with_damping(Damping::new(printed::EQUATION_5_5[1], quadratic)?))
}

/// A velocity record of `values` (m/s) with white noise of standard deviation `noise` (m/s).
pub(super) fn record(values: &[f64], noise: f64, seed: u64) -> Found<Record> {
    ring_down::velocity_record(ring_down::with_noise(values, noise, seed)?)
}

/// The fit of A1 to `record`: mass, stiffness, damping and initial position free in its bounds, the initial velocity
/// that of the first sample. The start is mass (kg), stiffness (N/m) and damping (N s/m).
pub(super) fn a1(record: &Record, start: [f64; 3]) -> Found<Problem<'static>> {
    Ok(a1_of_stiffness(record, start)?.free_within("stiffness", Bounds::new(0.0, 3000.0)?)?)
}

/// The same with the stiffness held at its start.
pub(super) fn a1_of_stiffness(record: &Record, [mass, stiffness, damping]: [f64; 3]) -> Found<Problem<'static>> {
    let values = [
        ("mass", mass),
        ("stiffness", stiffness),
        ("damping", damping),
        ("coefficient", 0.0),
        ("initial_velocity", record.values()[0]),
    ];
    Ok(Problem::declared::<Coulomb>(record, &values)?
        .free_within("mass", Bounds::new(1.0, 100.0)?)?
        .free_within("damping", Bounds::new(0.0, 100.0)?)?
        .free_within("initial_position", Bounds::new(-12e-3, 12e-3)?)?)
}

/// Root mean square of the residuals (m/s).
pub(super) fn rms(residuals: &[f64]) -> f64 {
    (residuals.iter().map(|residual| residual * residual).sum::<f64>() / residuals.len() as f64).sqrt()
}

/// The place of a parameter in `problem`.
pub(super) fn place(problem: &Problem<'_>, name: &str) -> Found<usize> {
    let place = problem.parameters().iter().position(|parameter| parameter.name() == name);
    Ok(place.ok_or_else(|| format!("no parameter {name}"))?)
}
