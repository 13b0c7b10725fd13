//! Laws that are a level plus a slope: the ones with a closed-form motion.

use fmm_model::Scalar;

use crate::SlidingLaw;

/// The numbers of an affine law: coefficient(v) = `level` + `slope` v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine<D = f64> {
    /// Coefficient in the limit of zero speed while sliding (1).
    pub level: D,
    /// Increase of the coefficient with speed (s/m).
    pub slope: D,
    /// Coefficient to exceed to leave rest (1).
    pub breakaway: D,
}

/// A sliding law that is affine in the speed, so that every swing is a damped harmonic about a shifted centre.
///
/// Implementing this trait gives [`SlidingLaw`] as well.
pub trait AffineLaw<D: Scalar> {
    /// Level, slope and static level.
    fn affine(&self) -> Affine<D>;
}

impl<D: Scalar, L: AffineLaw<D>> SlidingLaw<D> for L {
    fn coefficient(&self, speed: D) -> D {
        let Affine { level, slope, .. } = self.affine();
        level + slope * speed
    }

    fn breakaway(&self) -> D {
        self.affine().breakaway
    }
}
