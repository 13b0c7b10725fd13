//! What ends a smooth branch.

/// A quantity that is positive on a smooth branch and zero at its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Guard {
    /// The relative velocity reaches zero.
    Speed,
    /// An element begins to slide.
    Reserve(usize),
    /// The velocity, or a state of the law, passes zero, where damping or law may have a corner. This is no event.
    Corner(usize),
}

/// How far the end of a step is from the zero of a guard.
#[derive(Debug, Clone, Copy)]
pub(super) struct Landing {
    /// In units of the step; positive if the zero is ahead.
    pub(super) correction: f64,
    /// Whether the guard has no slope there.
    pub(super) grazing: bool,
}
