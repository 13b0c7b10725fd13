//! Error: a category to act on, and a sentence.

use std::error::Error;

use fmm_model::Rounded;

use crate::failure::Failure;

/// Reason why an uncertainty could not be stated; each variant asks another step of the caller.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UncertaintyError {
    /// A number, a list of inputs or a set of observations that cannot be: correct it.
    #[error("{what}")]
    Invalid {
        /// Subject, the value given, and the values allowed.
        what: String,
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
        /// Reason, and a question that has an answer.
        what: String,
    },
    /// Too few trials for the answer: make or allow more.
    #[error("{what}")]
    TooFewTrials {
        /// The result that needs more trials.
        what: String,
        /// Number of trials made or allowed.
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
        first: Box<Failure>,
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

impl UncertaintyError {
    pub(crate) fn invalid(what: impl Into<String>) -> Self {
        Self::Invalid { what: what.into() }
    }

    pub(crate) fn no_answer(what: impl Into<String>) -> Self {
        Self::NoAnswer { what: what.into() }
    }

    pub(crate) fn model(what: impl Into<String>) -> Self {
        Self::Model { what: what.into(), source: None }
    }

    pub(crate) fn part(what: impl Into<String>, block: impl Into<Option<u64>>) -> Self {
        Self::PartialRun { what: what.into(), block: block.into() }
    }

    /// A parameter of a distribution, or an option of a run, outside its range.
    pub(crate) fn out_of_range(parameter: &str, value: f64, must_be: &str) -> Self {
        Self::invalid(format!("the {parameter} must be {must_be}, but is {}", Rounded::every_digit(value)))
    }

    /// A standard uncertainty that is negative or not finite.
    pub(crate) fn uncertainty_out_of_range(of: &str, value: f64, unit: &str) -> Self {
        let value = Rounded::every_digit(value);
        let must_be = "must be zero or positive and finite";
        Self::invalid(format!("the standard uncertainty of {of} {must_be}, but is {value} {unit}"))
    }

    /// Passes degrees of freedom through if they are at least 1.
    pub(crate) fn require_degrees_of_freedom(of: &str, value: f64) -> Result<f64, Self> {
        if value >= 1.0 {
            return Ok(value);
        }
        let value = Rounded::every_digit(value);
        let must_be = "must be at least 1 and may be infinite";
        Err(Self::invalid(format!("the degrees of freedom of {of} {must_be}, but are {value}")))
    }

    /// Passes a coverage probability through if it lies strictly between 0 and 1.
    pub(crate) fn require_level(level: f64) -> Result<f64, Self> {
        if level > 0.0 && level < 1.0 { Ok(level) } else { Err(Self::level(level)) }
    }

    /// A coverage probability without an interval.
    pub(crate) fn level(level: f64) -> Self {
        let level = Rounded::every_digit(level);
        Self::invalid(format!("the coverage probability must lie between 0 and 1, such as 0.95, but is {level}"))
    }

    /// An observation that is infinite or no number, or whose square is.
    pub(crate) fn observation_not_finite(index: usize, value: f64) -> Self {
        let value = Rounded::every_digit(value);
        Self::invalid(format!("observation {index} must be finite, and its square too, but is {value}"))
    }

    pub(crate) fn too_few_observations(found: usize, needed: usize) -> Self {
        Self::invalid(format!("at least {needed} observations are needed, but {found} were given"))
    }

    pub(crate) fn duplicate_name(name: &str) -> Self {
        Self::invalid(format!("each input needs a name of its own, but `{name}` is given twice"))
    }

    pub(crate) fn too_many_trials(trials: u64, most: u64) -> Self {
        Self::invalid(format!("{trials} trials are more than can be counted; at most {most} are possible"))
    }

    pub(crate) fn no_such_output(output: usize, outputs: usize) -> Self {
        Self::invalid(format!("there is no output {output}; the model has {outputs}, counted from 0"))
    }

    pub(crate) fn output_count_changed(first: usize, again: usize) -> Self {
        Self::model(format!("the model gives {first} outputs, then {again}; their number must not change"))
    }

    pub(crate) fn no_success() -> Self {
        Self::model("none of the trials succeeded")
    }

    /// A spread so small that it would count as none.
    pub(crate) fn too_small(of: &str) -> Self {
        Self::no_answer(format!("the spread of {of} is so small that its square loses its digits; take a smaller unit"))
    }

    /// An interval that would reach beyond the smallest or largest of the trials.
    pub(crate) fn too_few_trials(trials: usize, level: f64, needed: usize) -> Self {
        let what = format!(
            "{trials} trials are too few for an interval of coverage probability {level}; at least {needed} are needed"
        );
        Self::TooFewTrials { what, trials: trials as u64 }
    }
}
