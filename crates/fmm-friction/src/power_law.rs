//! Friction that grows with a power of the speed.

use fmm_model::{Bounds, Parameter, Scalar};

use crate::family::law_family;
use crate::power::power;
use crate::{LawError, LawFamily, LawParameter, Role, SlidingLaw};

law_family! {
    /// Friction that grows with a power of the speed, above a Coulomb floor.
    ///
    /// ```text
    /// F = N (a vᵖ + b)                                               (thesis Eq. 7.2)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | a | `amplitude` | (s/m)ᵖ | coefficient above the floor at 1 m/s |
    /// | p | `exponent` | 1 | between 0 and 1 |
    /// | b | `floor` | 1 | coefficient in the limit of zero speed and at breakaway |
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
        floor: LawParameter::level("coefficient", "b").typically(0.6),
    }

    /// `amplitude` a ((s/m)ᵖ) and `exponent` p (1) of the power and its `floor` b (1).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite.
    pub fn new {}
    special cases [crate::SpecialCase::of("coulomb_viscous")]
    tried [crate::SearchStage::FurtherOfSpeed.trial()]
}

impl<D: Scalar> SlidingLaw<D> for PowerLaw<D> {
    fn coefficient(&self, speed: D) -> D {
        self.amplitude * power(speed, self.exponent) + self.floor
    }

    fn breakaway(&self) -> D {
        self.floor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The curve that the thesis fits, at 1 m/s and at 2⁻¹⁰ m/s, where the power is 2^(−2.116).
    #[test]
    fn rises_as_a_power_from_its_floor() {
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
