//! Damping of the machine itself: sums of powers of the velocity.

use core::f64::consts::PI;

use crate::error::ModelError;
use crate::math;
use crate::scalar::Scalar;

/// Damping force opposing the motion, as the sum of a linear, a quadratic, a cubic and a free power of the velocity.
///
/// ```text
/// F(v) = c₁ v + c₂ |v| v + c₃ v³ + c_p |v|ᵖ sgn v                 (thesis A3–A6; A dx² there)
/// ```
///
/// | symbol | method | unit | meaning |
/// |---|---|---|---|
/// | c₁ | [`linear`](Self::linear) | N s/m | viscous coefficient |
/// | c₂ | [`new`](Self::new) | N s²/m² | drag coefficient |
/// | c₃ | [`with_cubic`](Self::with_cubic) | N s³/m³ | nonlinear damping |
/// | c_p, p | [`with_power`](Self::with_power) | N (s/m)ᵖ, 1 | power law with a free exponent |
///
/// Per unit mass the units are 1/s, 1/m, s/m² and so on.
///
/// # References
/// S. Zaitsev, O. Shtempluck, E. Buks, O. Gottlieb, "Nonlinear damping in a micromechanical oscillator", Nonlinear
/// Dynamics 67 (2012) 859 (the cubic term).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping<D = f64> {
    linear: D,
    quadratic: D,
    cubic: D,
    power: Option<(D, D)>,
    /// Velocity of the medium, if it moves.
    wind: Option<D>,
}

impl<D: Scalar> Damping<D> {
    /// No damping at all.
    pub fn none() -> Self {
        let zero = D::from(0.0);
        Self { linear: zero, quadratic: zero, cubic: zero, power: None, wind: None }
    }

    /// Viscous damping `c₁` (N s/m).
    ///
    /// # Errors
    /// [`ModelError::Negative`] if the coefficient is negative or not finite.
    pub fn linear(coefficient: impl Into<D>) -> Result<Self, ModelError> {
        Self::new(coefficient.into(), D::from(0.0))
    }

    /// Linear damping `c₁` (N s/m) and quadratic damping `c₂` (N s²/m²) together.
    ///
    /// # Errors
    /// [`ModelError::Negative`] if a coefficient is negative or not finite.
    pub fn new(linear: D, quadratic: D) -> Result<Self, ModelError> {
        ModelError::require_not_negative("linear damping", linear.value(), "N s/m")?;
        ModelError::require_not_negative("quadratic damping", quadratic.value(), "N s²/m²")?;
        Ok(Self { linear, quadratic, ..Self::none() })
    }

    /// Linear damping `c₁` (N s/m) and quadratic damping `c₂` (N s²/m²) of any sign, for fits that leave the sign to
    /// the record. Negative damping feeds the motion; in a fit it stands for friction that falls with
    /// speed.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] if a coefficient is not finite.
    pub fn of_any_sign(linear: D, quadratic: D) -> Result<Self, ModelError> {
        ModelError::require_finite("linear damping", linear.value(), "N s/m")?;
        ModelError::require_finite("quadratic damping", quadratic.value(), "N s²/m²")?;
        Ok(Self { linear, quadratic, ..Self::none() })
    }

    /// The damping whose equivalent viscous coefficient is a straight line in the *peak* velocity V of a half cycle,
    /// c(V) = `intercept` (N s/m) + `slope` (N s²/m²) · V, from a fit to half cycles (thesis Eq. 5.5).
    ///
    /// ```text
    /// c₁ = intercept,   c₂ = 3π/8 · slope
    /// ```
    ///
    /// The inverse of [`cycle_equivalent`](Self::cycle_equivalent): the line of the thesis, 0.2005 + 0.437 V, is the
    /// drag coefficient 0.5148 N s²/m² of the instantaneous velocity.
    ///
    /// ```
    /// use fmm_model::Damping;
    ///
    /// let damping = Damping::<f64>::from_peak_velocity_line(0.2005, 0.437)?;
    /// assert!((damping.quadratic_coefficient() - 0.5148).abs() < 5e-5);
    /// assert!((damping.cycle_equivalent(0.2) - (0.2005 + 0.437 * 0.2)).abs() < 1e-15);
    /// # Ok::<(), fmm_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::Negative`] if a coefficient is negative or not finite.
    pub fn from_peak_velocity_line(intercept: D, slope: D) -> Result<Self, ModelError> {
        ModelError::require_not_negative("intercept of damping over peak velocity", intercept.value(), "N s/m")?;
        ModelError::require_not_negative("slope of damping over peak velocity", slope.value(), "N s²/m²")?;
        Self::new(intercept, slope * (3.0 * PI / 8.0))
    }

    /// The same damping with a cubic part `c₃` (N s³/m³).
    ///
    /// # Errors
    /// [`ModelError::Negative`] if the coefficient is negative or not finite.
    pub fn with_cubic(mut self, coefficient: D) -> Result<Self, ModelError> {
        ModelError::require_not_negative("cubic damping", coefficient.value(), "N s³/m³")?;
        self.cubic = coefficient;
        Ok(self)
    }

