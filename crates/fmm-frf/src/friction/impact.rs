//! Friction of an impact out of the height of a receptance peak, without and with viscous damping.

use std::f64::consts::PI;

use fmm_model::ModelError;

use crate::error::FrfError;
use crate::response::SingleDegreeOfFreedom;

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
/// several impacts gives the friction. Effects that (2) leaves out on |H| for the machine of the tests:
///
/// | left out | effect |
/// |---|---|
/// | amplitude falls by half cycles, not evenly, and rests away from zero (9 to 16 half cycles) | +0.1 % to +0.3 % |
/// | viscous damping of ζ = 0.001 besides | −1.6 % to −2.8 %, the more the longer the motion lasts |
/// | a record that ends after the part r of T | −(1 − r)² |
/// | a half-sine pulse of duration τ instead of an impact without length | −(ω₀ τ)²/42, here −5e-5 |
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

/// Peak of the receptance (m/N) of a `machine` with viscous damping and a `friction_force` F (N) after an `impulse` J
/// (N s).
///
/// ```text
/// |H| = h(q)/(c ω₀),   h(q) = 1 − ln(1 + q)/q,   q = π c J/(4 m F)                                     (1)
/// ```
///
/// # Derivation
/// Both together take a from the slope of the amplitude that [`peak_receptance_of_coulomb_impact`] has and β A from its
/// size, with a = 2F/(π m ω₀) and β = c/2m:
///
/// ```text
/// A′ = −β A − a,   A(t) = (A₀ + a/β) e^{−βt} − a/β,   T = ln(1 + q)/β,   q = β A₀/a                    (2)
/// ```
///
/// Half the area under A is |X(ω₀)| = (A₀ − a T)/2β, and A₀ = J/(m ω₀). Without friction it is 1/(c ω₀), the peak of
/// the linear machine; without damping q is zero and h(q) = q/2. A simulated
/// peak of the machine of the thesis' chapter 8 is 0.2 % to 0.5 % above (1), as it is above the formula without damping
/// where there is none; ignoring its c costs 1.3 % to 2.7 %.
///
/// ```
/// use fmm_frf::{SingleDegreeOfFreedom, peak_receptance_of_viscous_coulomb_impact};
///
/// // High impact of chapter 8; a simulation gives 5.7933e-3 m/N, and the formula without damping 5.9541e-3 m/N.
/// let machine = SingleDegreeOfFreedom::new(10.391, 0.275, 1982.0)?;
/// let peak = peak_receptance_of_viscous_coulomb_impact(1.64, &machine, 0.113 * 6.67)?;
/// assert!((peak / 5.7933e-3 - 1.0).abs() < 2.5e-3);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # Errors
/// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any argument, or for a result out of range.
pub fn peak_receptance_of_viscous_coulomb_impact(
    impulse: f64,
    machine: &SingleDegreeOfFreedom,
    friction_force: f64,
) -> Result<f64, FrfError> {
    let (mass, omega) = (machine.mass(), machine.natural_angular_frequency());
    let undamped = peak_receptance_of_coulomb_impact(impulse, mass, omega, friction_force)?;
    // q/2 is the peak without viscous damping, by that without friction.
    let q = 2.0 * undamped * machine.damping() * omega;
    Ok(ModelError::require_positive("peak receptance", undamped * share(q), "m/N")?)
}

/// Kinetic friction force (N) out of a measured peak of the receptance (m/N) of a `machine` whose viscous damping is
/// known, the inverse of [`peak_receptance_of_viscous_coulomb_impact`].
///
/// ```
/// use fmm_frf::{SingleDegreeOfFreedom, friction_force_of_viscous_coulomb_impact};
///
/// let machine = SingleDegreeOfFreedom::new(10.391, 0.275, 1982.0)?;
/// let friction = friction_force_of_viscous_coulomb_impact(1.64, &machine, 5.7933e-3)?;
/// assert!((friction / (0.113 * 6.67) - 1.0).abs() < 2.5e-3);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # Errors
/// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any argument, and for the friction force if the peak
/// is as high as the machine's own damping allows without friction, or higher.
pub fn friction_force_of_viscous_coulomb_impact(
    impulse: f64,
    machine: &SingleDegreeOfFreedom,
    peak_receptance: f64,
) -> Result<f64, FrfError> {
    let (mass, omega) = (machine.mass(), machine.natural_angular_frequency());
    let undamped = friction_force_of_coulomb_impact(impulse, mass, omega, peak_receptance)?;
    let height = peak_receptance * machine.damping() * omega;
    if height >= 1.0 {
        return Err(ModelError::NotPositive { quantity: "friction force", value: 0.0, unit: "N" }.into());
    }
    // h rises and bends down, so that Newton's steps from the left never pass the root; h(q) < q/2 puts 2h there.
    let mut q = 2.0 * height;
    for _ in 0..200 {
        let step = (height - 0.5 * q * share(q)) / slope(q);
        if !(step > 1e-15 * q) {
            break;
        }
        q += step;
    }
    // |H| of the formula without damping is q/2 where the measured one is h(q).
    Ok(ModelError::require_positive("friction force", undamped * share(q), "N")?)
}

