//! Random machines under random forces: every law, damping form, restoring force and cause of motion.

use std::f64::consts::TAU;
use std::fmt;

use fmm_model::{Damping, Dual, Oscillator, Restoring, Scalar};
use fmm_sim::{Engine, Exact, Excitation, RungeKutta, Sampling, Scenario, SimulationError, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::contact::{AnyLaw, Family};
use crate::case::log_uniform;

/// Something that acts from outside.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Cause {
    Sampled { interval: f64, values: Vec<f64> },
    HalfSine { peak: f64, duration: f64, delay: f64 },
    Ramp { rate: f64, delay: f64 },
    Harmonic { amplitude: f64, angular: f64, phase: f64 },
    Base { amplitude: f64, angular: f64, phase: f64 },
    Belt { velocity: f64 },
}

/// A machine, its contact, what moves it and for how long.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Setup {
    pub(crate) family: Family,
    pub(crate) law: Vec<f64>,
    pub(crate) mass: f64,
    pub(crate) stiffness: f64,
    /// Linear, quadratic and cubic.
    pub(crate) damping: [f64; 3],
    /// Length per radian of a pendulum.
    pub(crate) pendulum: Option<f64>,
    pub(crate) normal_load: f64,
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) causes: Vec<Cause>,
    pub(crate) duration: f64,
    /// Length that forces and speeds were drawn for (m).
    pub(crate) length: f64,
}

/// Which engine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Solver {
    Exact,
    RungeKutta(RungeKutta),
}

/// Derivatives in every number of a setup.
pub(crate) type Gradient = Dual<24>;

/// How many setups of a family to draw: `usual` unless the environment variable `FMM_DRAWS` says how many.
pub(crate) fn draws(usual: usize) -> usize {
    std::env::var("FMM_DRAWS").map_or(usual, |count| count.parse().expect("FMM_DRAWS is a number"))
}

/// `count` random setups of a family, the same for the same seed; with `linear`, those that have a closed form.
pub(crate) fn setups(seed: u64, family: Family, linear: bool, count: usize) -> impl Iterator<Item = Setup> {
    let mut random = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(1000) + family as u64);
    (0..count).map(move |_| Setup::draw(&mut random, family, linear))
}

fn signed(random: &mut ChaCha8Rng, magnitude: f64) -> f64 {
    if random.random_bool(0.5) { magnitude } else { -magnitude }
}

impl Setup {
    fn draw(random: &mut ChaCha8Rng, family: Family, linear: bool) -> Self {
        let (length, mass) = (log_uniform(random, -6.0, 0.0), log_uniform(random, -3.0, 3.0));
        let angular = TAU * log_uniform(random, -1.0, 3.0);
        let (stiffness, speed) = (mass * angular * angular, length * angular);
        let normal_load = log_uniform(random, -2.0, 3.0);
        let critical = 2.0 * mass * angular;
        let ratio = match random.random_range(0..6) {
            0 => 0.0,
            1..5 => log_uniform(random, -4.0, -0.3),
            _ => random.random_range(0.0..3.0),
        };
        let mut damping = [ratio * critical, 0.0, 0.0];
        if !linear && random.random_bool(0.4) {
            damping[1] = mass / length * log_uniform(random, -3.0, 0.0);
            damping[2] = mass / length / speed * log_uniform(random, -3.0, 0.0);
        }
        let friction = stiffness * length * log_uniform(random, -2.0, 0.0);
        let count = [0, 1, 1, 1, 2, 2][random.random_range(0..6)];
        let causes: Vec<_> =
            (0..count).map(|_| Cause::draw(random, stiffness * length, angular, length, ratio)).collect();
        let moves = count == 0 || random.random_bool(0.6);
        let [position, velocity] = [length, speed].map(|scale| {
            let part = random.random_range(-1.0..1.0);
            if moves && random.random_bool(0.8) { scale * part } else { 0.0 }
        });
        Self {
            family,
            law: family.draw(random, friction / normal_load, speed, critical / normal_load, stiffness / normal_load),
            mass,
            stiffness,
            damping,
            pendulum: (!linear && random.random_bool(0.3)).then(|| length * random.random_range(0.7..3.0)),
            normal_load,
            position: if count == 0 && position == 0.0 && velocity == 0.0 { length } else { position },
            velocity,
            causes,
            duration: TAU / angular * random.random_range(0.5..2.5),
            length,
        }
    }