    /// The same damping with a part c_p |v|ᵖ of `coefficient` c_p (N (s/m)ᵖ) and `exponent` p (1).
    ///
    /// # Errors
    /// [`ModelError::Negative`] if the coefficient is negative or not finite, [`ModelError::NotPositive`] if the
    /// exponent is not positive or not finite.
    pub fn with_power(mut self, coefficient: D, exponent: D) -> Result<Self, ModelError> {
        ModelError::require_not_negative("power-law damping", coefficient.value(), "N (s/m)^p")?;
        ModelError::require_positive("damping exponent", exponent.value(), "(dimensionless)")?;
        self.power = (!vanishes(coefficient)).then_some((coefficient, exponent));
        Ok(self)
    }

    /// The same damping with its quadratic part in a medium that moves at `velocity` w (m/s), such as the drag of a
    /// vehicle in wind, less the force on the machine at rest:
    ///
    /// ```text
    /// c₂ (|v − w| (v − w) + |w| w) in the place of c₂ |v| v
    /// ```
    ///
    /// The part that is left out is constant: a force that does not depend on the motion is no damping.
    ///
    /// ```
    /// use fmm_model::Damping;
    ///
    /// let drag = Damping::new(0.0, 0.4)?.with_wind(3.0)?;
    /// // At 20 m/s against a medium that moves at 3 m/s, and back.
    /// assert!((drag.force(20.0) - 0.4 * (17.0 * 17.0 + 9.0)).abs() < 1e-12);
    /// assert!((drag.force(-20.0) - 0.4 * (9.0 - 23.0 * 23.0)).abs() < 1e-12);
    /// assert_eq!(drag.force(0.0), 0.0);
    /// # Ok::<(), fmm_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] if the velocity is not finite.
    pub fn with_wind(mut self, velocity: D) -> Result<Self, ModelError> {
        ModelError::require_finite("velocity of the medium", velocity.value(), "m/s")?;
        self.wind = (!vanishes(velocity)).then_some(velocity);
        Ok(self)
    }

    /// c₁, the viscous coefficient (N s/m).
    pub fn linear_coefficient(&self) -> D {
        self.linear
    }

    /// c₂, the drag coefficient (N s²/m²).
    pub fn quadratic_coefficient(&self) -> D {
        self.quadratic
    }

    /// c₃, the cubic coefficient (N s³/m³).
    pub fn cubic_coefficient(&self) -> D {
        self.cubic
    }

    /// Coefficient c_p (N (s/m)ᵖ) and exponent p of the power-law part, if there is one.
    pub fn power(&self) -> Option<(D, D)> {
        self.power
    }

    /// True if there is no part but the linear one, in value and in every derivative.
    pub fn is_linear(&self) -> bool {
        vanishes(self.quadratic) && vanishes(self.cubic) && self.power.is_none()
    }

    /// F(v), the damping force (N) at `velocity` (m/s); in a medium at rest it has the sign of the velocity.
    pub fn force(&self, velocity: D) -> D {
        let speed = velocity.abs();
        let mut force = velocity * (self.linear + speed * (self.quadratic + speed * self.cubic));
        if let Some(wind) = self.wind {
            let through = velocity - wind;
            force += self.quadratic * (through.abs() * through + wind.abs() * wind - speed * velocity);
        }
        match self.power {
            Some((coefficient, exponent)) if speed.value() > 0.0 => {
                force + coefficient * speed.powf(exponent) * velocity.value().signum()
            }
            _ => force,
        }
    }

    /// The viscous coefficient (N s/m) that dissipates as much per cycle as all parts together, for a harmonic
    /// motion of velocity amplitude `peak_velocity` V ≥ 0 (m/s).
    ///
    /// ```text
    /// c(V) = c₁ + 8/(3π) c₂ V + 3/4 c₃ V² + γ(p) c_p Vᵖ⁻¹,   γ(p) = 2/√π Γ(p/2 + 1)/Γ(p/2 + 3/2)
    /// ```
    ///
    /// The factors are the cycle averages of |sin|ᵖ⁺¹ over that of sin²; a line fitted to damping against *peak*
    /// velocity (thesis Eq. 5.5) therefore has a slope of 8/(3π) c₂, not c₂.
    pub fn cycle_equivalent(&self, peak_velocity: D) -> D {
        let polynomial = self.linear
            + self.quadratic * peak_velocity * (8.0 / (3.0 * PI))
            + self.cubic * peak_velocity * peak_velocity * 0.75;
        match self.power {
            Some((coefficient, exponent)) => {
                polynomial + coefficient * peak_velocity.powf(exponent - 1.0) * mean_of_sine_power(exponent + 1.0) * 2.0
            }
            None => polynomial,
        }
    }
}

/// True if `number` is zero in value and in every derivative.
fn vanishes<D: Scalar>(number: D) -> bool {
    number.value() == 0.0 && (0..D::DIRECTIONS).all(|direction| number.partial(direction) == 0.0)
}

