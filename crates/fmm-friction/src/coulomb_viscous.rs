//! Coulomb friction plus a part proportional to the speed.

use fmm_model::Scalar;

use crate::family::law_family;
use crate::{Affine, LawError, LawFamily, LawParameter, PiecewiseLinearLaw};

law_family! {
    /// Coulomb friction plus viscous friction.
    ///
    /// ```text
    /// F = N (μ + β |v|)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ | `coefficient` | 1 | coefficient in the limit of zero speed, sliding and at breakaway |
    /// | β | `viscous` | s/m | increase of the coefficient with speed |
    ///
    /// The viscous part acts exactly as a linear damping N β of the machine: a ring-down determines their sum only.
    pub struct CoulombViscous, "coulomb_viscous", piecewise_linear {
        coefficient: LawParameter::level("coefficient", "μ"),
        viscous: LawParameter::slope("viscous", "β"),
    }

    /// Coefficient `μ` (1) at zero speed, rising by `viscous` (s/m) with the speed.
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if either is negative or not finite.
    pub fn new {}
    special cases [crate::SpecialCase::of("coulomb")]
    tried [crate::SearchStage::Simple.trial()]
}

impl<D: Scalar> PiecewiseLinearLaw<D> for CoulombViscous<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.coefficient, slope: self.viscous, breakaway: self.coefficient }
    }
}
