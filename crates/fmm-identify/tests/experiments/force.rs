//! Forces along motions: every law comes back out of what it makes of a motion, with its uncertainty.

use fmm_friction::{BristleLaw, FamilyVisitor, LawFamily, LawVisitor, SlidingLaw, family_named};
use fmm_identify::{ForceModel, ForceRecord, IdentifyError, identify_force};
use fmm_sim::{Path, State, friction_along};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};

/// A motion: to and fro with a second, quicker part.
fn motion(time: f64) -> State {
    let (slow, quick) = (std::f64::consts::TAU * 0.5, std::f64::consts::TAU * 1.3);
    State {
        position: 0.02 * (slow * time).sin() + 0.004 * (quick * time + 0.3).sin(),
        velocity: 0.02 * slow * (slow * time).cos() + 0.004 * quick * (quick * time + 0.3).cos(),
    }
}

/// Friction of a law along the motion at fine times, of a law with state by steps.
struct AlongMotion<'a, L> {
    law: &'a L,
    times: &'a [f64],
}

impl<L> LawVisitor<f64, L> for AlongMotion<'_, L> {
    type Output = Vec<f64>;

    fn sliding(self) -> Vec<f64>
    where
        L: SlidingLaw<f64>,
    {
        let at = |time: &f64| {
            let (speed, later) = (motion(*time).velocity, motion(*time + 1e-7).velocity);
            let losing = later.abs() < speed.abs();
            let size = if losing {
                self.law.coefficient_losing_speed(speed.abs())
            } else {
                self.law.coefficient(speed.abs())
            };
            size * speed.signum()
        };
        self.times.iter().map(at).collect()
    }

    fn bristle(self) -> Vec<f64>
    where
        L: BristleLaw<f64>,
    {
        let states: Vec<State> = self.times.iter().map(|time| motion(*time)).collect();
        let path = Path::through(self.times, &states).unwrap();
        friction_along(self.law, 1.0, &path).unwrap().into_iter().map(|point| point.force).collect()
    }
}

/// Friction (N) of the law called `name` at fine times.
struct Friction<'a>(&'a [f64], &'a [f64]);

impl FamilyVisitor for Friction<'_> {
    type Output = Vec<f64>;

    fn visit<F: LawFamily>(&mut self) -> Vec<f64> {
        let law = F::at(self.0).unwrap();
        F::visit(AlongMotion { law: &law, times: self.1 })
    }
}

/// Seconds between two of the fine times.
const FINE: f64 = 2e-4;
/// Force behind the motion (s), zero of the force (N), noise (N).
const DELAY: f64 = 3.7e-3;
const ZERO: f64 = 1.5;
const NOISE: f64 = 0.05;

/// What is the same for every seed: fine times and friction at them.
struct Truth {
    times: Vec<f64>,
    friction: Vec<f64>,
}

impl Truth {
    fn of(name: &str, values: &[f64]) -> Self {
        let times: Vec<f64> = (0..=22_500).map(|i| FINE * f64::from(i)).collect();
        let friction = family_named(name, &mut Friction(values, &times)).unwrap();
        Self { times, friction }
    }

    /// 800 samples at unequal times, of which the force comes late.
    fn record(&self, seed: u64) -> ForceRecord {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let jitter = Uniform::new(-0.4, 0.4).unwrap();
        let times: Vec<f64> =
            (0..800).map(|i| 0.2 + 5e-3 * (f64::from(i) + jitter.sample(&mut random))).collect();
        let forces: Vec<f64> = times
            .iter()
            .map(|time| {
                let at = (time - DELAY) / FINE;
                let (node, share) = (at as usize, at.fract());
                let friction = self.friction[node] * (1.0 - share) + self.friction[node + 1] * share;
                let noise: f64 = StandardNormal.sample(&mut random);
                friction + ZERO + NOISE * noise
            })
            .collect();
        let states: Vec<State> = times.iter().map(|time| motion(*time)).collect();
        let positions: Vec<f64> = states.iter().map(|state| state.position).collect();
        let velocities: Vec<f64> = states.iter().map(|state| state.velocity).collect();
        debug_assert!(self.times.len() == self.friction.len());
        ForceRecord::of_positions(&times, &positions, &forces).unwrap().with_velocities(&velocities).unwrap()
    }
}

/// Laws, what is held of them, their values, and the findings that are the truth.
type Case = (&'static str, &'static [(&'static str, f64)], &'static [f64], &'static [(&'static str, f64)]);