/// (2/π) ∫₀^{π/2} sin^p θ dθ, the mean of |sin θ|ᵖ over a cycle.
///
/// The substitution θ = g(u) with all low derivatives of g zero at both ends turns the integrand into one for which
/// the trapezoidal rule converges faster than any power, also where p is not an integer.
fn mean_of_sine_power<D: Scalar>(power: D) -> D {
    const STEPS: i32 = 64;
    // tanh-sinh: θ = π/4 (1 + tanh(π/2 sinh u)), |u| ≤ 3.2, where the weights have fallen below 1e-15.
    let step = 6.4 / f64::from(STEPS);
    let mut sum = D::from(0.0);
    for i in 0..=STEPS {
        let u = -3.2 + step * f64::from(i);
        let inner = PI / 2.0 * math::sinh(u);
        // sin(π/4 (1 + tanh s)) with 1 + tanh s as 2/(1 + e^(−2s)): no cancellation at the lower end.
        let angle = PI / 2.0 / (1.0 + (-2.0 * inner).exp());
        let weight = PI / 2.0 * math::cosh(u) / math::cosh(inner).powi(2);
        let sine = angle.sin();
        if sine > 0.0 {
            sum += (power * sine.ln()).exp() * weight;
        }
    }
    sum * (step / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::Dual;

    /// A medium at rest, of a velocity that is an unknown, has a derivative: −2 c₂ |v|.
    #[test]
    fn a_wind_of_zero_has_a_derivative() {
        let drag =
            Damping::new(Dual::<1>::from(0.0), Dual::from(0.4)).unwrap().with_wind(Dual::variable(0.0, 0)).unwrap();
        let force = drag.force(Dual::from(20.0));
        assert!((force.value() - 160.0).abs() < 1e-12 && (force.partial(0) + 16.0).abs() < 1e-12, "{force:?}");
    }

    /// A coefficient that is zero but has a derivative is a part of the damping.
    #[test]
    fn a_power_that_is_zero_has_its_derivative() {
        let power = |coefficient| Damping::none().with_power(coefficient, Dual::<1>::from(2.0)).unwrap();
        assert!((power(Dual::variable(0.0, 0)).force(Dual::from(3.0)).partial(0) - 9.0).abs() < 1e-12);
        assert!(power(Dual::from(0.0)).is_linear() && !power(Dual::variable(0.0, 0)).is_linear());
    }

    #[test]
    fn cycle_equivalent_dissipates_as_much_as_both_parts() {
        let damping: Damping = Damping::new(0.2005, 0.5148).unwrap();
        let (peak, steps) = (0.2, 20_000);
        let mut work = [0.0; 2];
        for i in 0..steps {
            // Midpoint rule over one period of a periodic integrand with kinks: error of order 1/steps².
            let v = peak * (2.0 * PI * (f64::from(i) + 0.5) / f64::from(steps)).sin();
            work[0] += (0.2005 * v + 0.5148 * v.abs() * v) * v;
            work[1] += damping.cycle_equivalent(peak) * v * v;
        }
        assert!((work[0] / work[1] - 1.0).abs() < 1e-8, "ratio {}", work[0] / work[1]);
        // Thesis Eq. 5.5 has 0.437; the instantaneous law needs 0.5148 (errata, E23).
        assert!((damping.cycle_equivalent(1.0) - 0.2005 - 0.437).abs() < 5e-5);
    }

    /// Γ-function values: mean of |sin|ᵖ is 1/2, 4/(3π), 3/8 for p = 2, 3, 4 and Γ(5/4)/(√π Γ(7/4)) = 0.556417… for
    /// 3/2.
    #[test]
    fn powers_have_the_equivalent_of_their_closed_form() {
        for (power, mean) in [(2.0, 0.5), (3.0, 4.0 / (3.0 * PI)), (4.0, 0.375), (1.5, 0.556_417_894_449_382_2)] {
            let got = mean_of_sine_power(power);
            assert!((got - mean).abs() < 1e-12, "p = {power}: {got} against {mean}");
        }
        let quadratic = Damping::new(0.1, 0.5).unwrap();
        let power = Damping::new(0.1, 0.0).unwrap().with_power(0.5, 2.0).unwrap();
        assert!((quadratic.cycle_equivalent(0.3) - power.cycle_equivalent(0.3)).abs() < 1e-14);
        for v in [-0.7, 0.0, 0.2] {
            assert!((quadratic.force(v) - power.force(v)).abs() < 1e-16, "at {v} m/s");
            assert_eq!(quadratic.force(v), -quadratic.force(-v));
        }
        assert_eq!(Damping::none().with_cubic(2.0).unwrap().force(-0.5), -0.25);
    }

    #[test]
    fn negative_or_infinite_coefficients_are_refused() {
        assert!(Damping::none().with_cubic(-1.0).is_err());
        assert!(Damping::none().with_power(1.0, 0.0).is_err());
        assert!(Damping::<f64>::linear(-0.1).is_err());
        assert!(Damping::new(0.0, f64::NAN).is_err());
        let line = Damping::from_peak_velocity_line(0.1, -1.0).unwrap_err().to_string();
        assert_eq!(line, "slope of damping over peak velocity must be zero or positive and finite, but is -1 N s²/m²");
        assert!(Damping::new(f64::INFINITY, 0.0).is_err());
    }
}
