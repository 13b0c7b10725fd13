//! Errors of a design of measurements and of the search for one.

use crate::error::FitError;

/// Why a design cannot be judged or searched for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    /// Matrices, vectors or lists that must belong together do not.
    #[error("{what}")]
    Mismatch {
        /// What does not belong together, with both sizes.
        what: String,
    },
    /// A number that cannot be: give another.
    #[error("{what}")]
    OutOfRange {
        /// What it was given for, its value, and what it may be.
        what: String,
    },
    /// The problem has no derivatives at these values of its parameters.
    #[error("the problem has no derivatives at the values given")]
    NoDerivatives,
    /// The problem contradicts itself.
    #[error(transparent)]
    Problem(#[from] FitError),
}

impl DesignError {
    pub(crate) fn mismatch(subject: &str, found: usize, expected: usize) -> Self {
        Self::Mismatch { what: format!("{subject}: {found} given, {expected} needed") }
    }

    pub(crate) fn out_of_range(what: impl Into<String>) -> Self {
        Self::OutOfRange { what: what.into() }
    }
}
