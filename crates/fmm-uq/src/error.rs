//! Errors of inputs, of models and of questions to a budget.

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
    /// Partial results that do not make a whole: merge those of one run, each once.
    #[error("{what}")]
    Partial {
        /// Fault of the parts.
        what: String,
        /// The block of trials that is missing, damaged or there twice.
        block: Option<u64>,
    },
}

/// Numbers.
impl UncertaintyError {
    /// A parameter of a distribution, or an option of a run, outside its range.
    pub(crate) fn out_of_range(parameter: &str, value: f64, must_be: &str) -> Self {
        Self::OutOfRange { what: format!("the {parameter} must be {must_be}, but is {value}"), value }
    }

    /// Passes degrees of freedom through if they are at least 1; `of` says whose they are.
    pub(crate) fn require_degrees_of_freedom(of: &str, value: f64) -> Result<f64, Self> {
        if value >= 1.0 {
            return Ok(value);
        }
        let what = format!("the degrees of freedom of {of} must be at least 1 and may be infinite, but are {value}");
        Err(Self::OutOfRange { what, value })
    }

    /// The estimate of an input is infinite or not a number.
    pub(crate) fn value_not_finite(input: &str, value: f64, unit: &str) -> Self {
        Self::OutOfRange { what: format!("the value of {input} must be finite, but is {value} {unit}"), value }
    }

    /// A standard uncertainty is negative or not finite.
    pub(crate) fn uncertainty_out_of_range(input: &str, value: f64, unit: &str) -> Self {
        Self::OutOfRange {
            what: format!(
                "the standard uncertainty of {input} must be zero or positive and finite, but is {value} {unit}"
            ),
            value,
        }
    }

    /// A correlation coefficient outside [−1, 1] or not a number.
    pub(crate) fn correlation_out_of_range(first: &str, second: &str, value: f64) -> Self {
        Self::OutOfRange {
            what: format!("the correlation of `{first}` and `{second}` must lie in [-1, 1], but is {value}"),
            value,
        }
    }

    /// A coverage probability that is not strictly between 0 and 1.
    pub(crate) fn level_out_of_range(level: f64) -> Self {
        Self::OutOfRange {
            what: format!("the coverage probability must lie between 0 and 1, such as 0.95, but is {level}"),
            value: level,
        }
    }

    /// Limits of a distribution that leave nothing between them.
    pub(crate) fn limits_out_of_order(lower: f64, upper: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "the lower limit {lower} must lie below the upper limit {upper}, and their distance must be finite"
            ),
            value: lower,
        }
    }

    /// An observation that is infinite or no number, or whose square is.
    pub(crate) fn observation_not_finite(index: usize, value: f64) -> Self {
        Self::OutOfRange {
            what: format!("observation {index} must be finite, and its square too, but is {value}"),
            value,
        }
    }

    /// Fewer than two groups, or one without observations.
    pub(crate) fn no_groups(groups: usize) -> Self {
        let what = format!(
            "two groups or more are needed, each with an observation at least, but {groups} were given, or one is empty"
        );
        Self::Inputs { what }
    }

    /// A group that is asked for and not there.
    pub(crate) fn no_such_group(group: usize, groups: usize) -> Self {
        Self::OutOfRange {
            what: format!("there is no group {group}; {groups} were given, counted from 0"),
            value: group as f64,
        }
    }

    /// Too few groups for a limit of what they show by chance.
    pub(crate) fn too_few_groups(found: usize, needed: usize) -> Self {
        Self::NoAnswer {
            what: format!("{found} groups differ in one way only; a limit by chance needs {needed} or more of them"),
        }
    }

    /// No trials at all.
    pub(crate) fn no_trials() -> Self {
        Self::OutOfRange { what: "at least one trial is needed, but none was asked for".to_owned(), value: 0.0 }
    }

    /// More trials than can be counted.
    pub(crate) fn too_many_trials(trials: u64, most: u64) -> Self {
        Self::OutOfRange {
            what: format!("{trials} trials are more than can be told apart; at most {most} are possible"),
            value: trials as f64,
        }
    }

    /// An output that does not exist.
    /// An output that does not exist.
    pub(crate) fn no_such_output(output: usize, outputs: usize) -> Self {
        Self::OutOfRange {
            what: format!("there is no output {output}; the model has {outputs}, counted from 0"),
            value: output as f64,
        }
    }
}

