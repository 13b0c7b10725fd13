//! Coulomb friction plus a part proportional to the speed.

use fmm_model::Scalar;

use crate::family::exactly;
use crate::{Affine, AffineLaw, LawError, LawFamily, LawParameter};

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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoulombViscous<D = f64> {
    coefficient: D,
    viscous: D,
}

impl<D: Scalar> CoulombViscous<D> {
    /// Coefficient `μ` (1) at zero speed, rising by `viscous` (s/m) with the speed.
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if either is negative or not finite.
    pub fn new(coefficient: D, viscous: D) -> Result<Self, LawError> {
        Ok(Self {
            coefficient: CoulombViscous::PARAMETERS[0].check(coefficient)?,
            viscous: CoulombViscous::PARAMETERS[1].check(viscous)?,
        })
    }
}

impl LawFamily for CoulombViscous {
    const NAME: &'static str = "coulomb_viscous";
    const PARAMETERS: &'static [LawParameter] =
        &[LawParameter::level("coefficient", "μ"), LawParameter::slope("viscous", "β")];
    type At<D: Scalar> = CoulombViscous<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<CoulombViscous<D>, LawError> {
        let [coefficient, viscous] = exactly(Self::NAME, values)?;
        CoulombViscous::new(coefficient, viscous)
    }
}

impl<D: Scalar> AffineLaw<D> for CoulombViscous<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.coefficient, slope: self.viscous, breakaway: self.coefficient }
    }
}
