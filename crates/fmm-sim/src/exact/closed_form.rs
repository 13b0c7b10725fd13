//! Closed form of a forced linear machine, and the digits that it loses on a weak spring.

use fmm_model::{Oscillator, Scalar};

use crate::error::SimulationError;
use crate::mechanics::{Curve, Decay, WEAK_SPRING, Wave};
use crate::scenario::State;

/// Nearer to resonance than this (as |k − m Ω² + icΩ|/k), the amplitudes of forced and free motion cancel to more than
/// three digits.
const RESONANCE: f64 = 1e-3;

/// The position from `state` on of a machine of `mass`, `damping` and `stiffness`, whose free motion is `decay`, under
/// `force`.
///
/// # Errors
/// [`SimulationError::NoClosedForm`] for a wave near the resonance of a machine with hardly any damping.
pub(super) fn respond<'a, D: Scalar>(
    force: Curve<'static, D>,
    mass: D,
    damping: D,
    stiffness: D,
    decay: &'a Decay<D>,
    state: State<D>,
) -> Result<Curve<'a, D>, SimulationError> {
    let mut forced = force;
    if forced.is_free() {
        forced.constant /= stiffness;
        let free = State { position: state.position - forced.constant, velocity: state.velocity };
        return Ok(forced.decaying(decay, free));
    }
    forced.slope /= stiffness;
    forced.constant = (forced.constant - damping * forced.slope) / stiffness;
    for wave in &mut forced.waves {
        let spring = stiffness - mass * wave.angular * wave.angular;
        let drag = damping * wave.angular;
        if !(spring.value().hypot(drag.value()) > RESONANCE * stiffness.value()) {
            return Err(SimulationError::resonance(wave.angular.value()));
        }
        let square = spring * spring + drag * drag;
        *wave = Wave {
            angular: wave.angular,
            cosine: (spring * wave.cosine - drag * wave.sine) / square,
            sine: (drag * wave.cosine + spring * wave.sine) / square,
        };
    }
    let steady = forced.forced_state(D::from(0.0));
    let free = State { position: state.position - steady.position, velocity: state.velocity - steady.velocity };
    Ok(forced.decaying(decay, free))
}

/// Greatest rounding of a position or velocity, relative to the greatest one of the motion (1).
const LOST: f64 = 1e-9;

/// Rounding of the terms of all stretches of a motion, and the greatest position and velocity.
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
        let free = path.decay.map_or((0.0, 0.0, 0.0), |(decay, free)| {
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

    /// True if the spring of `oscillator` has turned the motion round by `end` (s), which bounds the loss.
    pub(super) fn cannot_matter<D: Scalar>(oscillator: &Oscillator<D>, end: f64) -> bool {
        !(end > 0.0 && oscillator.natural_angular_frequency().value() * end < WEAK_SPRING)
    }

    /// Checks that enough digits are left at `end` (s) of a motion of `oscillator`, relative to the motion or to the
    /// displacement by the force `held` (N) at rest, if that is greater.
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
        // A position as small as its rounding may belong to a larger motion.
        let far = far.max(fast * drift);
        if position > LOST * far || velocity > LOST * fast.max(far / drift) {
            return Err(SimulationError::weak_spring(oscillator.stiffness().value()));
        }
        Ok(())
    }
}
