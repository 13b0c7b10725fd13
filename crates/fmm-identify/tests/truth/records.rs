//! Velocity records of the thesis' machine with a contact of known friction.

use fmm_friction::{LawFamily, Role};
use fmm_identify::{Experiment, Preparation};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, Scenario, Trajectory, simulate_into};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

/// m (kg), k (N/m) and the normal load (N).
const MASS: f64 = 10.391;
const STIFFNESS: f64 = 1982.0;
pub(crate) const LOAD: f64 = 5.0;
const INTERVAL: f64 = 1e-3;

/// Releases (m): the lowest, the middle and the highest of the thesis.
pub(crate) const RELEASES: [f64; 3] = [8e-3, 15e-3, 22e-3];
/// White noise (m/s).
pub(crate) const NOISE: f64 = 2e-4;

pub(crate) fn machine() -> Oscillator {
    Oscillator::new(MASS, STIFFNESS).unwrap()
}

/// Velocity (m/s) of `machine` with the law of these `values`, released at `release` (m).
pub(crate) fn velocity<F: LawFamily>(machine: Oscillator, values: &[f64], release: f64, samples: usize) -> Vec<f64> {
    let scenario = Scenario::new(machine, F::at::<f64>(values).unwrap(), LOAD).unwrap();
    let mut trajectory = Trajectory::new();
    let sampling = Sampling::uniform(INTERVAL, samples).unwrap();
    simulate_into::<F, _>(&scenario.starting_at(release, 0.0).unwrap(), &sampling, None, &mut trajectory).unwrap();
    trajectory.velocity().values().to_vec()
}

pub(crate) fn prepared(velocity: Vec<f64>) -> Experiment {
    let record = Record::new(0.0, INTERVAL, velocity, Quantity::Velocity, "m/s").unwrap();
    Experiment::ring_down(&record, &Preparation::default()).unwrap()
}

/// The same with white noise of [`NOISE`].
pub(crate) fn noisy(velocity: &[f64], seed: u64) -> Experiment {
    let noise = Normal::new(0.0, NOISE).unwrap().sample_iter(ChaCha8Rng::seed_from_u64(seed));
    prepared(velocity.iter().zip(noise).map(|(v, noise)| v + noise).collect())
}

/// Values that a fit should find for the law of these `values`: forces per mass, levels above another as their excess,
/// no static level.
pub(crate) fn expected<F: LawFamily>(values: &[f64]) -> Vec<f64> {
    let parameters = || F::PARAMETERS.iter().zip(values);
    let level = parameters().find(|(parameter, _)| parameter.role() == Role::Level).map_or(0.0, |(_, level)| *level);
    let per_mass = LOAD / MASS;
    let fitted = parameters().filter(|(parameter, _)| parameter.role() != Role::Breakaway);
    fitted
        .map(|(parameter, value)| match parameter.role() {
            Role::LevelAbove => (value - level) * per_mass,
            Role::Shape => *value,
            _ => value * per_mass,
        })
        .collect()
}