/// Formulas.
#[cfg(feature = "formula")]
impl UncertaintyError {
    fn formula(what: String) -> Self {
        Self::Model { what, source: None }
    }

    /// Text that is no formula from `rest` on.
    pub(crate) fn not_a_formula(text: &str, rest: &str) -> Self {
        let place = if rest.is_empty() { "at its end".to_owned() } else { format!("from {rest:?} on") };
        Self::formula(format!("{text:?} cannot be read as a formula {place}; write products with *, powers with ^"))
    }

    /// More levels than a parser should go down.
    pub(crate) fn formula_too_deep(most: usize) -> Self {
        Self::formula(format!("a formula may have at most {most} parentheses, powers and signs"))
    }

    /// A function that does not exist.
    pub(crate) fn unknown_function(name: &str, known: &[&str]) -> Self {
        Self::formula(format!("there is no function {name}; there are {} and atan2", known.join(", ")))
    }

    /// A quantity in a formula that is no input.
    pub(crate) fn unknown_in_formula(name: &str, known: &[&str]) -> Self {
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        Self::formula(format!("there is no quantity {name}; there is {known}"))
    }

    /// Values for another number of quantities.
    pub(crate) fn wrong_number_of_values(needed: usize, found: usize) -> Self {
        Self::formula(format!("the formula has {needed} quantities, but {found} values were given"))
    }

    /// Error of a word that cannot be the name of a quantity of a formula.
    pub(crate) fn not_a_name(name: &str) -> Self {
        let what = format!(
            "a formula cannot contain a quantity `{name}`; a name is made of letters, digits and underscores, begins with no digit, and is \
             no constant or function"
        );
        Self::Inputs { what }
    }
}

/// Lists of inputs.
impl UncertaintyError {
    /// An input without a name cannot be told apart in a budget.
    pub(crate) fn unnamed(value: f64, unit: &str) -> Self {
        Self::Inputs { what: format!("an input needs a name, but the one of value {value} {unit} has none") }
    }

    /// A model of no inputs has no uncertainty to propagate.
    pub(crate) fn no_inputs() -> Self {
        Self::Inputs { what: "at least one input is needed, but none was given".to_owned() }
    }

    /// Two inputs of the same name.
    pub(crate) fn duplicate_name(name: &str) -> Self {
        Self::Inputs { what: format!("each input needs a name of its own, but `{name}` is given twice") }
    }

    /// A correlation with an input that does not exist.
    pub(crate) fn unknown_name(name: &str, known: &str) -> Self {
        Self::Inputs { what: format!("there is no input `{name}`; the inputs are {known}") }
    }

    /// A correlation of an input with itself; it is 1 and cannot be set.
    pub(crate) fn self_correlation(name: &str) -> Self {
        Self::Inputs { what: format!("the correlation of `{name}` with itself is 1 and cannot be set") }
    }

    /// The same pair of inputs twice in one list of correlations.
    pub(crate) fn repeated_pair(first: &str, second: &str) -> Self {
        Self::Inputs { what: format!("the correlation of `{first}` and `{second}` is given twice") }
    }

    /// Correlation coefficients that no set of quantities can have together.
    pub(crate) fn not_positive_semidefinite(smallest_eigenvalue: f64) -> Self {
        Self::Inputs {
            what: format!(
                "no quantities can be correlated like this: the smallest eigenvalue of the correlation matrix is {smallest_eigenvalue:.3e}, and it must not be negative"
            ),
        }
    }

    /// Two budgets compared that do not rest on the same inputs.
    pub(crate) fn different_inputs() -> Self {
        Self::Inputs {
            what: "the two budgets do not rest on the same inputs, so that their covariance is not known".to_owned(),
        }
    }

