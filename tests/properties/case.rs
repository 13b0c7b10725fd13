//! Random machines with a dry contact, over all the ranges that a laboratory could ask for.

use std::f64::consts::TAU;
use std::fmt;

use fmm_friction::{CoulombStatic, PiecewiseLinearLaw};
use fmm_model::{Damping, Oscillator, Scalar};
use fmm_sim::{Engine, Exact, Mode, Sampling, Scenario, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// One machine, its contact, how it is let go and how it is sampled.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Case {
    pub(crate) mass: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) sliding: f64,
    pub(crate) breakaway: f64,
    pub(crate) normal_load: f64,
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) interval: f64,
    pub(crate) count: usize,
}

/// Longest record drawn; the number of periods is cut, never the sampling rate.
const LONGEST: f64 = 6000.0;

/// `count` random cases, the same for the same seed.
pub(crate) fn cases(seed: u64, count: usize) -> impl Iterator<Item = Case> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..count).map(move |_| Case::draw(&mut random))
}

/// Ten to a power that is uniform between the two exponents.
pub(crate) fn log_uniform(random: &mut ChaCha8Rng, lower: f64, upper: f64) -> f64 {
    10f64.powf(random.random_range(lower..upper))
}

/// A log-uniform number of either sign, or zero in one of seven cases.
fn signed(random: &mut ChaCha8Rng, lower: f64, upper: f64) -> f64 {
    let magnitude = log_uniform(random, lower, upper);
    match random.random_range(0..7) {
        0 => 0.0,
        1..4 => magnitude,
        _ => -magnitude,
    }
}

impl Case {
    fn draw(random: &mut ChaCha8Rng) -> Self {
        let mass = log_uniform(random, -3.0, 3.0);
        let angular = TAU * log_uniform(random, -2.0, 4.0);
        let stiffness = mass * angular * angular;
        let ratio = match random.random_range(0..10) {
            0..2 => 0.0,
            2..5 => log_uniform(random, -5.0, 0.0),
            5..7 => random.random_range(0.0..3.0),
            7 => 1.0 - log_uniform(random, -12.0, -1.0),
            8 => 1.0 + log_uniform(random, -12.0, -1.0),
            _ => 1.0,
        };
        let (position, velocity) = (signed(random, -6.0, 0.0), signed(random, -6.0, 0.0) * angular);
        let amplitude = position.hypot(velocity / angular);
        let force = stiffness * if amplitude > 0.0 { amplitude } else { 1e-3 } * log_uniform(random, -3.0, 0.5);
        let normal_load = if random.random_bool(0.03) { 0.0 } else { log_uniform(random, -2.0, 3.0) };
        let sliding = match normal_load {
            _ if random.random_bool(0.1) => 0.0,
            0.0 => log_uniform(random, -3.0, 0.5),
            load => force / load,
        };
        let breakaway = sliding * if random.random_bool(0.5) { 1.0 } else { random.random_range(1.0..3.0) };
        let samples_per_period = log_uniform(random, 4f64.log10(), 4.0);
        let periods = log_uniform(random, -1.0, 1.5);
        Self {
            mass,
            stiffness,
            damping: 2.0 * ratio * (stiffness * mass).sqrt(),
            sliding,
            breakaway,
            normal_load,
            position,
            velocity,
            interval: TAU / angular / samples_per_period,
            count: (periods * samples_per_period).clamp(2.0, LONGEST) as usize,
        }
    }

    pub(crate) fn oscillator(&self) -> Oscillator {
        Oscillator::new(self.mass, self.stiffness).unwrap().with_damping(Damping::linear(self.damping).unwrap())
    }

    pub(crate) fn scenario(&self) -> Scenario<f64, CoulombStatic> {
        self.with_law(CoulombStatic::new(self.sliding, self.breakaway).unwrap())
    }

    /// The same machine and start with another law in the contact.
    pub(crate) fn with_law<L>(&self, law: L) -> Scenario<f64, L> {
        Scenario::new(self.oscillator(), law, self.normal_load)
            .and_then(|scenario| scenario.starting_at(self.position, self.velocity))
            .unwrap()
    }

