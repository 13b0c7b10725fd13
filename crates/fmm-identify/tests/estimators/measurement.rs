//! Synthetic records of the thesis' machine.

use fmm_friction::Coulomb;
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Engine, Exact, RungeKutta, Sampling, Scenario, Trajectory};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

pub(crate) const MASS: f64 = 10.391;
pub(crate) const STIFFNESS: f64 = 1982.0;
pub(crate) const INTERVAL: f64 = 1e-3;

/// μ N of chapter 6 (N), 0.25 · 7 N.
pub(crate) const FRICTION: f64 = 1.75;
/// c of chapter 6 (N s/m).
pub(crate) const DAMPING: f64 = 0.275;
/// Release of chapter 6 (m).
pub(crate) const RELEASE: f64 = -0.01;

/// The machine with linear and quadratic damping.
pub(crate) fn machine(linear: f64, quadratic: f64) -> Oscillator {
    let damping = Damping::new(linear, quadratic).unwrap();
    Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(damping)
}

/// White noise of standard deviation `deviation` onto `values`.
pub(crate) fn noisy(values: &[f64], deviation: f64, seed: u64) -> Vec<f64> {
    if deviation == 0.0 {
        return values.to_vec();
    }
    let noise = Normal::new(0.0, deviation).unwrap().sample_iter(ChaCha8Rng::seed_from_u64(seed));
    values.iter().zip(noise).map(|(value, noise)| value + noise).collect()
}

pub(crate) fn velocity(values: Vec<f64>) -> Record {
    Record::new(0.0, INTERVAL, values, Quantity::Velocity, "m/s").unwrap()
}

/// Free vibration without friction, with linear and quadratic damping: position and velocity.
pub(crate) fn free(quadratic: f64, start: (f64, f64), seconds: f64) -> Trajectory {
    let scenario = Scenario::new(machine(0.2005, quadratic), Coulomb::new(0.0).unwrap(), 0.0).unwrap();
    let sampling = Sampling::uniform(INTERVAL, (seconds / INTERVAL) as usize).unwrap();
    RungeKutta::new(1e-11).unwrap().run(&scenario.starting_at(start.0, start.1).unwrap(), &sampling).unwrap()
}

/// The motion of chapter 6 up to its stop, and its times of zero velocity, release and stop included (s).
pub(crate) fn chapter_six() -> (Trajectory, Vec<f64>) {
    let scenario = Scenario::new(machine(DAMPING, 0.0), Coulomb::new(0.25).unwrap(), 7.0).unwrap();
    let scenario = scenario.starting_at(RELEASE, 0.0).unwrap();
    let whole = Exact.run(&scenario, &Sampling::uniform(INTERVAL, 3000).unwrap()).unwrap();
    let times: Vec<f64> = whole.events().iter().map(|event| event.time).collect();
    let samples = (times.last().unwrap() / INTERVAL).ceil() as usize + 1;
    let sampling = Sampling::uniform(INTERVAL, samples).unwrap().keeping(Channels::Both);
    (Exact.run(&scenario, &sampling).unwrap(), times)
}

/// Least-squares line through points: intercept, slope, rms residual.
pub(crate) fn line(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let count = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |sum, (x, y)| (sum.0 + x / count, sum.1 + y / count));
    let slope = points.iter().map(|(x, y)| (x - mean.0) * (y - mean.1)).sum::<f64>()
        / points.iter().map(|(x, _)| (x - mean.0).powi(2)).sum::<f64>();
    let intercept = mean.1 - slope * mean.0;
    let squares: f64 = points.iter().map(|(x, y)| (y - intercept - slope * x).powi(2)).sum();
    (intercept, slope, (squares / count).sqrt())
}

/// Mean and standard deviation.
pub(crate) fn statistics(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (values.len() as f64 - 1.0)).sqrt())
}

pub(crate) fn close(found: f64, expected: f64, relative: f64, what: &str) {
    let error = found / expected - 1.0;
    assert!(error.abs() <= relative, "{what}: {found} against {expected}, off by {error:.2e}, allowed {relative:.0e}");
}
