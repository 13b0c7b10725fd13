//! Laws that are a level plus a slope: the ones with a closed-form motion.

use fmm_model::Scalar;

use crate::law::family::law_family;
use crate::law::parameter::static_not_below;
use crate::law::{
    Affine, LawError, LawFamily, LawParameter, PiecewiseLinearLaw, SearchStage, SpecialCase, slides_as_affine,
};

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
    tried [SearchStage::Simple.trial()]
}

impl<D: Scalar> PiecewiseLinearLaw<D> for Viscous<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: D::from(0.0), slope: self.viscous, breakaway: D::from(0.0) }
    }
}

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
    tried [SearchStage::Simple.trial()]
}

impl<D: Scalar> PiecewiseLinearLaw<D> for Coulomb<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.coefficient, slope: D::from(0.0), breakaway: self.coefficient }
    }
}

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
    /// [`LawError::OutOfBounds`] if a coefficient is negative or not finite, [`LawError::Contradiction`] if
    /// the static one is the smaller.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [SpecialCase::of("coulomb")]
    not tried "a ring-down depends on the static level only in the turning point at which it ends"
}

impl<D: Scalar> PiecewiseLinearLaw<D> for CoulombStatic<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.sliding, slope: D::from(0.0), breakaway: self.breakaway }
    }
}

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
    special cases [SpecialCase::of("coulomb")]
    tried [SearchStage::Simple.trial()]
}

impl<D: Scalar> PiecewiseLinearLaw<D> for CoulombViscous<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: self.coefficient, slope: self.viscous, breakaway: self.coefficient }
    }
}

slides_as_affine!(Viscous, Coulomb, CoulombStatic, CoulombViscous);