    pub(crate) fn sampling(&self) -> Sampling {
        Sampling::uniform(self.interval, self.count).unwrap()
    }

    /// The motion by the exact engine.
    pub(crate) fn run(&self) -> Trajectory {
        exactly(self, &self.scenario(), &self.sampling())
    }

    /// ω₀ (rad/s).
    pub(crate) fn angular(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// ζ (1).
    pub(crate) fn damping_ratio(&self) -> f64 {
        self.oscillator().damping_ratio()
    }

    /// Friction force while sliding (N).
    pub(crate) fn friction(&self) -> f64 {
        self.sliding * self.normal_load
    }

    /// Kinetic and potential energy at the start (J).
    pub(crate) fn energy(&self) -> f64 {
        energy(self, self.position, self.velocity)
    }

    /// √(x₀² + v₀²/ω₀²), the largest distance from the force-free position that the energy allows (m).
    pub(crate) fn amplitude(&self) -> f64 {
        self.position.hypot(self.velocity / self.angular())
    }

    /// Largest distance that enters the arithmetic (m): the amplitude and the shift of the centre by friction.
    pub(crate) fn size(&self) -> f64 {
        self.amplitude() + self.friction() / self.stiffness
    }

    /// How much larger than the motion the two parts are whose sum it is: (v₀ + a x₀)/ω_d grows towards critical
    /// damping, until at 1 − ζ² = 1e-6 the engine takes a series that has no such parts.
    pub(crate) fn conditioning(&self) -> f64 {
        let ratio = self.damping_ratio();
        1.0 + (1.0 + ratio) / (1.0 - ratio * ratio).max(1e-6).sqrt().min(1.0)
    }

    /// Rounding of a sampled position at `time` (m); that of a velocity is ω₀ times as large.
    ///
    /// 32 ulp for the closed form and its table of powers (16 at most), and one ulp of the time, which is one of the
    /// phase ω₀ t, for each of the two times between which the phase is taken.
    pub(crate) fn rounding(&self, time: f64) -> f64 {
        f64::EPSILON * (32.0 + 2.0 * self.angular() * time) * self.conditioning() * self.size()
    }
}

/// Kinetic and potential energy (J) of a state of the machine of `case`.
pub(crate) fn energy(case: &Case, position: f64, velocity: f64) -> f64 {
    0.5 * (case.mass * velocity * velocity + case.stiffness * position * position)
}

/// A run of the exact engine that has to succeed.
pub(crate) fn exactly<D: Scalar, L: PiecewiseLinearLaw<D>>(
    case: &Case,
    scenario: &Scenario<D, L>,
    sampling: &Sampling,
) -> Trajectory<D> {
    Exact.run(scenario, sampling).unwrap_or_else(|error| panic!("{error}: {case}"))
}

/// Path that the contact has slid up to `time`, where it is at `position` (m). Between events it slides one way.
pub(crate) fn slid(motion: &Trajectory, time: f64, position: f64) -> f64 {
    let passed = motion.events().iter().take_while(|event| event.time <= time);
    let mut path = 0.0;
    let mut before = None;
    for event in passed {
        path += before.map_or(0.0, |before: f64| (event.position - before).abs());
        before = Some(event.position);
    }
    path + before.map_or(0.0, |before| (position - before).abs())
}

/// −1, 0 or 1: the sense in which a contact in `mode` slides.
pub(crate) fn sense(mode: Mode) -> f64 {
    match mode {
        Mode::Slip(direction) => direction.sign(),
        _ => 0.0,
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "m = {:?} kg, k = {:?} N/m, c = {:?} N s/m (ζ = {}), μ = {:?}, μ_s = {:?}, N = {:?} N, x₀ = {:?} m, \
             v₀ = {:?} m/s, {} samples every {:?} s",
            self.mass,
            self.stiffness,
            self.damping,
            self.damping_ratio(),
            self.sliding,
            self.breakaway,
            self.normal_load,
            self.position,
            self.velocity,
            self.count,
            self.interval
        )
    }
}
