//! Errors of a repeated fit.

use fmm_model::ModelError;

use crate::error::FitError;
use crate::solver::outcome::Outcome;

/// Why a [`Refit`](crate::Refit) has no estimates for some inputs.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RefitError {
    /// There is no input of this name.
    #[error("{name:?} was not held in the fit; what was held: {inputs}")]
    NoInput {
        /// The name given.
        name: String,
        /// The names there are.
        inputs: String,
    },
    /// There is not one value for each input.
    #[error("{given} values were given for {inputs} inputs")]
    InputCount {
        /// How many were given.
        given: usize,
        /// How many inputs there are.
        inputs: usize,
    },
    /// An input cannot be expected to change by this.
    #[error("{input} is expected to change by {spread}; a finite number of at least zero is needed")]
    Spread {
        /// Name of the input.
        input: String,
        /// The amount given.
        spread: f64,
    },
    /// An input is not finite.
    #[error("the input {input} has no valid value")]
    Input {
        /// Name of the input.
        input: String,
        /// What is wrong with its value.
        source: ModelError,
    },
    /// The fit cannot begin with these inputs.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The fit begins and does not reach a minimum.
    #[error("the fit ended without a minimum: {outcome}")]
    NotConverged {
        /// How it ended.
        outcome: Outcome,
    },
}
