//! Friction out of the height of a receptance peak.

use std::f64::consts::PI;

use crate::{FrfError, ModelError};

/// Peak of the receptance (m/N) of an oscillator with dry friction after an impulse.
///
/// ```text
/// |H| = π J/(8 m ω₀ F)
/// ```
///
/// | symbol | argument | unit | meaning |
/// |---|---|---|---|
/// | J | `impulse` | N s | impulse that sets the machine at rest in motion |
/// | m | `mass` | kg | moving mass |
/// | ω₀ | `natural_angular_frequency` | rad/s | √(k/m) |
/// | F | `friction_force` | N | kinetic friction, independent of velocity |
///
/// # Derivation
/// A short impulse J gives an oscillator (m, ω₀) at rest the velocity J/m and so the amplitude A₀ = J/(m ω₀). Dry
/// friction F takes 4F/k off the amplitude in each period 2π/ω₀, which is a ramp:
///
/// ```text
/// A(t) = A₀ − 2F t/(π m ω₀),   0 ≤ t ≤ T,   T = π J/(2F)                                             (1)
/// ```
///
/// Half of x(t) = A(t) sin ω₀t turns with e^{−iω₀t} and adds up in the Fourier transform at ω₀; the rest averages
/// out. With the area A₀T/2 of the ramp and the flat spectrum J of the impulse,
///
/// ```text
/// |X(ω₀)| = A₀T/4 = π J²/(8 m ω₀ F),   |H| = |X|/J = π J/(8 m ω₀ F)                                  (2)
/// ```
///
/// A linear machine has a receptance that does not depend on the impulse; here it grows with it, and the slope over
/// several blows gives the friction. What (2) leaves out, with its effect on |H| for the machine of the tests:
///
/// | left out | effect |
/// |---|---|
/// | amplitude falls by half swings, not evenly, and rests away from zero (9 to 16 half swings) | +0.1 % to +0.3 % |
/// | viscous damping of ζ = 0.001 besides | −1.6 % to −2.8 %, the more the longer the motion lasts |
/// | a record that ends after the part r of T | −(1 − r)² |
/// | a half-sine pulse of duration τ instead of a blow without length | −(ω₀ τ)²/42, here −5e-5 |
///
/// So the record must be longer than [`coulomb_impact_duration`] and taken without a window, the pulse short against
/// a period, and other damping small.
///
/// ```
/// // Low impact of the thesis' chapter 8 machine; a simulation without viscous damping gives 3.5695e-3 m/N.
/// let peak = fmm_frf::peak_receptance_of_coulomb_impact(0.98, 10.391, 13.810_94, 0.113 * 6.67)?;
/// assert!((peak - 3.5580e-3).abs() < 5e-8);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # Errors
/// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any argument, or for a result out of range.
pub fn peak_receptance_of_coulomb_impact(
    impulse: f64,
    mass: f64,
    natural_angular_frequency: f64,
    friction_force: f64,
) -> Result<f64, FrfError> {
    ModelError::require_positive("friction force", friction_force, "N")?;
    let product = peak_times_friction(impulse, mass, natural_angular_frequency)?;
    Ok(ModelError::require_positive("peak receptance", product / friction_force, "m/N")?)
}

/// Kinetic friction force (N) out of a measured peak of the receptance (m/N): the inverse of
/// [`peak_receptance_of_coulomb_impact`], with the same conditions.
///
/// ```text
/// F = π J/(8 m ω₀ |H|)
/// ```
///
/// Viscous damping, which lowers the peak, is counted as friction; a record that ends too early likewise.
///
/// ```
/// let friction = fmm_frf::friction_force_of_coulomb_impact(0.98, 10.391, 13.810_94, 3.5695e-3)?;
/// assert!((friction / (0.113 * 6.67) - 1.0).abs() < 0.004);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # Errors
/// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any argument, or for a result out of range.
pub fn friction_force_of_coulomb_impact(
    impulse: f64,
    mass: f64,
    natural_angular_frequency: f64,
    peak_receptance: f64,
) -> Result<f64, FrfError> {
    ModelError::require_positive("peak receptance", peak_receptance, "m/N")?;
    let product = peak_times_friction(impulse, mass, natural_angular_frequency)?;
    Ok(ModelError::require_positive("friction force", product / peak_receptance, "N")?)
}