    /// Observations that cannot be simultaneous.
    pub(crate) fn unequal_observations(first: usize, second: usize) -> Self {
        Self::Inputs {
            what: format!("simultaneous observations come in equal numbers, but there are {first} and {second}"),
        }
    }

    /// A shared input of a consensus that does not say what it contributes to each result.
    pub(crate) fn unequal_contributions(input: usize, found: usize, results: usize) -> Self {
        Self::Inputs {
            what: format!(
                "a shared input contributes to each of the {results} results, by 0 where it has no part, but for input {input} there are \
                 {found} contributions"
            ),
        }
    }

    /// An input in two ensembles, or twice in one.
    pub(crate) fn already_in_ensemble(name: &str) -> Self {
        Self::Inputs {
            what: format!("`{name}` is in an ensemble already; an uncertainty comes from one set of observations"),
        }
    }

    /// An ensemble is a multivariate t-distribution, which has room for normal and t-distributed inputs only.
    pub(crate) fn not_normal(name: &str) -> Self {
        Self::Inputs {
            what: format!(
                "`{name}` is neither normal nor t-distributed, and cannot be part of a multivariate t-distribution"
            ),
        }
    }
}

/// Models.
impl UncertaintyError {
    /// The model itself reported an error.
    pub(crate) fn model_failed(at: &str, source: Box<dyn Error + Send + Sync>) -> Self {
        Self::Model { what: format!("the model failed at {at}"), source: Some(source) }
    }

    /// The model gave an infinite result or no number.
    pub(crate) fn result_not_finite(result: f64, at: &str) -> Self {
        Self::Model { what: format!("the model gives {result} at {at}"), source: None }
    }

    /// A sensitivity is infinite or not a number, or its product with the uncertainty overflows.
    pub(crate) fn sensitivity_not_finite(input: &str, sensitivity: f64, at: &str) -> Self {
        Self::Model {
            what: format!("the sensitivity to {input} is {sensitivity}, which cannot be propagated, at {at}"),
            source: None,
        }
    }

    /// The model gave different results for the same values.
    pub(crate) fn model_not_repeatable(first: f64, again: f64, at: &str) -> Self {
        Self::Model {
            what: format!("the model gives {first}, then {again}, for the same values {at}; it must be deterministic"),
            source: None,
        }
    }

    /// The model has another number of outputs than it should have.
    pub(crate) fn output_count(expected: usize, found: usize) -> Self {
        Self::Model { what: format!("the model must give {expected} outputs, but gives {found}"), source: None }
    }

    /// A model whose number of outputs is not always the same.
    pub(crate) fn output_count_changed(first: usize, again: usize) -> Self {
        Self::Model {
            what: format!("the model gives {first} outputs, then {again}; their number must not change"),
            source: None,
        }
    }

    /// No trial succeeded at all.
    pub(crate) fn no_success() -> Self {
        Self::Model { what: "none of the trials succeeded".to_owned(), source: None }
    }

    /// Too many rows of a variance analysis in which the model failed.
    pub(crate) fn rows_failed(failed: u64, rows: u64, allowed: f64) -> Self {
        Self::Model {
            what: format!("the model failed in {failed} of {rows} rows, more than the allowed share of {allowed}"),
            source: None,
        }
    }
}

/// Questions.
impl UncertaintyError {
    /// The first-order uncertainty is zero although inputs are uncertain, so that no interval follows from it.
    pub(crate) fn linearisation_suspect() -> Self {
        Self::NoAnswer { what: "the first-order uncertainty is zero although inputs are uncertain: the linear approximation cannot see them, and no coverage interval follows from it".to_owned() }
    }

    /// The Welch–Satterthwaite formula does not hold, so that a coverage factor has to be chosen by the caller.
    pub(crate) fn degrees_of_freedom_undefined() -> Self {
        Self::NoAnswer { what: "inputs of finite degrees of freedom are correlated, where the Welch-Satterthwaite formula does not hold; choose the degrees of freedom and use coverage_factor".to_owned() }
    }

