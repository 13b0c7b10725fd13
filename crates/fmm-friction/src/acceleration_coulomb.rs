//! Coulomb friction with one level while the speed grows and another while it falls.

use fmm_model::Scalar;

use crate::family::law_family;
use crate::{Affine, LawError, LawFamily, LawParameter, PiecewiseLinearLaw};

law_family! {
    /// Coulomb friction whose level depends on the sign of the acceleration.
    ///
    /// ```text
    /// F = μ₁ N while the speed grows,  μ₂ N while it falls,  any value between while it is constant
    ///                                                                (thesis Eq. 7.3)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ₁ | `gaining` | 1 | coefficient while the speed grows, and at breakaway |
    /// | μ₂ | `losing` | 1 | coefficient while the speed falls |
    ///
    /// Either level may be the greater; μ₁ = μ₂ is [`Coulomb`](crate::Coulomb).
    ///
    /// * μ₁ > μ₂, what the thesis finds: a load between the two levels would speed the contact up under μ₂ and slow it
    ///   down under μ₁, so neither holds. The values between, admitted at constant speed, make the law well posed:
    ///   each swing has a phase of constant speed v that lasts (μ₁ − μ₂) N/(k |v|) on a spring k.
    /// * μ₁ < μ₂: at a load between the two levels both motions are possible. The contact goes on as it did, and
    ///   changes level only when its own acceleration changes sign.
    pub struct AccelerationCoulomb, "acceleration_coulomb", piecewise_linear {
        gaining: LawParameter::level("gaining_coefficient", "μ₁").typically(1.05),
        losing: LawParameter::level("losing_coefficient", "μ₂").typically(0.95),
    }

    /// Coefficient `gaining` μ₁ (1) while the speed grows and `losing` μ₂ (1) while it falls.
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if either is negative or not finite.
    pub fn new {}
    special cases [crate::SpecialCase::of("coulomb")]
    tried [crate::SearchStage::TwoNumbers.trial().damped()]
}

impl<D: Scalar> PiecewiseLinearLaw<D> for AccelerationCoulomb<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.gaining, slope: D::from(0.0), breakaway: self.gaining }
    }

    fn affine_losing_speed(&self) -> Option<Affine<D>> {
        Some(Affine { level: self.losing, ..self.affine() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SlidingLaw;

    #[test]
    fn levels_may_be_in_either_order() {
        for (gaining, losing) in [(0.2, 0.1), (0.1, 0.2)] {
            let law = AccelerationCoulomb::new(gaining, losing).unwrap();
            assert!(law.depends_on_acceleration());
            assert_eq!((law.coefficient(0.3), law.coefficient_losing_speed(0.3)), (gaining, losing));
            assert_eq!(law.breakaway(), gaining);
        }
        assert!(AccelerationCoulomb::new(0.2, -0.1).is_err());
    }
}