const CASES: &[Case] = &[
    ("viscous", &[], &[40.0], &[("damping", 40.0)]),
    ("coulomb", &[], &[5.0], &[("friction_force", 5.0)]),
    ("coulomb_viscous", &[], &[5.0, 20.0], &[("friction_force", 5.0), ("damping", 20.0)]),
    (
        "acceleration_coulomb",
        &[],
        &[5.5, 4.5],
        &[("gaining_friction_force", 5.5), ("losing_friction_force", 4.5)],
    ),
    (
        "stribeck",
        &[],
        &[4.0, 6.0, 0.02, 1.4, 10.0],
        &[("sliding_friction_force", 4.0), ("static_friction_force", 6.0), ("stribeck_speed", 0.02), ("exponent", 1.4)],
    ),
    (
        "stribeck_lorentzian",
        &[],
        &[4.0, 6.0, 0.02, 10.0],
        &[("sliding_friction_force", 4.0), ("static_friction_force", 6.0), ("stribeck_speed", 0.02)],
    ),
    ("hyperbolic", &[], &[6.0, 10.0], &[("static_friction_force", 6.0), ("decay", 10.0)]),
    ("berger", &[], &[4.0, 2.0, 40.0], &[("friction_force", 4.0), ("excess_friction_force", 2.0), ("decay", 40.0)]),
    ("power_law", &[], &[6.0, 0.6, 4.0], &[("exponent", 0.6), ("friction_force", 4.0)]),
    (
        "exponential_pair",
        &[],
        &[4.0, 6.0, 40.0, 80.0],
        &[("sliding_friction_force", 4.0), ("static_friction_force", 6.0), ("gaining_decay", 40.0)],
    ),
    (
        "makkar_dixon",
        &[],
        &[3.0, 400.0, 30.0, 3.0, 400.0, 10.0],
        &[("fall", 30.0), ("friction_force", 3.0), ("damping", 10.0)],
    ),
    (
        "regularised_stribeck",
        &[],
        &[6.0, 4.0, 0.01, 10.0],
        &[("peak_friction_force", 6.0), ("sliding_friction_force", 4.0), ("peak_speed", 0.01)],
    ),
    ("dahl", &[], &[5.0, 5000.0, 1.0], &[("friction_force", 5.0), ("contact_stiffness", 5000.0), ("exponent", 1.0)]),
    (
        "lugre",
        &[("exponent", 2.0)],
        &[4.0, 6.0, 0.02, 2.0, 5000.0, 20.0, 10.0],
        &[("sliding_friction_force", 4.0), ("stribeck_speed", 0.02), ("contact_stiffness", 5000.0), ("damping", 10.0)],
    ),
    (
        "bouc_wen",
        &[("amplitude", 1.0), ("exponent", 1.0)],
        &[5000.0, 1.0, 600.0, 400.0, 1.0],
        &[("contact_stiffness", 5000.0), ("beta", 600.0), ("gamma", 400.0)],
    ),
    (
        "maxwell_slip_2",
        &[],
        &[3.0, 6000.0, 2.0, 800.0],
        &[("level_1_friction_force", 3.0), ("contact_stiffness_1", 6000.0), ("contact_stiffness_2", 800.0)],
    ),
];

#[test]
fn explore() {
    let only = std::env::var("ONLY").unwrap_or_default();
    for (name, held, values, truths) in CASES.iter().filter(|case| only.is_empty() || case.0 == only) {
        let truth = Truth::of(name, values);
        let mut model = ForceModel::named(name).unwrap().with_zero().with_delay();
        for (name, value) in *held {
            model = model.holding(name, *value).unwrap();
        }
        let begun = std::time::Instant::now();
        let seeds = std::env::var("SEEDS").map_or(10, |n| n.parse().unwrap());
        let truths: Vec<(&str, f64)> = truths.iter().copied().chain([("zero", ZERO), ("delay", DELAY)]).collect();
        let mut inside = vec![(0, 0); truths.len()];
        let mut last = None;
        for seed in 0..seeds {
            let found = identify_force(&model, &[truth.record(seed)]).unwrap();
            for (count, (name, truth)) in inside.iter_mut().zip(&truths) {
                let finding = found.finding(name).unwrap_or_else(|| panic!("{name} of {found}"));
                if let Some((low, high)) = finding.interval(0.95) {
                    count.1 += 1;
                    count.0 += usize::from(low <= *truth && *truth <= high);
                }
            }
            last = Some(found);
        }
        println!("{name}: {inside:?} {:.1} ms", begun.elapsed().as_secs_f64() * 1e3 / seeds as f64);
        if let Some(found) = last { println!("{found}"); }
    }
}