/// h(q)/(q/2) = 2 (q − ln(1 + q))/q², from 1 at q = 0 downwards.
fn share(q: f64) -> f64 {
    if q < 1e-2 {
        // 2 Σ (−q)ⁿ/(n + 2), where the difference would cancel.
        (0..9).rev().fold(0.0, |sum, n| 2.0 / f64::from(n + 2) - q * sum)
    } else {
        2.0 * (q - q.ln_1p()) / (q * q)
    }
}

/// dh/dq = (ln(1 + q) − q/(1 + q))/q².
fn slope(q: f64) -> f64 {
    if q < 1e-2 {
        // Σ (−q)ⁿ (n + 1)/(n + 2).
        (0..9).rev().fold(0.0, |sum, n| f64::from(n + 1) / f64::from(n + 2) - q * sum)
    } else {
        (q.ln_1p() - q / (1.0 + q)) / (q * q)
    }
}

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
    fn the_inverse_is_one() {
        let peak = peak_receptance_of_coulomb_impact(1.42, 10.391, 13.8, 0.75).unwrap();
        let friction = friction_force_of_coulomb_impact(1.42, 10.391, 13.8, peak).unwrap();
        assert!((friction / 0.75 - 1.0).abs() < 4e-16, "{friction} N");
    }

    /// Transform of the ramp itself, A(t) sin ω₀t with 200 half cycles, by the midpoint rule.
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

    #[test]
    fn the_inverse_with_viscous_damping_is_one() {
        for damping in [0.0, 1e-6, 0.275, 8.0] {
            let machine = SingleDegreeOfFreedom::new(10.391, damping, 1982.0).unwrap();
            for friction in [1e-2, 0.75, 40.0] {
                let peak = peak_receptance_of_viscous_coulomb_impact(1.42, &machine, friction).unwrap();
                let found = friction_force_of_viscous_coulomb_impact(1.42, &machine, peak).unwrap();
                // Where friction is small beside damping, the peak hardly knows of it.
                let blur = 1e-14 / (1.0 - peak * damping * machine.natural_angular_frequency());
                assert!((found / friction - 1.0).abs() < blur, "c = {damping}: {found} N, not {friction} N");
            }
        }
    }

    #[test]
    fn both_limits_are_those_of_one_kind_of_damping() {
        let machine = |damping| SingleDegreeOfFreedom::new(2.0, damping, 50.0).unwrap();
        let coulomb = peak_receptance_of_coulomb_impact(1.3, 2.0, 5.0, 0.7).unwrap();
        let found = peak_receptance_of_viscous_coulomb_impact(1.3, &machine(0.0), 0.7).unwrap();
        assert!((found / coulomb - 1.0).abs() < 1e-15, "{found} m/N, not {coulomb} m/N");
        let found = peak_receptance_of_viscous_coulomb_impact(1.3, &machine(0.4), 1e-9).unwrap();
        assert!((found * 0.4 * 5.0 - 1.0).abs() < 1e-7, "{found} m/N, not 1/(c ω₀)");
        assert!(friction_force_of_viscous_coulomb_impact(1.3, &machine(0.4), 0.5).is_err(), "no friction left");
    }

    /// Across the switch from series to formula nothing jumps by more than the formula's rounding, 2ε/q.
    #[test]
    fn series_and_formula_meet() {
        let (below, above) = (1e-2 * (1.0 - 1e-15), 1e-2);
        assert!((share(below) - share(above)).abs() < 1e-13, "{} and {}", share(below), share(above));
        assert!((slope(below) - slope(above)).abs() < 1e-13, "{} and {}", slope(below), slope(above));
    }

    #[test]
    fn a_cycle_dissipates_as_much() {
        let (friction, amplitude, omega) = (0.7, 0.02, 13.0);
        let damping = equivalent_damping_of_friction(friction, amplitude * omega).unwrap();
        // 4 F X against π c ω X².
        let (dry, viscous) = (4.0 * friction * amplitude, PI * damping * omega * amplitude * amplitude);
        assert!((dry / viscous - 1.0).abs() < 1e-15, "{dry} J, {viscous} J");
    }

    #[test]
    fn impossible_cycles_are_refused() {
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(equivalent_damping_of_friction(bad, 1.0).is_err(), "{bad} N");
            assert!(equivalent_damping_of_friction(1.0, bad).is_err(), "{bad} m/s");
        }
        assert!(equivalent_damping_of_friction(1.0, 0.0).is_err());
        assert_eq!(equivalent_damping_of_friction(0.0, 1.0), Ok(0.0));
        assert!(equivalent_damping_of_friction(1e300, 1e-300).is_err(), "overflow");
    }
}
