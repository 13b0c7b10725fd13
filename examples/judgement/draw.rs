//! Random machines.

use std::f64::consts::PI;

use fmm_record::Quantity;

use super::thesis::largest;
use super::{Case, Found, Random, Setup, noise};

/// Between which bounds machines are drawn, all but the last evenly over octaves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ranges {
    /// f₀ (Hz).
    pub(crate) frequency: (f64, f64),
    /// Half swings before the stop or the end (1).
    pub(crate) half_cycles: (f64, f64),
    /// Amplitude over noise (1).
    pub(crate) signal_to_noise: (f64, f64),
    /// Damping ratio of the machine (1).
    pub(crate) damping_ratio: (f64, f64),
}

/// Ranges of any machine that one may meet.
pub(crate) const ANY: Ranges = Ranges {
    frequency: (0.5, 20.0),
    half_cycles: (4.0, 60.0),
    signal_to_noise: (100.0, 2000.0),
    damping_ratio: (0.0, 0.02),
};
/// Ranges of machines like the thesis'.
pub(crate) const LIKE_THESIS: Ranges = Ranges {
    frequency: (1.0, 5.0),
    half_cycles: (6.0, 40.0),
    signal_to_noise: (100.0, 1000.0),
    damping_ratio: (0.0, 0.003),
};
/// m (kg), x₀ (m) and samples a period (1) of all.
const MASSES: (f64, f64) = (0.1, 100.0);
const RELEASES: (f64, f64) = (1e-3, 0.1);
const SAMPLES: (f64, f64) = (30.0, 500.0);

/// Where a record ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// After the stop, or after the half swings drawn.
    Any,
    /// While it still moves.
    BeforeStop,
    /// One to three periods after the stop.
    AfterStop,
}

/// A machine, how long it is watched and how well.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drawn {
    pub(crate) mass: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) release: f64,
    /// Friction force (N) that a contact of one level has, so that the half swings are as drawn.
    pub(crate) friction: f64,
    half_cycles: f64,
    samples: f64,
    signal_to_noise: f64,
}

/// Amplitude at the release by the deflection that friction holds, for a stop after `half_cycles`, with a share `left`
/// (0 to 1) of that deflection, when damping takes the amplitude to a share `kept` each half swing.
///
/// ```text
/// A(j + 1) = A(j) q − δ (1 + q),    A(n) = left · δ
/// ```
fn ratio(half_cycles: f64, left: f64, kept: f64) -> f64 {
    (0..half_cycles as u32).fold(left, |amplitude, _| (amplitude + 1.0 + kept) / kept)
}

impl Ranges {
    /// A machine, in whose records friction is `share` (1) of what would stop it at their end.
    pub(crate) fn draw(&self, share: f64, random: &mut Random) -> Drawn {
        let log = |random: &mut Random, (low, high): (f64, f64)| random.log_uniform(low, high);
        let angular = 2.0 * PI * log(random, self.frequency);
        let mass = log(random, MASSES);
        let half_cycles = log(random, self.half_cycles).round();
        // By damping alone the amplitude falls to a fifth at most: friction must be there to be found.
        let most = self.damping_ratio.1.min(1.5 / (PI * half_cycles));
        let damping_ratio = random.uniform(self.damping_ratio.0.min(most), most);
        let release = log(random, RELEASES);
        let stiffness = mass * angular * angular;
        let kept = (-PI * damping_ratio / (1.0 - damping_ratio * damping_ratio).sqrt()).exp();
        let friction = share * stiffness * release / ratio(half_cycles, random.uniform(0.0, 1.0), kept);
        Drawn {
            mass,
            stiffness,
            damping: 2.0 * damping_ratio * mass * angular,
            release,
            friction,
            half_cycles,
            samples: log(random, SAMPLES),
            signal_to_noise: log(random, self.signal_to_noise),
        }
    }
}

impl Drawn {
    /// ω₀ x₀, nearly the largest speed (m/s).
    pub(crate) fn speed(&self) -> f64 {
        (self.stiffness / self.mass).sqrt() * self.release
    }

    /// Half cycles before the stop or the end (1).
    pub(crate) fn half_cycles(&self) -> f64 {
        self.half_cycles
    }

    /// Samples a period (1).
    pub(crate) fn samples(&self) -> f64 {
        self.samples
    }

    /// Largest speed over noise (1).
    pub(crate) fn signal_to_noise(&self) -> f64 {
        self.signal_to_noise
    }

    /// A contact of `law` on it under `load` (N).
    pub(crate) fn with(&self, law: &'static str, values: Vec<f64>, load: f64, right: &[&'static str]) -> Setup {
        Setup {
            mass: self.mass,
            stiffness: self.stiffness,
            damping: self.damping,
            quadratic: 0.0,
            load,
            release: self.release,
            law,
            values,
            right: right.to_vec(),
        }
    }

    /// A record of `quantity` of `setup`, this machine with a contact, which ends as `end` says.
    pub(crate) fn record(&self, setup: &Setup, quantity: Quantity, end: End, random: &mut Random) -> Found<Case> {
        let period = 2.0 * PI / setup.angular_frequency();
        let interval = period / self.samples;
        let planned = 0.5 * self.half_cycles * period;
        let longest = planned + 4.0 * period;
        let whole = setup.motion(interval, (longest / interval).ceil() as usize)?;
        let stop = whole.rest().map_or(planned, |rest| rest.time);
        let seconds = match end {
            End::Any => stop.min(planned) + random.uniform(0.0, 2.0) * period,
            End::BeforeStop => (random.uniform(0.5, 0.9) * stop).max(1.5 * period),
            End::AfterStop => stop + random.uniform(1.0, 3.0) * period,
        };
        let count = (seconds / interval).ceil() as usize;
        let channel = if quantity == Quantity::Displacement { whole.position() } else { whole.velocity() };
        let mut values = channel.values()[..count.min(channel.values().len())].to_vec();
        let deviation = largest(&values) / self.signal_to_noise;
        noise::white(&mut values, deviation, random);
        Case::new(setup, values, interval, quantity, largest(whole.velocity().values()))
    }
}
