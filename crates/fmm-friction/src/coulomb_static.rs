//! Coulomb friction with a static level of its own.

use fmm_model::Scalar;

use crate::family::{law_family, static_not_below};
use crate::{Affine, LawError, LawFamily, LawParameter, PiecewiseLinearLaw};

law_family! {
    /// Coulomb friction whose static level differs from its sliding level.
    ///
    /// ```text
    /// F = μ_d N while sliding;  at rest the contact holds while |load| ≤ μ_s N          (thesis Eq. 5.2)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_d | `sliding` | 1 | coefficient while sliding |
    /// | μ_s | `breakaway` | 1 | coefficient to exceed to leave rest, ≥ μ_d |
    ///
    /// With μ_s = μ_d this is [`Coulomb`](crate::Coulomb). In a free decay μ_s decides only *at which* turning point
    /// the motion ends; between those decisions the motion does not depend on it at all.
    pub struct CoulombStatic, "coulomb_static", piecewise_linear {
        sliding: LawParameter::level("sliding_coefficient", "μ_d"),
        breakaway: LawParameter::breakaway("static_coefficient", "μ_s"),
    }

    /// Coefficient `sliding` while in motion and `breakaway` at rest (1).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a coefficient is negative or not finite, [`LawError::StaticBelowSliding`] if
    /// the static one is the smaller.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [crate::SpecialCase::of("coulomb")]
    not tried "a ring-down depends on the static level only in the turning point at which it ends"
}

impl<D: Scalar> PiecewiseLinearLaw<D> for CoulombStatic<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.sliding, slope: D::from(0.0), breakaway: self.breakaway }
    }
}
