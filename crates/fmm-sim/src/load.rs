//! Load on a contact: what the drive, the damping and the spring leave for friction.

use fmm_model::{Oscillator, Restoring, Scalar};

use crate::State;
use crate::curve::{Curve, Wave};
use crate::drive::Piece;
use crate::first_zero::ROUNDING;

/// Load left for friction at constant velocity from `state` at `time` on: L = f − F_c − F_k (N).
pub(crate) fn load<D: Scalar>(
    oscillator: &Oscillator<D>,
    piece: &Piece<D>,
    time: D,
    state: State<D>,
) -> Curve<'static, D> {
    let State { position, velocity } = state;
    let mut load = Curve::force(piece, time);
    load.constant -= oscillator.damping().force(velocity);
    match oscillator.restoring() {
        Restoring::Sine { length } if velocity.value() != 0.0 => {
            // −k ℓ sin((x + v τ)/ℓ) is a wave.
            let (sin, cos) = (position / length).sin_cos();
            let force = oscillator.stiffness() * length;
            let sign = velocity.value().signum();
            let angular = velocity.abs() / length;
            load.waves.push(Wave { angular, cosine: -(force * sin), sine: -(force * cos) * sign });
        }
        restoring => {
            // Of a spring that is not linear the slope holds for this instant.
            load.constant -= oscillator.restoring_force(position);
            if velocity.value() != 0.0 {
                load.slope -= restoring.slope(oscillator.stiffness(), position).0 * velocity;
            }
        }
    }
    load
}

/// Rounding (N) that `load` carries, the load at `state` and `time`: that of its terms, and of the time itself.
pub(crate) fn rounding<D: Scalar, E: Scalar>(
    oscillator: &Oscillator<D>,
    load: &Curve<E>,
    time: D,
    state: State<D>,
) -> f64 {
    let spring = 2.0 * oscillator.restoring_force(state.position).value().abs();
    let (mut force, mut rate) = (load.constant.value().abs() + spring, load.slope.value().abs());
    for wave in &load.waves {
        let amplitude = wave.cosine.value().hypot(wave.sine.value());
        force += amplitude;
        rate += amplitude * wave.angular.value();
    }
    ROUNDING * (force + rate * time.value())
}
