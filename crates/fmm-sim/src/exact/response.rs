//! The motion of a linear machine under a line and waves of force.

use fmm_model::Scalar;

use crate::curve::{Curve, Wave};
use crate::decay::Decay;
use crate::{SimulationError, State};

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
