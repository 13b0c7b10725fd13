//! Curves over the speed without a Stribeck shape of their own: exponential, hyperbolic, a power.

use fmm_model::{Bounds, Parameter, Scalar};

use crate::law::family::law_family;
use crate::law::functions::power;
use crate::law::{LawError, LawFamily, LawParameter, Role, SearchStage, SlidingLaw, SpecialCase};

law_family! {
    /// Berger's exponentially falling friction.
    ///
    /// ```text
    /// F = N (μ₀ + μ₁ exp(−α v))                                      (thesis Eq. 7.4)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ₀ | `coefficient` | 1 | coefficient at large speed |
    /// | μ₁ | `excess` | 1 | how far the coefficient at zero speed lies above it |
    /// | α | `decay` | s/m | inverse of the speed over which the excess falls |
    ///
    /// The static level is μ₀ + μ₁. With μ₁ = 0 this is [`Coulomb`](crate::Coulomb) with μ₀, with α = 0 with μ₀ + μ₁,
    /// each bit for bit; for α → ∞ it becomes [`CoulombStatic`](crate::CoulombStatic).
    ///
    /// ```
    /// use fmm_friction::{Berger, SlidingLaw};
    ///
    /// // A row of the thesis' Table 5.
    /// let law = Berger::new(0.228, 0.261, 2.852)?;
    /// assert_eq!(law.breakaway(), 0.489);
    /// assert!((law.coefficient(0.2_f64) - 0.375_543).abs() < 1e-6);
    /// # Ok::<(), fmm_friction::LawError>(())
    /// ```
    ///
    /// # References
    /// E. J. Berger, "Friction modeling for dynamic system simulation", Applied Mechanics Reviews 55 (2002) 535,
    /// doi 10.1115/1.1501080.
    pub struct Berger, "berger", sliding {
        coefficient: LawParameter::level("coefficient", "μ₀").typically(0.7),
        excess: LawParameter::not_negative("excess_coefficient", "μ₁", "1", Role::Excess).typically(0.6),
        decay: LawParameter::not_negative("decay", "α", "s/m", Role::Shape).typically(3.0),
    }

    /// `coefficient` μ₀ (1) at large speed, `excess` μ₁ (1) at zero speed and its `decay` α (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter is negative or not finite.
    pub fn new {}
    special cases [SpecialCase::of("coulomb")]
    tried [SearchStage::OfSpeed.trial().damped()]
}

impl<D: Scalar> SlidingLaw<D> for Berger<D> {
    fn coefficient(&self, speed: D) -> D {
        self.coefficient + self.excess * (-(self.decay * speed)).exp()
    }

    fn breakaway(&self) -> D {
        self.coefficient + self.excess
    }
}

law_family! {
    /// Hyperbolically falling friction.
    ///
    /// ```text
    /// F = N μ_s/(1 + δ v)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_s | `breakaway` | 1 | coefficient at zero speed and at breakaway |
    /// | δ | `decay` | s/m | inverse of the speed at which the coefficient has halved |
    ///
    /// There is no Coulomb level: the coefficient falls to zero. With δ = 0 this is [`Coulomb`](crate::Coulomb).
    ///
    /// # References
    /// R. I. Leine, D. H. van Campen, A. de Kraker, L. van den Steen, "Stick-slip vibrations induced by alternate
    /// friction models", Nonlinear Dynamics 16 (1998) 41, doi 10.1023/A:1008289604683.
    pub struct Hyperbolic, "hyperbolic", sliding {
        breakaway: LawParameter::level("static_coefficient", "μ_s").typically(1.3),
        decay: LawParameter::not_negative("decay", "δ", "s/m", Role::Shape).typically(0.5),
    }

    /// Coefficient `breakaway` μ_s (1) at zero speed, falling with `decay` δ (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if either is negative or not finite.
    pub fn new {}
    special cases [SpecialCase::of("coulomb")]
    tried [SearchStage::OfSpeed.trial().damped()]
}

impl<D: Scalar> SlidingLaw<D> for Hyperbolic<D> {
    fn coefficient(&self, speed: D) -> D {
        self.breakaway / (self.decay * speed + 1.0)
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }
}

law_family! {
    /// Friction that grows with a power of the speed, above a Coulomb level.
    ///
    /// ```text
    /// F = N (a vᵖ + b)                                               (thesis Eq. 7.2)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | a | `amplitude` | (s/m)ᵖ | coefficient above the level at 1 m/s |
    /// | p | `exponent` | 1 | between 0 and 1 |
    /// | b | `coefficient` | 1 | coefficient in the limit of zero speed and at breakaway |
    ///
    /// The thesis fits this curve to coefficients averaged over whole tests, not to an instantaneous law. As a law it
    /// creeps for ever: a load L a little above b N moves at ((L/N − b)/a)^(1/p). With p = 1 it is
    /// [`CoulombViscous`](crate::CoulombViscous), with a = 0 [`Coulomb`](crate::Coulomb).
    ///
    /// For p < 1 the slope at zero speed is +∞: the value at v = 0 carries the derivatives in the parameters, which are
    /// finite, and none in the speed.
    pub struct PowerLaw, "power_law", sliding {
        amplitude: LawParameter::not_negative("power_coefficient", "a", "(s/m)^p", Role::Level).typically(0.5),
        exponent: LawParameter::new(
            Parameter::new("exponent", "p", "1").bounded(Bounds::POSITIVE.at_most(1.0)),
            Role::Shape,
        ),
        coefficient: LawParameter::level("coefficient", "b").typically(0.6),
    }

    /// `amplitude` a ((s/m)ᵖ) and `exponent` p (1) of the power and its `coefficient` b (1).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite.
    pub fn new {}
    special cases [SpecialCase::at("coulomb", &[("power_coefficient", 0.0)]), SpecialCase::of("coulomb_viscous")]
    tried [SearchStage::OfSpeed.trial()]
}

impl<D: Scalar> SlidingLaw<D> for PowerLaw<D> {
    fn coefficient(&self, speed: D) -> D {
        self.amplitude * power(speed, self.exponent) + self.coefficient
    }

    fn breakaway(&self) -> D {
        self.coefficient
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The curve that the thesis fits, at 1 m/s and at 2⁻¹⁰ m/s, where the power is 2^(−2.116).
    #[test]
    fn rises_as_a_power_from_its_level() {
        let law = PowerLaw::new(0.311, 0.2116, 0.031_48).unwrap();
        assert_eq!((law.coefficient(0.0), law.breakaway()), (0.031_48, 0.031_48));
        assert!((law.coefficient(1.0) - 0.342_48).abs() < 1e-16);
        let expected = 0.311 * f64::exp2(-2.116) + 0.031_48;
        assert!((law.coefficient(f64::exp2(-10.0)) - expected).abs() < 1e-15);
        let refused = PowerLaw::new(0.3, 1.2, 0.0).unwrap_err().to_string();
        assert_eq!(refused, "exponent must be in (0, 1], but is 1.2");
        assert!(PowerLaw::new(0.3, 0.0, 0.0).is_err());
    }
}