/// Time (s) until dry friction alone has stopped the motion after an impulse, and so the
/// least length of a record of it; Eq. (1) of [`peak_receptance_of_coulomb_impact`].
///
/// ```text
/// T = π J/(2F)
/// ```
///
/// The motion sticks up to half a period before or after.
///
/// # Errors
/// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any argument, or for a result out of range.
pub fn coulomb_impact_duration(impulse: f64, friction_force: f64) -> Result<f64, FrfError> {
    ModelError::require_positive("impulse", impulse, "N s")?;
    ModelError::require_positive("friction force", friction_force, "N")?;
    Ok(ModelError::require_positive("duration", 0.5 * PI * impulse / friction_force, "s")?)
}

/// |H| F = π J/(8 m ω₀), a length (m).
fn peak_times_friction(impulse: f64, mass: f64, natural_angular_frequency: f64) -> Result<f64, FrfError> {
    ModelError::require_positive("impulse", impulse, "N s")?;
    ModelError::require_positive("mass", mass, "kg")?;
    ModelError::require_positive("natural angular frequency", natural_angular_frequency, "rad/s")?;
    Ok(PI * impulse / (8.0 * mass * natural_angular_frequency))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_is_one() {
        let peak = peak_receptance_of_coulomb_impact(1.42, 10.391, 13.8, 0.75).unwrap();
        let friction = friction_force_of_coulomb_impact(1.42, 10.391, 13.8, peak).unwrap();
        assert!((friction / 0.75 - 1.0).abs() < 4e-16, "{friction} N");
    }

    /// Transform of the ramp itself, A(t) sin ω₀t with 200 half swings, by the midpoint rule.
    #[test]
    fn the_peak_is_the_transform_of_the_ramp() {
        let (impulse, mass, omega) = (1.3, 2.0, 5.0);
        let friction = 0.5 * PI * impulse / (200.0 * PI / omega);
        let duration = coulomb_impact_duration(impulse, friction).unwrap();
        let steps = 200_000;
        let step = duration / f64::from(steps);
        let (mut cosine, mut sine) = (0.0, 0.0);
        for i in 0..steps {
            let t = (f64::from(i) + 0.5) * step;
            let x = impulse / (mass * omega) * (1.0 - t / duration) * (omega * t).sin();
            cosine += x * (omega * t).cos() * step;
            sine += x * (omega * t).sin() * step;
        }
        let transform = f64::hypot(cosine, sine) / impulse;
        let peak = peak_receptance_of_coulomb_impact(impulse, mass, omega, friction).unwrap();
        // What the derivation averages out leaves A₀/(4 ω₀) in quadrature, which is 1/(ω₀T) of the peak. Beside that
        // the rule errs by (ω₀Δt)²/(6 ω₀T), below 1e-8, in quadrature too.
        let quadrature = 1.0 / (omega * duration);
        let expected = peak * quadrature.hypot(1.0);
        assert!((transform / expected - 1.0).abs() < 1e-10, "{transform} m/N, not {expected} m/N");
    }

    #[test]
    fn impossible_arguments_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for place in 0..4 {
                let mut a = [1.0; 4];
                a[place] = bad;
                assert!(peak_receptance_of_coulomb_impact(a[0], a[1], a[2], a[3]).is_err(), "{a:?}");
                assert!(friction_force_of_coulomb_impact(a[0], a[1], a[2], a[3]).is_err(), "{a:?}");
            }
            assert!(coulomb_impact_duration(bad, 1.0).is_err() && coulomb_impact_duration(1.0, bad).is_err());
        }
        assert!(peak_receptance_of_coulomb_impact(1e300, 1e-300, 1.0, 1.0).is_err(), "overflow");
    }
}
