//! Friction proportional to the speed: a contact that never sticks.

use fmm_model::Scalar;

use crate::family::law_family;
use crate::{Affine, LawError, LawFamily, LawParameter, PiecewiseLinearLaw};

law_family! {
    /// Viscous friction alone, the hypothesis against which dry friction has to prove itself.
    ///
    /// ```text
    /// F = N β |v|
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | β | `viscous` | s/m | coefficient per speed |
    pub struct Viscous, "viscous", piecewise_linear {
        viscous: LawParameter::slope("viscous", "β"),
    }

    /// Viscous friction with a coefficient of `viscous` per speed (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if it is negative or not finite.
    pub fn new {}
    tried [crate::SearchStage::Simple.trial()]
}

impl<D: Scalar> PiecewiseLinearLaw<D> for Viscous<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: D::from(0.0), slope: self.viscous, breakaway: D::from(0.0) }
    }
}