    /// Trials of an input that has no variance, so that the standard deviation of their results is a matter of chance.
    pub(crate) fn no_variance(input: &str, degrees_of_freedom: f64) -> Self {
        Self::NoAnswer {
            what: format!(
                "Student's t of {degrees_of_freedom} degrees of freedom, which {input} has, has no standard deviation, and so has none to state of the result; an interval can be stated"
            ),
        }
    }

    /// Trials of an input that has no mean, so that the mean of their results is a matter of chance.
    pub(crate) fn no_mean(input: &str, degrees_of_freedom: f64) -> Self {
        Self::NoAnswer {
            what: format!(
                "Student's t of {degrees_of_freedom} degrees of freedom, which {input} has, has no mean, and so has none to state of the result; an interval can be stated"
            ),
        }
    }

    /// A spread so small that it would count as none.
    pub(crate) fn too_small(of: &str) -> Self {
        Self::NoAnswer {
            what: format!("the spread of {of} is so small that its square is no number any more; take a smaller unit"),
        }
    }

    /// An output that does not vary has no variance to share among inputs.
    pub(crate) fn constant_output() -> Self {
        Self::NoAnswer {
            what: "the output does not vary, so that there is no variance to share among the inputs".to_owned(),
        }
    }

    /// Second-order terms that were not asked for, are not finite, or make the variance negative.
    pub(crate) fn no_second_order() -> Self {
        Self::NoAnswer { what: "there is no uncertainty to second order: it was not asked for, or the model cannot be expanded that far".to_owned() }
    }

    /// A covariance matrix of outputs that has no inverse, so that no ellipsoid belongs to it.
    pub(crate) fn singular_covariance() -> Self {
        Self::NoAnswer { what: "the outputs are fully correlated or constant, so that their coverage region has no extent in some direction".to_owned() }
    }

    /// Sensitivity indices of correlated inputs have no meaning as shares of a variance.
    pub(crate) fn correlated_inputs(first: &str, second: &str) -> Self {
        Self::NoAnswer {
            what: format!("variance shares need independent inputs, but `{first}` and `{second}` are not"),
        }
    }

    /// More inputs than the Sobol sequence has dimensions.
    pub(crate) fn too_many_dimensions(needed: usize, most: usize) -> Self {
        Self::NoAnswer { what: format!("the Sobol sequence has {most} dimensions, but these inputs need {needed}") }
    }
}

/// Trials.
impl UncertaintyError {
    /// So few trials that an interval would have to reach beyond the smallest or largest of them.
    pub(crate) fn too_few_trials(trials: usize, level: f64, needed: usize) -> Self {
        Self::TooFewTrials {
            what: format!(
                "{trials} trials are too few for an interval of coverage probability {level}; at least {needed} are needed"
            ),
            found: trials as u64,
            needed: needed as u64,
        }
    }

    /// An adaptive run that may not make the trials that its first decision takes.
    pub(crate) fn too_few_trials_allowed(allowed: u64, needed: u64) -> Self {
        Self::TooFewTrials {
            what: format!(
                "the first decision takes {needed} trials, but at most {allowed} are allowed; lower the level, or allow more"
            ),
            found: allowed,
            needed,
        }
    }
}

/// Partial results.
impl UncertaintyError {
    /// Partial results of different runs.
    pub(crate) fn layout_mismatch(what: &str, first: u64, second: u64) -> Self {
        Self::Partial {
            what: format!(
                "partial results belong together only if their {what} agree, but one has {first} and another {second}"
            ),
            block: None,
        }
    }

    /// The same block of trials twice.
    pub(crate) fn duplicate_block(block: u64) -> Self {
        Self::Partial {
            what: format!("block {block} is in both partial results; a shard must not be counted twice"),
            block: Some(block),
        }
    }

    /// A block of trials that no partial result holds.
    pub(crate) fn missing_block(block: u64) -> Self {
        Self::Partial {
            what: format!("block {block} is missing; merge the shard that holds it, or run it"),
            block: Some(block),
        }
    }

    /// A partial result that no run can have given.
    pub(crate) fn damaged_partial(block: u64, what: &str) -> Self {
        Self::Partial { what: format!("block {block} of the partial result is damaged: {what}"), block: Some(block) }
    }
}
