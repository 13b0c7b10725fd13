//! The Stribeck curve with an algebraic fall.

use fmm_model::Scalar;

use crate::blend::between;
use crate::family::{law_family, static_not_below};
use crate::{LawError, LawFamily, LawParameter, Role, SlidingLaw};

law_family! {
    /// Stribeck friction with a Lorentzian fall and a viscous part.
    ///
    /// ```text
    /// F = N (μ_c + (μ_s − μ_c)/(1 + (v/v_s)²) + β v)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_c | `sliding` | 1 | coefficient at large speed, without the viscous part |
    /// | μ_s | `breakaway` | 1 | coefficient at zero speed and at breakaway, ≥ μ_c |
    /// | v_s | `fall_speed` | m/s | Stribeck speed, at which half of the fall has happened |
    /// | β | `viscous` | s/m | increase of the coefficient with speed |
    ///
    /// To second order in the speed it is the Gaussian [`Stribeck`](crate::Stribeck) curve; at large speed it falls
    /// far more slowly.
    ///
    /// # References
    /// D. P. Hess, A. Soom, "Friction at a lubricated line contact operating at oscillating sliding velocities",
    /// Journal of Tribology 112 (1990) 147.
    pub struct StribeckLorentzian, "stribeck_lorentzian", sliding {
        sliding: LawParameter::level("sliding_coefficient", "μ_c").typically(0.9),
        breakaway: LawParameter::level_above("static_coefficient", "μ_s").typically(0.4),
        fall_speed: LawParameter::positive("stribeck_speed", "v_s", "m/s", Role::Shape).typically(0.2),
        viscous: LawParameter::slope("viscous", "β"),
    }

    /// Coefficients `sliding` μ_c and `breakaway` μ_s (1), `fall_speed` v_s (m/s) and `viscous` β (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite,
    /// [`LawError::StaticBelowSliding`] if μ_s < μ_c.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [crate::SpecialCase::of("coulomb")]
    tried [crate::SearchStage::Stribeck.trial()]
}

impl<D: Scalar> SlidingLaw<D> for StribeckLorentzian<D> {
    fn coefficient(&self, speed: D) -> D {
        let ratio = speed / self.fall_speed;
        let viscous = self.viscous * speed;
        // The square of a larger ratio or its derivatives may overflow, and its inverse is below any coefficient.
        if ratio.value() > 1e100 {
            return self.sliding + viscous;
        }
        let share = D::from(1.0) / (ratio * ratio + 1.0);
        between(self.sliding, self.breakaway, share, || ratio * ratio * share) + viscous
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }
}
