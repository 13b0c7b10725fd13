//! Guards: ends of a smooth part of a stretch of sliding.

use crate::automaton::{Branch, Phase};

/// A side of the capture speed, at which the law may jump: whether the speed has exceeded it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Below,
    /// The contact is caught once the speed is down at it again.
    Above,
}

/// A quantity that is positive before what it stands for, and zero there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Guard {
    /// The contact is caught, at relative rest unless the law says otherwise.
    Rest,
    /// The acceleration reaches zero.
    Steady,
    /// The speed exceeds that at which the contact would be caught. This is no event, but the law may jump.
    Escape,
}

impl Guard {
    /// The guards of a phase on one side of the capture speed, if the law `captures`.
    pub(super) fn of<D>(phase: &Phase<D>, side: Side, captures: bool) -> impl Iterator<Item = Self> + use<D> {
        let (branch, escapes) = (phase.branch, captures && side == Side::Below);
        [Self::Rest, Self::Steady, Self::Escape].into_iter().filter(move |guard| match guard {
            Self::Rest => branch != Branch::Gaining,
            Self::Steady => branch != Branch::Only,
            Self::Escape => escapes,
        })
    }

    /// With which sign velocity, or acceleration, makes the guard.
    pub(super) fn sign<D>(self, phase: &Phase<D>) -> f64 {
        let along = phase.direction.sign();
        match self {
            Self::Steady if phase.branch == Branch::Losing => -along,
            Self::Rest | Self::Steady => along,
            Self::Escape => -along,
        }
    }
}
