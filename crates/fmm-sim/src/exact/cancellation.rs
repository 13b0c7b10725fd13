//! Cancellation in the closed form: on a weak spring it is a small difference of large numbers.

use fmm_model::{Oscillator, Scalar};

use crate::curve::Curve;
use crate::{SimulationError, State};

/// What rounding may make of the greatest position or velocity, relative to it.
const LOST: f64 = 1e-9;

/// ω₀ t over the sampled time t below which the spring does not shape the motion.
const WEAK: f64 = 1e-2;

/// Rounding of the terms of all stretches of a motion, and how far the motion has gone.
///
/// A stretch under a force f on a spring k has terms of f/k and ḟ/k, which cancel as long as the spring has not turned
/// the motion round. Their rounding adds up from stretch to stretch like that of independent numbers, that of the
/// velocity also in the position.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Cancellation {
    /// Sums of the squares of the terms (m², m²/s²).
    position: f64,
    velocity: f64,
    /// Greatest position (m) and velocity (m/s).
    reached: [f64; 2],
}

impl Cancellation {
    /// Notes a stretch along `path` of some `elapsed` time (s) from `begin` to `end`.
    pub(super) fn note<D: Scalar>(&mut self, path: &Curve<D>, elapsed: f64, begin: State<D>, end: State<D>) {
        let plain = |state: State<D>| (state.position.value(), state.velocity.value());
        let ((from, _), (to, _)) = (plain(begin), plain(end));
        let mean = if elapsed > 0.0 { (to - from).abs() / elapsed } else { 0.0 };
        self.reached[1] = self.reached[1].max(mean);
        self.reaches(begin);
        self.reaches(end);
        let free = path.free().map_or((0.0, 0.0, 0.0), |(decay, free)| {
            let (x, v) = plain(free);
            (x, v, decay.natural())
        });
        let slope = path.slope.value();
        let mut position = path.constant.value().abs() + (slope * elapsed).abs() + free.0.abs();
        let mut velocity = slope.abs() + free.1.abs() + free.2 * free.0.abs();
        for wave in &path.waves {
            let amplitude = wave.cosine.value().abs() + wave.sine.value().abs();
            position += amplitude;
            velocity += amplitude * wave.angular.value();
        }
        self.position += position * position;
        self.velocity += velocity * velocity;
    }

    /// Notes a state of the motion.
    pub(super) fn reaches<D: Scalar>(&mut self, state: State<D>) {
        for (reached, value) in self.reached.iter_mut().zip([state.position, state.velocity]) {
            *reached = reached.max(value.value().abs());
        }
    }

    /// Whether the spring of `oscillator` has turned the motion round by `end` (s), which bounds what is lost.
    pub(super) fn cannot_matter<D: Scalar>(oscillator: &Oscillator<D>, end: f64) -> bool {
        !(end > 0.0 && oscillator.natural_angular_frequency().value() * end < WEAK)
    }

    /// That enough digits are left at `end` (s) of a motion of `oscillator`, relative to the motion or to what the
    /// force `held` (N) at rest would move it by, if that is more.
    ///
    /// # Errors
    /// [`SimulationError::NoClosedForm`].
    pub(super) fn check<D: Scalar>(
        &self,
        oscillator: &Oscillator<D>,
        held: D,
        end: f64,
    ) -> Result<(), SimulationError> {
        if Self::cannot_matter(oscillator, end) {
            return Ok(());
        }
        let drift = end.min(oscillator.natural_angular_frequency().value().recip());
        let position = f64::EPSILON * self.position.sqrt().hypot(self.velocity.sqrt() * drift);
        let velocity = f64::EPSILON * self.velocity.sqrt();
        let [far, fast] = self.reached;
        let far = far.max(held.value() / oscillator.mass().value() * drift * drift);
        // A position as small as its rounding may still belong to a motion that is not.
        let far = far.max(fast * drift);
        if position > LOST * far || velocity > LOST * fast.max(far / drift) {
            return Err(SimulationError::weak_spring(oscillator.stiffness().value()));
        }
        Ok(())
    }
}
