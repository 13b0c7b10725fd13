//! Friction of an impact out of the height of a receptance peak, without and with viscous damping.

use std::f64::consts::PI;

use fmm_model::ModelError;

use crate::error::FrfError;
use crate::response::SingleDegreeOfFreedom;

impl SingleDegreeOfFreedom {
    /// Peak of the receptance (m/N) with dry friction after an impulse.
    ///
    /// ```text
    /// |H| = π J/(8 m ω₀ F)                                             without viscous damping
    /// |H| = h(q)/(c ω₀),   h(q) = 1 − ln(1 + q)/q,   q = π c J/(4 m F)                                 (1)
    /// ```
    ///
    /// | symbol | argument | unit | meaning |
    /// |---|---|---|---|
    /// | J | `impulse` | N s | impulse that sets the machine at rest in motion |
    /// | F | `friction_force` | N | kinetic friction, independent of velocity |
    ///
    /// # Derivation
    /// A short impulse J gives the machine at rest the velocity J/m and so the amplitude A₀ = J/(m ω₀). Dry friction F
    /// takes 4F/k off the amplitude in each period 2π/ω₀, which is a ramp:
    ///
    /// ```text
    /// A(t) = A₀ − 2F t/(π m ω₀),   0 ≤ t ≤ T,   T = π J/(2F)                                           (2)
    /// ```
    ///
    /// Half of x(t) = A(t) sin ω₀t turns with e^{−iω₀t} and adds up in the Fourier transform at ω₀; the rest averages
    /// out. With the area A₀T/2 of the ramp and the flat spectrum J of the impulse,
    ///
    /// ```text
    /// |X(ω₀)| = A₀T/4 = π J²/(8 m ω₀ F),   |H| = |X|/J = π J/(8 m ω₀ F)                                (3)
    /// ```
    ///
    /// Viscous damping takes β A more from the slope of the amplitude, with a = 2F/(π m ω₀) and β = c/2m:
    ///
    /// ```text
    /// A′ = −β A − a,   A(t) = (A₀ + a/β) e^{−βt} − a/β,   T = ln(1 + q)/β,   q = β A₀/a                (4)
    /// ```
    ///
    /// Half the area under A is |X(ω₀)| = (A₀ − a T)/2β. Without friction it is 1/(c ω₀), the peak of the linear
    /// machine; without damping q is zero and h(q) = q/2.
    ///
    /// A linear machine has a receptance that does not depend on the impulse; here it grows with it, and the slope over
    /// several impacts gives the friction. Effects that (1) leaves out on |H| for the machine of the tests:
    ///
    /// | left out | effect |
    /// |---|---|
    /// | amplitude falls by half cycles, not evenly, and rests off zero (9 to 16 half cycles) | +0.1 % to +0.5 % |
    /// | viscous damping of ζ = 0.001, if it is given as none | −1.6 % to −2.8 %, more for longer motions |
    /// | a record that ends after the part r of T | −(1 − r)² |
    /// | a half-sine pulse of duration τ instead of an impact without length | −(ω₀ τ)²/42, here −5e-5 |
    ///
    /// So the record must be longer than [`coulomb_impact_duration`] and taken without a window, and the pulse short
    /// against a period.
    ///
    /// ```
    /// use fmm_frf::SingleDegreeOfFreedom;
    ///
    /// // High impact of the thesis' chapter 8; simulations give 5.9617e-3 m/N without damping and 5.7933e-3 m/N.
    /// let dry = SingleDegreeOfFreedom::new(10.391, 0.0, 1982.0)?.peak_after_impact(1.64, 0.113 * 6.67)?;
    /// assert!((dry / 5.9617e-3 - 1.0).abs() < 2.5e-3);
    /// let damped = SingleDegreeOfFreedom::new(10.391, 0.275, 1982.0)?.peak_after_impact(1.64, 0.113 * 6.67)?;
    /// assert!((damped / 5.7933e-3 - 1.0).abs() < 2.5e-3);
    /// # Ok::<(), fmm_frf::FrfError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any argument, or for a result out of range.
    pub fn peak_after_impact(&self, impulse: f64, friction_force: f64) -> Result<f64, FrfError> {
        ModelError::require_positive("friction force", friction_force, "N")?;
        let undamped = self.undamped_product(impulse)? / friction_force;
        ModelError::require_positive("peak receptance", undamped, "m/N")?;
        // q/2 is the peak without viscous damping, by that without friction.
        let q = 2.0 * undamped * self.damping() * self.natural_angular_frequency();
        Ok(ModelError::require_positive("peak receptance", undamped * share(q), "m/N")?)
    }

