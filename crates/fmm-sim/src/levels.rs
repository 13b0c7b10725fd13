//! Friction levels of a law, as the automaton asks for them.

use fmm_friction::{Affine, SlidingLaw};
use fmm_model::Scalar;

/// Friction levels of a law as the automaton asks for them.
pub(crate) trait Levels<D> {
    /// Coefficient while the speed grows, and the only one unless there are two branches.
    fn gaining(&self, speed: D) -> D;
    /// Coefficient while the speed falls.
    fn losing(&self, speed: D) -> D;
    fn breakaway(&self) -> D;
    fn has_branches(&self) -> bool;
}

/// A [`SlidingLaw`] as levels.
pub(crate) struct Sliding<'a, L: ?Sized>(pub(crate) &'a L);

impl<D: Scalar, L: SlidingLaw<D> + ?Sized> Levels<D> for Sliding<'_, L> {
    fn gaining(&self, speed: D) -> D {
        self.0.coefficient(speed)
    }
    fn losing(&self, speed: D) -> D {
        self.0.coefficient_losing_speed(speed)
    }
    fn breakaway(&self) -> D {
        self.0.breakaway()
    }
    fn has_branches(&self) -> bool {
        self.0.depends_on_acceleration()
    }
}

/// The two branches of a piecewise linear law as levels.
#[derive(Clone, Copy)]
pub(crate) struct Branches<D> {
    pub(crate) gaining: Affine<D>,
    pub(crate) losing: Affine<D>,
    pub(crate) differ: bool,
}

impl<D: Scalar> Levels<D> for Branches<D> {
    fn gaining(&self, speed: D) -> D {
        self.gaining.coefficient(speed)
    }
    fn losing(&self, speed: D) -> D {
        self.losing.coefficient(speed)
    }
    fn breakaway(&self) -> D {
        self.gaining.breakaway
    }
    fn has_branches(&self) -> bool {
        self.differ
    }
}
