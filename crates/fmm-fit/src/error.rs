//! The error of the crate.

use std::error::Error;

use fmm_model::Rounded;

/// A request that cannot be met: the variant says what to do about it, the sentence says which value is wrong and what
/// would be right.
///
/// A fit that runs has no errors but an [`Outcome`](crate::Outcome): the best point found is worth having, however the
/// search ended.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Lists that belong together have different lengths: give one element for each.
    #[error("{what}")]
    Count {
        /// The lists and their lengths.
        what: String,
    },
    /// A number is impossible: give another.
    #[error("{what}")]
    OutOfRange {
        /// The meaning of the number, its value and the values allowed.
        what: String,
        /// The value.
        value: f64,
    },
    /// Parts of a problem contradict each other, or the request does: mend it.
    #[error("{what}")]
    Problem {
        /// The parts and the contradiction.
        what: String,
    },
    /// A name stands for nothing: give one of those that there are.
    #[error("{what}")]
    UnknownName {
        /// The name.
        what: String,
    },
    /// The model fails, or has no finite residuals or derivatives, where a fit begins: begin elsewhere.
    #[error("{what}")]
    NoModel {
        /// The failure.
        what: String,
        /// The error of the model itself.
        source: Option<Box<dyn Error + Send + Sync>>,
    },
    /// Data and priors do not determine the result: give more of them, or fix a parameter.
    #[error("{what}")]
    Undetermined {
        /// The result, and the data that it would take.
        what: String,
    },
    /// A fit is not at a minimum, and only a minimum has the result: fit again, from elsewhere or with other limits.
    #[error("{what}")]
    NoMinimum {
        /// The end of the fit.
        what: String,
    },
    /// The sum of squares is lower elsewhere than at the fit given: fit again from there.
    #[error("{what}")]
    LowerMinimum {
        /// Both sums of squares.
        what: String,
        /// Values of the parameters with the lower one.
        values: Vec<f64>,
        /// The lower one.
        lower: f64,
    },
    /// The fit is one of another problem: give problem and fit that belong together.
    #[error("{what}")]
    OtherFit {
        /// Sizes of both.
        what: String,
    },
    /// A result was asked for before the solver had run.
    #[error("the solver has not run yet, so there is no fit to report")]
    NotStarted,
    /// The sampler of a posterior stopped.
    #[error("the sampler stopped: {0}")]
    Sampler(String),
}

impl FitError {
    pub(crate) fn count(what: impl Into<String>) -> Self {
        Self::Count { what: what.into() }
    }

    pub(crate) fn out_of_range(what: impl Into<String>, value: f64) -> Self {
        Self::OutOfRange { what: what.into(), value }
    }

    /// An option or setting called `name`, that must be as `expected`.
    pub(crate) fn option(name: &str, expected: &str, value: f64) -> Self {
        Self::out_of_range(format!("{name} must be {expected}, but is {}", Rounded::every_digit(value)), value)
    }

    pub(crate) fn problem(what: impl Into<String>) -> Self {
        Self::Problem { what: what.into() }
    }

    pub(crate) fn unknown_name(what: impl Into<String>) -> Self {
        Self::UnknownName { what: what.into() }
    }

    pub(crate) fn no_model(what: impl Into<String>) -> Self {
        Self::NoModel { what: what.into(), source: None }
    }

    /// A model that failed at the start.
    pub(crate) fn model_failed(source: Box<dyn Error + Send + Sync>) -> Self {
        Self::NoModel { what: format!("the model failed at the start: {source}"), source: Some(source) }
    }

    pub(crate) fn undetermined(what: impl Into<String>) -> Self {
        Self::Undetermined { what: what.into() }
    }

    pub(crate) fn no_minimum(what: impl Into<String>) -> Self {
        Self::NoMinimum { what: what.into() }
    }
}
