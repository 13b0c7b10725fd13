//! A falling curve while the speed grows and a rising one while it falls.

use fmm_model::Scalar;

use crate::blend::{fallen, risen};
use crate::family::{law_family, static_not_below};
use crate::{LawError, LawFamily, LawParameter, Role, SlidingLaw};

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
    /// μ_k (1 + (μ_s − μ_k)/μ_k exp(−a v)), which is the same for μ_k > 0.
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
    /// [`LawError::StaticBelowSliding`] if μ_s < μ_k.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [crate::SpecialCase::of("coulomb")]
    tried [crate::SearchStage::FurtherOfSpeed.trial().damped()]
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

#[cfg(test)]
mod tests {
    use super::*;

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
