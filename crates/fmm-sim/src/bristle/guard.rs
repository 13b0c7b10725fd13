//! Guards: ends of a smooth branch.

use crate::spring::Range;

/// A quantity that is positive on a smooth branch and zero at its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Guard {
    /// The relative velocity reaches zero.
    Speed,
    /// An element begins to slide.
    Reserve(usize),
    /// The velocity, or a state of the law, passes zero, where damping or law may have a corner. This is no event.
    Corner(usize),
    /// The position passes the corner of the spring behind which it is in this range. This is no event.
    SpringCorner(Range),
}

/// A guard whose zero steps are being shortened or stretched to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Approach {
    pub(super) guard: Guard,
    /// How far from the zero, in units of the step, the nearest of them has ended.
    pub(super) nearest: f64,
}

impl Approach {
    /// The approach to `guard`, gone on with if it is the one under way.
    pub(super) fn of(guard: Guard, under_way: Option<Self>) -> Self {
        under_way.filter(|approach| approach.guard == guard).unwrap_or(Self { guard, nearest: f64::INFINITY })
    }
}

/// How the end of a step lies to the zero of a guard; corrections are in units of the step, positive if the zero is
/// ahead.
#[derive(Debug, Clone, Copy)]
pub(super) enum Landing {
    /// The tangent covers what is left.
    There {
        correction: f64,
        /// Whether the guard has no slope there.
        grazing: bool,
    },
    /// A step changed by the correction ends at the zero, or nearer to it.
    Near { correction: f64 },
    /// The zero, if there is one, is elsewhere.
    Far,
}
