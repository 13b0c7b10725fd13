//! Laws that are a level plus a slope: the ones with a closed-form motion.

use fmm_model::Scalar;

use crate::{AccelerationCoulomb, Coulomb, CoulombStatic, CoulombViscous, SlidingLaw, Viscous};

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

/// An elastic element that yields: a spring of `stiffness` which slides at `level`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element<D = f64> {
    /// Increase of the coefficient with the displacement while the element holds (1/m).
    pub stiffness: D,
    /// Coefficient at which it slides (1).
    pub level: D,
}

/// A law under which a linear oscillator moves in closed form between events.
///
/// ```text
/// F/N = level + slope |v|  +  Σ clamp(κᵢ zᵢ, ±levelᵢ),    κᵢ = stiffnessᵢ
/// ```
///
/// A law of the sliding speed alone has no elements; an implementor that is a [`SlidingLaw`] too promises that it
/// slides as [`affine`](Self::affine) and [`affine_losing_speed`](Self::affine_losing_speed) say. The trait does not
/// give [`SlidingLaw`] to its implementors by itself: that would forbid everyone else to implement it for a law that is
/// not affine.
pub trait PiecewiseLinearLaw<D: Scalar> {
    /// Level, slope and static level while the speed grows.
    fn affine(&self) -> Affine<D>;

    /// The same while the speed falls, if it differs.
    fn affine_losing_speed(&self) -> Option<Affine<D>> {
        None
    }

    /// Elements that deflect before they slide; at the start of a motion none is deflected.
    fn elements(&self) -> &[Element<D>] {
        &[]
    }
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

            fn depends_on_acceleration(&self) -> bool {
                self.affine_losing_speed().is_some()
            }

            fn coefficient_losing_speed(&self, speed: D) -> D {
                self.affine_losing_speed().unwrap_or_else(|| self.affine()).coefficient(speed)
            }
        }
    )+};
}

slides_as_affine!(Viscous, Coulomb, CoulombStatic, CoulombViscous, AccelerationCoulomb);
