//! Simulated records of the machine of the thesis, with noise.

use fmm_friction::LawFamily;
use fmm_identify::{Known, Machine};
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Excitation, Sampling, Scenario, Trajectory, simulate_into};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

pub(crate) const MASS: f64 = 10.391;
pub(crate) const STIFFNESS: f64 = 1982.0;
pub(crate) const LOAD: f64 = 14.0;
pub(crate) const INTERVAL: f64 = 1e-3;

/// Of 300 intervals 95 ± 1.3 % contain the truth by chance alone.
pub(crate) const SEEDS: u64 = 300;

/// Known quantities of the machine: its mass and the load.
pub(crate) fn machine() -> Machine {
    let machine = Machine::of_mass(Known::exact(MASS).unwrap()).unwrap();
    machine.with_normal_load(Known::exact(LOAD).unwrap()).unwrap()
}

/// Motion of a machine, sampled.
pub(crate) struct Motion<'a> {
    pub(crate) damping: f64,
    pub(crate) law: &'a [f64],
    pub(crate) load: f64,
    pub(crate) initial: (f64, f64),
    pub(crate) force: Option<&'a [f64]>,
    pub(crate) samples: usize,
    pub(crate) interval: f64,
}

impl Motion<'_> {
    pub(crate) fn of<F: LawFamily>(&self) -> Trajectory {
        let damping = Damping::linear(self.damping).unwrap();
        let machine = Oscillator::new(MASS, STIFFNESS).unwrap().with_damping(damping);
        let scenario = Scenario::new(machine, F::at(self.law).unwrap(), self.load).unwrap();
        let mut scenario = scenario.starting_at(self.initial.0, self.initial.1).unwrap();
        if let Some(force) = self.force {
            scenario = scenario.driven_by(Excitation::sampled_force(self.interval, force).unwrap());
        }
        let sampling = Sampling::uniform(self.interval, self.samples).unwrap().keeping(Channels::All);
        let mut trajectory = Trajectory::new();
        simulate_into::<F, _>(&scenario, &sampling, None, &mut trajectory).unwrap();
        trajectory
    }
}

/// `values` with normal noise of standard deviation `noise`, as a record.
pub(crate) fn record(values: &[f64], noise: f64, seed: u64, quantity: Quantity, unit: &str) -> Record {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
    let values = values.iter().map(|value| value + noise * draw()).collect();
    Record::new(0.0, INTERVAL, values, quantity, unit).unwrap()
}

/// The share of `SEEDS` whose interval, as `interval` gives it, contains `truth`.
pub(crate) fn share_inside(truth: f64, seeds: u64, mut interval: impl FnMut(u64) -> (f64, f64)) -> f64 {
    let inside = (0..seeds).filter(|seed| {
        let (low, high) = interval(*seed);
        (low..=high).contains(&truth)
    });
    inside.count() as f64 / seeds as f64
}