    /// Kinetic friction force (N) out of a measured peak of the receptance (m/N) after an `impulse` (N s): the inverse
    /// of [`peak_after_impact`](Self::peak_after_impact), with the same conditions.
    ///
    /// Viscous damping that the machine is not given is counted as friction; a record that ends too early likewise.
    ///
    /// ```
    /// use fmm_frf::SingleDegreeOfFreedom;
    ///
    /// let machine = SingleDegreeOfFreedom::new(10.391, 0.275, 1982.0)?;
    /// assert!((machine.friction_after_impact(1.64, 5.7933e-3)? / (0.113 * 6.67) - 1.0).abs() < 2.5e-3);
    /// # Ok::<(), fmm_frf::FrfError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for any argument, and for the friction force if the
    /// peak is as high as the machine's own damping allows without friction, or higher.
    pub fn friction_after_impact(&self, impulse: f64, peak_receptance: f64) -> Result<f64, FrfError> {
        ModelError::require_positive("peak receptance", peak_receptance, "m/N")?;
        let undamped = self.undamped_product(impulse)? / peak_receptance;
        ModelError::require_positive("friction force", undamped, "N")?;
        let height = peak_receptance * self.damping() * self.natural_angular_frequency();
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

    /// |H| F = π J/(8 m ω₀) without viscous damping, a length (m).
    fn undamped_product(&self, impulse: f64) -> Result<f64, FrfError> {
        ModelError::require_positive("impulse", impulse, "N s")?;
        Ok(PI * impulse / (8.0 * self.mass() * self.natural_angular_frequency()))
    }
}

/// Time (s) until dry friction alone has stopped the motion after an impulse, and so the
/// least length of a record of it; Eq. (2) of [`SingleDegreeOfFreedom::peak_after_impact`].
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

#[cfg(test)]
mod tests {
    use super::*;

    fn dry(mass: f64, omega: f64) -> SingleDegreeOfFreedom {
        SingleDegreeOfFreedom::new(mass, 0.0, mass * omega * omega).unwrap()
    }

    #[test]
    fn the_inverse_is_one() {
        let peak = dry(10.391, 13.8).peak_after_impact(1.42, 0.75).unwrap();
        let friction = dry(10.391, 13.8).friction_after_impact(1.42, peak).unwrap();
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
        let peak = dry(mass, omega).peak_after_impact(impulse, friction).unwrap();
        // What the derivation averages out leaves A₀/(4 ω₀) in quadrature, which is 1/(ω₀T) of the peak. Beside that
        // the rule errs by (ω₀Δt)²/(6 ω₀T), below 1e-8, in quadrature too.
        let quadrature = 1.0 / (omega * duration);
        let expected = peak * quadrature.hypot(1.0);
        assert!((transform / expected - 1.0).abs() < 1e-10, "{transform} m/N, not {expected} m/N");
    }

    #[test]
    fn impossible_arguments_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for (impulse, other) in [(bad, 1.0), (1.0, bad)] {
                assert!(dry(1.0, 1.0).peak_after_impact(impulse, other).is_err(), "{impulse} N s, {other} N");
                assert!(dry(1.0, 1.0).friction_after_impact(impulse, other).is_err(), "{impulse} N s, {other} m/N");
            }
            assert!(coulomb_impact_duration(bad, 1.0).is_err() && coulomb_impact_duration(1.0, bad).is_err());
        }
        assert!(dry(1e-300, 1.0).peak_after_impact(1e300, 1.0).is_err(), "overflow");
    }

    #[test]
    fn the_inverse_with_viscous_damping_is_one() {
        for damping in [0.0, 1e-6, 0.275, 8.0] {
            let machine = SingleDegreeOfFreedom::new(10.391, damping, 1982.0).unwrap();
            for friction in [1e-2, 0.75, 40.0] {
                let peak = machine.peak_after_impact(1.42, friction).unwrap();
                let found = machine.friction_after_impact(1.42, peak).unwrap();
                // Where friction is small beside damping, the peak hardly knows of it.
                let blur = 1e-14 / (1.0 - peak * damping * machine.natural_angular_frequency());
                assert!((found / friction - 1.0).abs() < blur, "c = {damping}: {found} N, not {friction} N");
            }
        }
    }

    #[test]
    fn both_limits_are_those_of_one_kind_of_damping() {
        let machine = |damping| SingleDegreeOfFreedom::new(2.0, damping, 50.0).unwrap();
        let coulomb = PI * 1.3 / (8.0 * 2.0 * 5.0 * 0.7);
        let found = machine(0.0).peak_after_impact(1.3, 0.7).unwrap();
        assert!((found / coulomb - 1.0).abs() < 1e-15, "{found} m/N, not {coulomb} m/N");
        let found = machine(0.4).peak_after_impact(1.3, 1e-9).unwrap();
        assert!((found * 0.4 * 5.0 - 1.0).abs() < 1e-7, "{found} m/N, not 1/(c ω₀)");
        assert!(machine(0.4).friction_after_impact(1.3, 0.5).is_err(), "no friction left");
    }

    /// Across the switch from series to formula nothing jumps by more than the formula's rounding, 2ε/q.
    #[test]
    fn series_and_formula_meet() {
        let (below, above) = (1e-2 * (1.0 - 1e-15), 1e-2);
        assert!((share(below) - share(above)).abs() < 1e-13, "{} and {}", share(below), share(above));
        assert!((slope(below) - slope(above)).abs() < 1e-13, "{} and {}", slope(below), slope(above));
    }
}
