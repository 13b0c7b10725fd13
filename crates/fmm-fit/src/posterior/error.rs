//! Errors of a request for a posterior.

use fmm_model::{Parameter, Rounded};

use crate::error::FitError;

/// Why there is no posterior.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PosteriorError {
    /// A prior that is no density: give finite numbers, and positive widths.
    #[error("{what}")]
    Prior {
        /// What it is, and what it must be.
        what: String,
    },
    /// A prior for a parameter that the problem does not have, or does not leave free.
    #[error("there is no free parameter called {name}; those of the problem are: {known}")]
    UnknownParameter {
        /// The name given.
        name: String,
        /// The names of the free parameters.
        known: String,
    },
    /// A count of chains, steps or draws that is too small.
    #[error("at least {least} {what} are needed, but {given} are asked for")]
    TooFew {
        /// What is counted.
        what: &'static str,
        /// How many it takes.
        least: usize,
        /// How many there would be.
        given: usize,
    },
    /// The fit is one of another problem.
    #[error(
        "the fit has {fit:?} residuals and parameters, but the problem {problem:?}; it must be that of the problem"
    )]
    DifferentProblem {
        /// Residuals and parameters of the fit.
        fit: (usize, usize),
        /// Residuals and parameters of the problem.
        problem: (usize, usize),
    },
    /// Residuals and priors leave a direction of the parameters open, so that the posterior has no integral.
    #[error(
        "residuals and priors together do not determine {parameters}; hold one of them or give it a prior that has a width"
    )]
    Undetermined {
        /// The parameters concerned.
        parameters: String,
    },
    /// There is no residual left to tell the noise from.
    #[error("the residuals of the fit are zero, so that there is no noise whose posterior could be found")]
    NoNoise,
    /// The model has no finite value about the fit.
    #[error("no point about the fit has finite residuals and derivatives; the model said last: {said}")]
    NoStart {
        /// What the model said.
        said: String,
    },
    /// The problem does not fit itself, such as blocks that have not all residuals.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The sampler stopped.
    #[error("the sampler stopped: {0}")]
    Sampler(String),
}

impl PosteriorError {
    /// A prior rules out all that the bounds of its parameter allow.
    pub(super) fn outside_bounds(parameter: &Parameter) -> Self {
        let [lower, upper] = [parameter.bounds().lower(), parameter.bounds().upper()].map(Rounded::every_digit);
        Self::Prior {
            what: format!("the prior of {} has no value within its bounds, [{lower}, {upper}]", parameter.name()),
        }
    }
}
