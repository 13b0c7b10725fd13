//! Coulomb friction: one level for sliding and breakaway.

use fmm_model::Scalar;

use crate::family::law_family;
use crate::{Affine, LawError, LawFamily, LawParameter, PiecewiseLinearLaw};

law_family! {
    /// Coulomb friction.
    ///
    /// ```text
    /// F = μ N                                                        (thesis section 7.1)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ | `coefficient` | 1 | friction coefficient, sliding and at breakaway |
    ///
    /// # References
    /// C. A. Coulomb, *Théorie des machines simples*, Paris 1785.
    pub struct Coulomb, "coulomb", piecewise_linear {
        coefficient: LawParameter::level("coefficient", "μ"),
    }

    /// Coulomb friction with coefficient `μ` (1).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if the coefficient is negative or not finite.
    pub fn new {}
    tried [crate::SearchStage::Simple.trial()]
}

impl<D: Scalar> PiecewiseLinearLaw<D> for Coulomb<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.coefficient, slope: D::from(0.0), breakaway: self.coefficient }
    }
}
