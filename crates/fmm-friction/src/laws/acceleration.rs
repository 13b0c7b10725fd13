//! Laws that differ between growing and falling speed.

use fmm_model::Scalar;

use crate::law::family::law_family;
use crate::law::functions::{fallen, risen};
use crate::law::parameter::static_not_below;
use crate::law::{
    Affine, LawError, LawFamily, LawParameter, PiecewiseLinearLaw, Role, SearchStage, SlidingLaw, SpecialCase,
    slides_as_affine,
};

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
    /// * μ₁ > μ₂, the case of the thesis: a load between the two levels would speed the contact up under μ₂ and slow it
    ///   down under μ₁, so neither holds. The values between, admitted at constant speed, make the law well posed:
    ///   each half cycle has a phase of constant speed v that lasts (μ₁ − μ₂) N/(k |v|) on a spring k.
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
    special cases [SpecialCase::of("coulomb")]
    tried [SearchStage::OfSpeed.trial().damped()]
}

impl<D: Scalar> PiecewiseLinearLaw<D> for AccelerationCoulomb<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.gaining, slope: D::from(0.0), breakaway: self.gaining }
    }

    fn affine_losing_speed(&self) -> Option<Affine<D>> {
        Some(Affine { level: self.losing, ..self.affine() })
    }
}

law_family! {
    /// Friction with an exponential branch for growing and another for falling speed.
    ///
    /// ```text
    /// F = N (μ_k + (μ_s − μ_k) exp(−a v))    while the speed grows
    /// F = N μ_k (1 − exp(−b v))              while it falls
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_k | `sliding` | 1 | coefficient at large speed, on both branches |
    /// | μ_s | `breakaway` | 1 | coefficient at zero speed and at breakaway, ≥ μ_k |
    /// | a | `gaining_decay` | s/m | inverse speed over which the growing branch falls |
    /// | b | `losing_decay` | s/m | inverse speed below which the falling branch vanishes |
    ///
    /// The falling branch never lies above the growing one. Between the two any value is possible at constant speed, as
    /// in [`AccelerationCoulomb`](crate::AccelerationCoulomb). The sources write the growing branch as
    /// μ_k (1 + (μ_s − μ_k)/μ_k exp(−a v)), an equal form for μ_k > 0.
    ///
    /// # References
    /// The form is the one attributed to Den Hartog and Burdekin, after J. Wojewoda, A. Stefański, M. Wiercigroch,
    /// T. Kapitaniak, "Hysteretic effects of dry friction: modelling and experimental studies", Phil. Trans. R. Soc. A
    /// 366 (2008) 747; it is given here as it is cited, not as read in the paper.
    pub struct ExponentialPair, "exponential_pair", sliding {
        sliding: LawParameter::level("sliding_coefficient", "μ_k"),
        breakaway: LawParameter::level_above("static_coefficient", "μ_s").typically(0.3),
        gaining_decay: LawParameter::positive("gaining_decay", "a", "s/m", Role::Shape).typically(5.0),
        losing_decay: LawParameter::positive("losing_decay", "b", "s/m", Role::Shape).typically(20.0),
    }

    /// Coefficients `sliding` μ_k and `breakaway` μ_s (1), inverse speeds `gaining_decay` a and `losing_decay` b (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite,
    /// [`LawError::Contradiction`] if μ_s < μ_k.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [SpecialCase::at("coulomb", &[("losing_decay", f64::INFINITY)])]
    tried [SearchStage::OfSpeed.trial().damped()]
}

impl<D: Scalar> SlidingLaw<D> for ExponentialPair<D> {
    fn coefficient(&self, speed: D) -> D {
        fallen(self.sliding, self.breakaway, self.gaining_decay * speed)
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }

    fn depends_on_acceleration(&self) -> bool {
        true
    }

    fn coefficient_losing_speed(&self, speed: D) -> D {
        self.sliding * risen(self.losing_decay * speed)
    }
}

slides_as_affine!(AccelerationCoulomb);

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn branches_meet_at_large_speed_only() {
        let law = ExponentialPair::new(0.1, 0.3, 20.0, 50.0).unwrap();
        assert_eq!((law.coefficient(0.0), law.coefficient_losing_speed(0.0)), (0.3, 0.0));
        let (gaining, losing) = (law.coefficient(0.05), law.coefficient_losing_speed(0.05));
        assert!((gaining - (0.1 + 0.2 * f64::exp(-1.0))).abs() < 1e-16, "{gaining}");
        assert!((losing - 0.1 * (1.0 - f64::exp(-2.5))).abs() < 1e-16, "{losing}");
        assert_eq!((law.coefficient(10.0), law.coefficient_losing_speed(10.0)), (0.1, 0.1));
        assert!(law.depends_on_acceleration());
        assert!(ExponentialPair::new(0.3, 0.1, 1.0, 1.0).is_err() && ExponentialPair::new(0.1, 0.3, 0.0, 1.0).is_err());
    }
}