    /// The scenario, with each of its numbers passed through `number`, which gets its name too; none if the law is none
    /// at these numbers.
    pub(crate) fn scenario<D: Scalar>(
        &self,
        mut number: impl FnMut(&'static str, f64) -> D,
    ) -> Option<Scenario<D, AnyLaw<D>>> {
        let mut machine = Oscillator::new(number("m", self.mass), number("k", self.stiffness)).unwrap();
        let [linear, quadratic, cubic] = self.damping;
        let damping = Damping::new(number("c₁", linear), number("c₂", quadratic)).unwrap();
        machine = machine.with_damping(damping.with_cubic(number("c₃", cubic)).unwrap());
        if let Some(length) = self.pendulum {
            machine = machine.with_restoring(Restoring::sine(number("ℓ", length)).unwrap());
        }
        let law: Vec<D> = self.law.iter().map(|value| number("law", *value)).collect();
        let normal_load = number("N", self.normal_load);
        let start = (number("x₀", self.position), number("v₀", self.velocity));
        let scenario = Scenario::new(machine, self.family.law(&law)?, normal_load)
            .and_then(|scenario| scenario.starting_at(start.0, start.1))
            .unwrap();
        Some(self.causes.iter().fold(scenario, |scenario, cause| scenario.driven_by(cause.excitation(&mut number))))
    }

    /// The motion with each number passed through `number`; none if the law is none at these numbers.
    pub(crate) fn run<D: Scalar>(
        &self,
        solver: Solver,
        sampling: &Sampling,
        number: impl FnMut(&'static str, f64) -> D,
    ) -> Option<Result<Trajectory<D>, SimulationError>> {
        let scenario = self.scenario(number)?;
        Some(match solver {
            Solver::Exact => Exact.run(&scenario, sampling),
            Solver::RungeKutta(engine) => engine.run(&scenario, sampling),
        })
    }

    /// The motion as it is.
    pub(crate) fn motion(&self, solver: Solver, sampling: &Sampling) -> Trajectory {
        self.run(solver, sampling, |_, value| value).unwrap().unwrap_or_else(|error| panic!("{error}: {self}"))
    }

    /// The motion with derivatives in every number, in the order of [`numbers`](Self::numbers).
    pub(crate) fn gradient(&self, solver: Solver, sampling: &Sampling) -> Trajectory<Gradient> {
        let mut direction = 0;
        let seeded = |name, value| {
            direction += 1;
            // The exact engine has no derivative in damping that would take its closed form away.
            if matches!((solver, name), (Solver::Exact, "c₂" | "c₃")) {
                return Gradient::from(value);
            }
            Gradient::variable(value, direction - 1)
        };
        self.run(solver, sampling, seeded).unwrap().unwrap_or_else(|error| panic!("{error}: {self}"))
    }

    /// Names and values of all numbers.
    pub(crate) fn numbers(&self) -> Vec<(&'static str, f64)> {
        let mut numbers = Vec::new();
        self.scenario(|name, value| {
            numbers.push((name, value));
            value
        });
        numbers
    }

    /// Times at which the force has a kink or a jump (s).
    pub(crate) fn knots(&self) -> Vec<f64> {
        let knots = |cause: &Cause| match cause {
            Cause::Sampled { interval, values } => (0..values.len()).map(|index| index as f64 * interval).collect(),
            Cause::HalfSine { duration, delay, .. } => vec![*delay, delay + duration],
            Cause::Ramp { delay, .. } => vec![*delay],
            _ => Vec::new(),
        };
        self.causes.iter().flat_map(knots).collect()
    }

    /// True if the slope of the law at rest is steeper than any other, but not infinite.
    pub(crate) fn is_steep(&self) -> bool {
        matches!(self.family, Family::MakkarDixon | Family::RegularisedStribeck)
    }

    /// ω₀ (rad/s).
    pub(crate) fn angular(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// `count` equal intervals from the start to the end.
    pub(crate) fn sampling(&self, count: usize) -> Sampling {
        Sampling::uniform(self.duration / count as f64, count + 1).unwrap()
    }
}

impl Cause {
    /// A cause that matters to a machine of natural frequency `angular` on which `force` (N) deflects the spring by
    /// `length`; no wave near the resonance of a machine with little damping (`ratio`).
    fn draw(random: &mut ChaCha8Rng, force: f64, angular: f64, length: f64, ratio: f64) -> Self {
        let period = TAU / angular;
        let size = log_uniform(random, -1.0, 0.3);
        let size = signed(random, size);
        let mut relative = log_uniform(random, -1.0, 0.7);
        if ratio < 0.05 && (0.9..1.1).contains(&relative) {
            relative = 0.5;
        }
        let phase = random.random_range(-3.2..3.2);
        let delay = if random.random_bool(0.5) { 0.0 } else { period * random.random_range(0.0..1.0) };
        match random.random_range(0..6) {
            0 => {
                let values = (0..random.random_range(3..20)).map(|_| force * random.random_range(-1.5..1.5)).collect();
                Self::Sampled { interval: period * log_uniform(random, -2.0, -0.7), values }
            }
            1 => Self::HalfSine { peak: force * size * 3.0, duration: period * log_uniform(random, -1.5, 0.0), delay },
            2 => Self::Ramp { rate: force * angular * size * 0.3, delay },
            3 => Self::Harmonic { amplitude: force * size, angular: angular * relative, phase },
            4 => Self::Base { amplitude: length * size / relative.powi(2), angular: angular * relative, phase },
            _ => Self::Belt { velocity: length * angular * size * 0.4 },
        }
    }

    fn excitation<D: Scalar>(&self, number: &mut impl FnMut(&'static str, f64) -> D) -> Excitation<D> {
        match *self {
            Self::Sampled { interval, ref values } => {
                Excitation::sampled_force(interval, values.iter().map(|force| D::from(*force)).collect::<Vec<_>>())
            }
            Self::HalfSine { peak, duration, delay } => {
                Excitation::half_sine(number("peak", peak), number("duration", duration))
                    .unwrap()
                    .delayed(D::from(delay))
            }
            Self::Ramp { rate, delay } => Excitation::ramp(number("rate", rate)).unwrap().delayed(D::from(delay)),
            Self::Harmonic { amplitude, angular, phase } => {
                Excitation::harmonic(number("amplitude", amplitude), number("Ω", angular), number("φ", phase))
            }
            Self::Base { amplitude, angular, phase } => {
                Excitation::base(number("base amplitude", amplitude), number("Ω", angular), number("φ", phase))
            }
            Self::Belt { velocity } => Excitation::belt(number("v_b", velocity)),
        }
        .unwrap()
    }
}

impl fmt::Display for Setup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "in SI units, {self:?}")
    }
}
