//! Coulomb friction with a dead zone in the speed.

use fmm_model::Scalar;

use crate::family::{law_family, static_not_below};
use crate::{LawError, LawFamily, LawParameter, Role, SlidingLaw};

law_family! {
    /// Karnopp's friction: Coulomb friction with a band of speeds that counts as rest.
    ///
    /// ```text
    /// F = μ_d N            for v > v_d
    /// F = load             for v ≤ v_d and |load| ≤ μ_s N
    /// F = μ_s N            for v ≤ v_d otherwise
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_d | `sliding` | 1 | coefficient while sliding faster than v_d |
    /// | μ_s | `breakaway` | 1 | the most that the contact holds within the dead zone, ≥ μ_d |
    /// | v_d | `dead_zone` | m/s | speed at and below which the contact can be at rest |
    ///
    /// The dead zone spares a simulator the search for v = 0, at the price of an error that grows with it. It is here
    /// for comparison with such simulators: for v_d → 0 the law becomes [`CoulombStatic`](crate::CoulombStatic), which
    /// needs no dead zone.
    ///
    /// # References
    /// D. Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic systems", Journal of Dynamic
    /// Systems, Measurement, and Control 107 (1985) 100, doi 10.1115/1.3140698.
    pub struct Karnopp, "karnopp", sliding {
        sliding: LawParameter::level("sliding_coefficient", "μ_d"),
        breakaway: LawParameter::level_above("static_coefficient", "μ_s").typically(0.1),
        dead_zone: LawParameter::positive("dead_zone", "v_d", "m/s", Role::Shape).typically(0.01),
    }

    /// Coefficient `sliding` μ_d outside and `breakaway` μ_s (1) inside the `dead_zone` v_d (m/s).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a coefficient is negative, the dead zone not positive, or either not finite,
    /// [`LawError::StaticBelowSliding`] if μ_s < μ_d.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [crate::SpecialCase::of("coulomb")]
    tried [crate::SearchStage::FurtherOfSpeed.trial().damped()]
}

impl<D: Scalar> SlidingLaw<D> for Karnopp<D> {
    fn coefficient(&self, speed: D) -> D {
        if speed.value() <= self.dead_zone.value() { self.breakaway } else { self.sliding }
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }

    fn capture_speed(&self) -> D {
        self.dead_zone
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_within_its_dead_zone() {
        let law = Karnopp::new(0.1, 0.2, 1e-3).unwrap();
        assert_eq!([0.0, 1e-3, 1.001e-3].map(|speed| law.coefficient(speed)), [0.2, 0.2, 0.1]);
        assert_eq!((law.breakaway(), law.capture_speed()), (0.2, 1e-3));
        assert!(Karnopp::new(0.2, 0.1, 1e-3).is_err() && Karnopp::new(0.1, 0.2, 0.0).is_err());
    }
}
