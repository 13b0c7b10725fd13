//! Coulomb friction: one level for sliding and breakaway.

use fmm_model::Scalar;

use crate::family::exactly;
use crate::{Affine, AffineLaw, LawError, LawFamily, LawParameter};

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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb<D = f64> {
    coefficient: D,
}

impl<D: Scalar> Coulomb<D> {
    /// Coulomb friction with coefficient `μ` (1).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if the coefficient is negative or not finite.
    pub fn new(coefficient: D) -> Result<Self, LawError> {
        Ok(Self { coefficient: Coulomb::PARAMETERS[0].check(coefficient)? })
    }
}

impl LawFamily for Coulomb {
    const NAME: &'static str = "coulomb";
    const PARAMETERS: &'static [LawParameter] = &[LawParameter::level("coefficient", "μ")];
    type At<D: Scalar> = Coulomb<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<Coulomb<D>, LawError> {
        let [coefficient] = exactly(Self::NAME, values)?;
        Coulomb::new(coefficient)
    }
}

impl<D: Scalar> AffineLaw<D> for Coulomb<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.coefficient, slope: D::from(0.0), breakaway: self.coefficient }
    }
}
