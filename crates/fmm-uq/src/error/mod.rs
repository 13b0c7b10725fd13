//! Errors of inputs, of models and of questions to a budget.

mod inputs;
mod models;
mod results;

use std::error::Error;

/// Reason why an uncertainty could not be stated; each variant asks something else of the caller.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UncertaintyError {
    /// A number that cannot be: give another.
    #[error("{what}")]
    OutOfRange {
        /// Subject of the value, the value, and the allowed range.
        what: String,
        /// The value given.
        value: f64,
    },
    /// Inputs, or correlations between them, that contradict each other: correct their list.
    #[error("{what}")]
    Inputs {
        /// The inputs, and their fault.
        what: String,
    },
    /// Too few observations to say anything about their spread.
    #[error("at least {needed} observations are needed, but {found} were given")]
    TooFewObservations {
        /// Number of observations given.
        found: usize,
        /// Number of observations needed.
        needed: usize,
    },
    /// A model that fails, or gives results from which nothing follows: mend it, or keep to inputs where it holds.
    #[error("{what}")]
    Model {
        /// The result, and where it appeared.
        what: String,
        /// Error of the model itself.
        source: Option<Box<dyn Error + Send + Sync>>,
    },
    /// A question that has no answer by this method: ask another, or take another method.
    #[error("{what}")]
    NoAnswer {
        /// Reason, and what would have an answer.
        what: String,
    },
    /// Fewer trials than the answer takes: make or allow more.
    #[error("{what}")]
    TooFewTrials {
        /// The result that needs more trials.
        what: String,
        /// Number of trials made or allowed.
        found: u64,
        /// Number of trials needed.
        needed: u64,
    },
    /// The tolerance was not reached within the largest number of trials allowed.
    #[error("the results are not stable to the tolerance after {trials} trials; allow more, or ask for fewer digits")]
    NotStable {
        /// Number of trials made.
        trials: u64,
    },
    /// More trials failed than were allowed to.
    #[error("{failed} of {trials} trials failed, more than the allowed share of {allowed}; the first: {first}")]
    TooManyFailures {
        /// Number of failed trials.
        failed: u64,
        /// Number of trials made before the run was given up or ended.
        trials: u64,
        /// The share allowed (1).
        allowed: f64,
        /// The first failure, by block and trial.
        first: Box<crate::Failure>,
    },
    /// The progress callback asked for an end.
    #[error("the run was cancelled after {trials} trials")]
    Cancelled {
        /// Number of trials done.
        trials: u64,
    },
    /// Partial runs that do not make a whole: merge those of one run, each once.
    #[error("{what}")]
    PartialRun {
        /// Fault of the parts.
        what: String,
        /// The block of trials that is missing, damaged or there twice.
        block: Option<u64>,
    },
}
