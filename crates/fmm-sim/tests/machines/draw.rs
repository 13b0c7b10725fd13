//! Draws: machines, forces and starts.

use fmm_model::{Damping, Oscillator, Restoring};
use fmm_sim::{Excitation, Sampling};

/// Numbers that look random.
pub(crate) struct Draws(u64);

impl Draws {
    pub(crate) fn new(seed: u64) -> Self {
        let mut draws = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0xD1B5_4A32_D192_ED03));
        for _ in 0..4 {
            draws.next();
        }
        draws
    }

    /// In (0, 1).
    pub(crate) fn next(&mut self) -> f64 {
        // SplitMix64.
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.next()
    }

    /// Even in the logarithm.
    pub(crate) fn decades(&mut self, least: f64, most: f64) -> f64 {
        least * (most / least).powf(self.next())
    }

    pub(crate) fn one_of(&mut self, count: usize) -> usize {
        ((self.next() * count as f64) as usize).min(count - 1)
    }
}

/// Cause that acts from outside.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Cause {
    Free,
    /// N.
    Constant(f64),
    /// Amplitude (N), angular frequency (rad/s), phase (rad).
    Wave(f64, f64, f64),
    /// Peak (N), duration (s), delay (s).
    Pulse(f64, f64, f64),
    /// Interval (s), values (N).
    Samples(f64, Vec<f64>),
    /// m/s.
    Belt(f64),
}

impl Cause {
    /// The force (N) at `time`, the limit from above or, `before` a jump or corner, from below.
    pub(crate) fn force(&self, time: f64, before: bool) -> f64 {
        match self {
            Self::Free | Self::Belt(_) => 0.0,
            Self::Constant(force) => *force,
            Self::Wave(amplitude, angular, phase) => amplitude * (angular * time + phase).cos(),
            Self::Pulse(peak, duration, delay) => {
                let part = (time - delay) / duration;
                let acts = if before { part > 0.0 && part <= 1.0 } else { (0.0..1.0).contains(&part) };
                if acts { peak * (std::f64::consts::PI * part).sin() } else { 0.0 }
            }
            Self::Samples(interval, values) => {
                let place = time / interval;
                let mut left = place.floor() as usize;
                if before && place.fract() == 0.0 && left > 0 {
                    left -= 1;
                }
                let part = place - left as f64;
                values.get(left + 1).map_or(0.0, |next| values[left] + (next - values[left]) * part)
            }
        }
    }

    /// Times at which the force has a corner or a jump (s).
    pub(crate) fn corners(&self) -> Vec<f64> {
        match self {
            Self::Pulse(_, duration, delay) => vec![*delay, delay + duration],
            Self::Samples(interval, values) => (0..values.len()).map(|index| index as f64 * interval).collect(),
            _ => Vec::new(),
        }
    }

    pub(crate) fn belt(&self) -> f64 {
        if let Self::Belt(velocity) = self { *velocity } else { 0.0 }
    }

    /// A time in which the force changes (s).
    pub(crate) fn time(&self) -> f64 {
        match self {
            Self::Wave(_, angular, _) => 1.0 / angular,
            Self::Pulse(_, duration, _) => 0.3 * duration,
            _ => f64::INFINITY,
        }
    }

    pub(crate) fn excitation(&self) -> Option<Excitation> {
        let excitation = match self {
            Self::Free => return None,
            Self::Constant(force) => Excitation::constant(*force),
            Self::Wave(amplitude, angular, phase) => Excitation::harmonic(*amplitude, *angular, *phase),
            Self::Pulse(peak, duration, delay) => {
                Excitation::half_sine(*peak, *duration).and_then(|pulse| pulse.delayed(*delay))
            }
            Self::Samples(interval, values) => Excitation::sampled_force(*interval, values.clone()),
            Self::Belt(velocity) => Excitation::belt(*velocity),
        };
        Some(excitation.expect("a force"))
    }
}

/// A machine, its start and what acts on it.
#[derive(Debug, Clone)]
pub(crate) struct Machine {
    pub(crate) oscillator: Oscillator,
    pub(crate) start: (f64, f64),
    pub(crate) cause: Cause,
    /// N.
    pub(crate) load: f64,
    /// Friction force (N).
    pub(crate) friction: f64,
    /// A usual position (m) and angular frequency (rad/s).
    pub(crate) amplitude: f64,
    pub(crate) angular: f64,
    /// s.
    pub(crate) end: f64,
}

