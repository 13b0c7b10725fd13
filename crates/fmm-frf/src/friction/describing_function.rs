//! Describing function: viscous damping equivalent to dry friction in a harmonic motion.

use std::f64::consts::PI;

use crate::{FrfError, ModelError};

/// c_eq, the viscous coefficient (N s/m) that dissipates as much per cycle as a `friction_force` F (N), for a harmonic
/// motion of velocity amplitude V (m/s).
///
/// ```text
/// c_eq = 4F/(π V),   V = ω X
/// ```
///
/// It is the describing function of F sgn v: the first harmonic of the square wave, 4F/π, by the amplitude of the
/// velocity. The equivalent damping falls as the amplitude grows, which is why a response with friction depends on the
/// force. It holds as long as the motion does not stick, and for the first harmonic alone.
///
/// ```
/// // Chapter 8: a friction of 0.754 N weighs as much as c = 9.6 N s/m at 0.1 m/s; the machine's own damping is 0.275 N s/m.
/// let damping = fmm_frf::equivalent_damping_of_friction(0.113 * 6.67, 0.1)?;
/// assert!((damping - 9.5965).abs() < 5e-5);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # Errors
/// [`ModelError::Negative`](crate::ModelError::Negative) for the friction force,
/// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for the amplitude,
/// [`ModelError::NotFinite`](crate::ModelError::NotFinite) for a result out of range.
pub fn equivalent_damping_of_friction(friction_force: f64, velocity_amplitude: f64) -> Result<f64, FrfError> {
    ModelError::require_not_negative("friction force", friction_force, "N")?;
    ModelError::require_positive("velocity amplitude", velocity_amplitude, "m/s")?;
    let damping = 4.0 * friction_force / (PI * velocity_amplitude);
    Ok(ModelError::require_finite("equivalent damping", damping, "N s/m")?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cycle_dissipates_as_much() {
        let (friction, amplitude, omega) = (0.7, 0.02, 13.0);
        let damping = equivalent_damping_of_friction(friction, amplitude * omega).unwrap();
        // 4 F X against π c ω X².
        let (dry, viscous) = (4.0 * friction * amplitude, PI * damping * omega * amplitude * amplitude);
        assert!((dry / viscous - 1.0).abs() < 1e-15, "{dry} J, {viscous} J");
    }

    #[test]
    fn impossible_arguments_are_refused() {
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(equivalent_damping_of_friction(bad, 1.0).is_err(), "{bad} N");
            assert!(equivalent_damping_of_friction(1.0, bad).is_err(), "{bad} m/s");
        }
        assert!(equivalent_damping_of_friction(1.0, 0.0).is_err());
        assert_eq!(equivalent_damping_of_friction(0.0, 1.0), Ok(0.0));
        assert!(equivalent_damping_of_friction(1e300, 1e-300).is_err(), "overflow");
    }
}
