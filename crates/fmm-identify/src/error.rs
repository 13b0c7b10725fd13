//! Why an identification could not be done.

use fmm_fit::FitError;
use fmm_record::{Quantity, RecordError};

/// Why a record could not be prepared or identified.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// No record was given.
    #[error("there is no record to identify; give at least one ring-down")]
    NoRecord,
    /// The record is not a displacement or a velocity.
    #[error("a ring-down must be a displacement or a velocity, but the record is: {quantity}")]
    Quantity {
        /// What the record is.
        quantity: Quantity,
    },
    /// No law was given to compare.
    #[error("there is no law to compare; give at least one candidate")]
    NoCandidate,
    /// Records of different quantities or units cannot be fitted together.
    #[error("records fitted together must agree in quantity and unit: one is {first}, another {other}")]
    MixedRecords {
        /// Quantity and unit of the first.
        first: String,
        /// Quantity and unit of one that differs.
        other: String,
    },
    /// Nothing moves.
    #[error("the record is constant at {value} {unit}: nothing moves")]
    NoMotion {
        /// The constant value.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// Too few samples to hold an oscillation.
    #[error("the record has {samples} samples; at least {needed} are needed")]
    TooShort {
        /// How many there are.
        samples: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The offset was to be taken from a rest that the record does not have.
    #[error("the record does not begin at rest, so there is no rest to take the offset from; fit the offset instead")]
    NoRest,
    /// Too few half swings.
    #[error(
        "the record shows {found} half swings above its noise; at least {needed} are needed to see a period and a \
         decay, and four samples in each to see a half swing"
    )]
    TooFewHalfSwings {
        /// How many were found.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A law of this name is not in the catalogue.
    #[error("there is no law called {name:?}; the laws are: {known}")]
    UnknownLaw {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A number given for the preparation cannot be.
    #[error(transparent)]
    InvalidInput(#[from] fmm_model::ModelError),
    /// The record itself does not allow what was asked for.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The fit could not begin.
    #[error("the fit of {law} could not begin: {source}")]
    Fit {
        /// Name of the law.
        law: &'static str,
        /// What was wrong.
        source: FitError,
    },
    /// The fitted motion could not be simulated.
    #[error("the motion fitted by {law} could not be simulated: {message}")]
    Simulation {
        /// Name of the law.
        law: &'static str,
        /// What was wrong.
        message: String,
    },
}