impl Machine {
    pub(crate) fn draw(draws: &mut Draws) -> Self {
        let mass = draws.decades(0.3, 30.0);
        let angular = draws.decades(3.0, 100.0);
        let amplitude = draws.decades(1e-3, 0.1);
        let stiffness = mass * angular * angular;
        let square = amplitude * amplitude;
        let near = amplitude * draws.decades(0.03, 1.3);
        let restoring = match draws.one_of(10) {
            0 | 1 => Restoring::gap(near),
            2 => Restoring::stop(near, draws.between(0.0, 1.0)),
            3 => Restoring::stop(near, draws.decades(1.0, 100.0)),
            4 => Restoring::stop(near, draws.decades(100.0, 1e4)),
            5 => Restoring::polynomial(
                draws.decades(0.01, 30.0) / square,
                draws.one_of(2) as f64 * 3.0 / square / square,
            ),
            6 => Restoring::polynomial(-draws.between(0.0, 0.3) / square, draws.decades(0.1, 10.0) / square / square),
            7 => {
                // At one of the places where rounding decides.
                let beside = [amplitude, amplitude.next_up(), amplitude.next_down(), amplitude * (1.0 - 1e-9)];
                let corner = beside[draws.one_of(4)];
                if draws.one_of(2) == 0 {
                    Restoring::gap(corner)
                } else {
                    Restoring::stop(corner, draws.decades(0.1, 1e3))
                }
            }
            _ => Ok(Restoring::Linear),
        };
        let restoring = restoring.expect("a spring");
        let ratio = draws.decades(1e-3, 0.05) * 2.0 * mass * angular;
        let damping = match draws.one_of(4) {
            0 => Damping::linear(ratio),
            1 => Damping::new(0.0, ratio / (amplitude * angular)),
            _ => Ok(Damping::none()),
        };
        let oscillator =
            Oscillator::new(mass, stiffness).unwrap().with_damping(damping.unwrap()).with_restoring(restoring);
        let force = stiffness * amplitude;
        let periods = std::f64::consts::TAU / angular;
        // A machine between hard stops swings faster.
        let hard = if let Restoring::Bilinear { outer, .. } = restoring { f64::sqrt(outer).max(1.0) } else { 1.0 };
        let end = periods * draws.between(0.6, 4.0) / (1.0 + 0.1 * (hard - 1.0));
        let cause = match draws.one_of(10) {
            0..=3 => Cause::Free,
            4 => Cause::Constant(force * draws.between(-0.5, 0.5)),
            5 | 6 => Cause::Wave(
                force * draws.decades(0.03, 1.0),
                angular * draws.decades(0.2, 4.0),
                draws.between(0.0, 6.0),
            ),
            7 => {
                let delay = [0.0, draws.between(0.0, 0.5 * end)][draws.one_of(2)];
                Cause::Pulse(force * draws.between(-2.0, 2.0), periods * draws.decades(0.01, 0.5), delay)
            }
            8 => {
                let count = 3 + draws.one_of(20);
                let values = (0..count).map(|_| force * draws.between(-0.5, 0.5)).collect();
                Cause::Samples(end / (count - 1) as f64 * draws.between(0.5, 1.2), values)
            }
            _ => Cause::Belt(amplitude * angular * draws.between(-0.7, 0.7)),
        };
        let start = match (draws.one_of(5), &cause) {
            (0, Cause::Wave(..) | Cause::Pulse(..) | Cause::Samples(..) | Cause::Belt(_)) => (0.0, 0.0),
            (0 | 1, _) => (amplitude, draws.between(-1.0, 1.0) * amplitude * angular),
            (2, _) => (-amplitude, 0.0),
            _ => (amplitude, 0.0),
        };
        let load = draws.decades(0.1, 100.0);
        let friction = force * [0.0, draws.decades(1e-4, 0.3), draws.decades(1e-2, 0.3)][draws.one_of(3)];
        Self { oscillator, start, cause, load, friction, amplitude, angular, end }
    }

    /// True for a spring that is not linear on a moving counterface, which only bristles take.
    pub(crate) fn has_belt_on_bent_spring(&self) -> bool {
        self.cause.belt() != 0.0 && !matches!(self.oscillator.restoring(), Restoring::Linear)
    }

    pub(crate) fn sampling(&self) -> Sampling {
        Sampling::uniform(self.end / 50.0, 51).unwrap().with_work()
    }
}
