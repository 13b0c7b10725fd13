//! Friction proportional to the speed: a contact that never sticks.

use fmm_model::Scalar;

use crate::family::exactly;
use crate::{Affine, AffineLaw, LawError, LawFamily, LawParameter};

/// Viscous friction alone, the hypothesis against which dry friction has to prove itself.
///
/// ```text
/// F = N β |v|
/// ```
///
/// | symbol | field | unit | meaning |
/// |---|---|---|---|
/// | β | `viscous` | s/m | coefficient per speed |
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viscous<D = f64> {
    viscous: D,
}

impl<D: Scalar> Viscous<D> {
    /// Viscous friction with a coefficient of `viscous` per speed (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if it is negative or not finite.
    pub fn new(viscous: D) -> Result<Self, LawError> {
        Ok(Self { viscous: Viscous::PARAMETERS[0].check(viscous)? })
    }
}

impl LawFamily for Viscous {
    const NAME: &'static str = "viscous";
    const PARAMETERS: &'static [LawParameter] = &[LawParameter::slope("viscous", "β")];
    type At<D: Scalar> = Viscous<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<Viscous<D>, LawError> {
        let [viscous] = exactly(Self::NAME, values)?;
        Viscous::new(viscous)
    }
}

impl<D: Scalar> AffineLaw<D> for Viscous<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: D::from(0.0), slope: self.viscous, breakaway: D::from(0.0) }
    }
}
