//! Coulomb friction with a static level of its own.

use fmm_model::Scalar;

use crate::family::exactly;
use crate::{Affine, AffineLaw, LawError, LawFamily, LawParameter};

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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoulombStatic<D = f64> {
    sliding: D,
    breakaway: D,
}

impl<D: Scalar> CoulombStatic<D> {
    /// Coefficient `sliding` while in motion and `breakaway` at rest (1).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a coefficient is negative or not finite, [`LawError::StaticBelowSliding`] if
    /// the static one is the smaller.
    pub fn new(sliding: D, breakaway: D) -> Result<Self, LawError> {
        let law = Self {
            sliding: CoulombStatic::PARAMETERS[0].check(sliding)?,
            breakaway: CoulombStatic::PARAMETERS[1].check(breakaway)?,
        };
        if breakaway.value() < sliding.value() {
            return Err(LawError::StaticBelowSliding { breakaway: breakaway.value(), sliding: sliding.value() });
        }
        Ok(law)
    }
}

impl LawFamily for CoulombStatic {
    const NAME: &'static str = "coulomb_static";
    const PARAMETERS: &'static [LawParameter] =
        &[LawParameter::level("sliding_coefficient", "μ_d"), LawParameter::breakaway("static_coefficient", "μ_s")];
    type At<D: Scalar> = CoulombStatic<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<CoulombStatic<D>, LawError> {
        let [sliding, breakaway] = exactly(Self::NAME, values)?;
        CoulombStatic::new(sliding, breakaway)
    }
}

impl<D: Scalar> AffineLaw<D> for CoulombStatic<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.sliding, slope: D::from(0.0), breakaway: self.breakaway }
    }
}
