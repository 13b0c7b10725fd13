//! Laws that are a level plus a slope: the ones with a closed-form motion.

use fmm_model::Scalar;

use crate::{Coulomb, CoulombStatic, CoulombViscous, SlidingLaw, Viscous};

/// The numbers of an affine law, and the law itself: coefficient(v) = `level` + `slope` v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine<D = f64> {
    /// Coefficient in the limit of zero speed while sliding (1).
    pub level: D,
    /// Increase of the coefficient with speed (s/m).
    pub slope: D,
    /// Coefficient to exceed to leave rest (1).
    pub breakaway: D,
}

impl<D: Scalar> SlidingLaw<D> for Affine<D> {
    fn coefficient(&self, speed: D) -> D {
        self.level + self.slope * speed
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }
}

/// A sliding law that is affine in the speed, so that every swing is a damped harmonic about a shifted centre.
///
/// An implementor promises that it slides as [`affine`](Self::affine) says:
///
/// ```text
/// self.coefficient(v) = self.affine().coefficient(v),     self.breakaway() = self.affine().breakaway
/// ```
///
/// The trait does not give [`SlidingLaw`] to its implementors by itself: that would forbid everyone else to
/// implement it for a law that is not affine.
pub trait AffineLaw<D: Scalar>: SlidingLaw<D> {
    /// Level, slope and static level.
    fn affine(&self) -> Affine<D>;
}

macro_rules! slides_as_affine {
    ($($law:ident),+) => {$(
        impl<D: Scalar> SlidingLaw<D> for $law<D> {
            fn coefficient(&self, speed: D) -> D {
                self.affine().coefficient(speed)
            }

            fn breakaway(&self) -> D {
                self.affine().breakaway
            }
        }
    )+};
}

slides_as_affine!(Viscous, Coulomb, CoulombStatic, CoulombViscous);
