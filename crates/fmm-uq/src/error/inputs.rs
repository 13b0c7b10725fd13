//! Errors of numbers and of lists of inputs.

use fmm_model::Rounded;

use crate::UncertaintyError;

/// Numbers.
impl UncertaintyError {
    /// A parameter of a distribution, or an option of a run, outside its range.
    pub(crate) fn out_of_range(parameter: &str, value: f64, must_be: &str) -> Self {
        Self::OutOfRange {
            what: format!("the {parameter} must be {must_be}, but is {}", Rounded::every_digit(value)),
            value,
        }
    }

    /// Passes degrees of freedom through if they are at least 1; `of` says whose they are.
    pub(crate) fn require_degrees_of_freedom(of: &str, value: f64) -> Result<f64, Self> {
        if value >= 1.0 {
            return Ok(value);
        }
        let what = format!(
            "the degrees of freedom of {of} must be at least 1 and may be infinite, but are {}",
            Rounded::every_digit(value)
        );
        Err(Self::OutOfRange { what, value })
    }

    /// The estimate of an input is infinite or not a number.
    pub(crate) fn value_not_finite(input: &str, value: f64, unit: &str) -> Self {
        Self::OutOfRange {
            what: format!("the value of {input} must be finite, but is {} {unit}", Rounded::every_digit(value)),
            value,
        }
    }

    /// A standard uncertainty is negative or not finite.
    pub(crate) fn uncertainty_out_of_range(input: &str, value: f64, unit: &str) -> Self {
        Self::OutOfRange {
            what: format!(
                "the standard uncertainty of {input} must be zero or positive and finite, but is {} {unit}",
                Rounded::every_digit(value)
            ),
            value,
        }
    }

    /// A correlation coefficient outside [−1, 1] or not a number.
    pub(crate) fn correlation_out_of_range(first: &str, second: &str, value: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "the correlation of `{first}` and `{second}` must lie in [-1, 1], but is {}",
                Rounded::every_digit(value)
            ),
            value,
        }
    }

    /// Passes a coverage probability through if it lies strictly between 0 and 1.
    pub(crate) fn require_level(level: f64) -> Result<f64, Self> {
        if level > 0.0 && level < 1.0 { Ok(level) } else { Err(Self::level_out_of_range(level)) }
    }

    /// A coverage probability that is not strictly between 0 and 1.
    pub(crate) fn level_out_of_range(level: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "the coverage probability must lie between 0 and 1, such as 0.95, but is {}",
                Rounded::every_digit(level)
            ),
            value: level,
        }
    }

    /// Limits of a distribution that leave nothing between them.
    pub(crate) fn limits_out_of_order(lower: f64, upper: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "the lower limit {} must lie below the upper limit {}, and their distance must be finite",
                Rounded::every_digit(lower),
                Rounded::every_digit(upper)
            ),
            value: lower,
        }
    }

    /// An observation that is infinite or no number, or whose square is.
    pub(crate) fn observation_not_finite(index: usize, value: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "observation {index} must be finite, and its square too, but is {}",
                Rounded::every_digit(value)
            ),
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
    pub(crate) fn no_such_output(output: usize, outputs: usize) -> Self {
        Self::OutOfRange {
            what: format!("there is no output {output}; the model has {outputs}, counted from 0"),
            value: output as f64,
        }
    }
}

/// Lists of inputs.
impl UncertaintyError {
    /// An input without a name cannot be told apart in a budget.
    pub(crate) fn unnamed(value: f64, unit: &str) -> Self {
        Self::Inputs {
            what: format!(
                "an input needs a name, but the one of value {} {unit} has none",
                Rounded::every_digit(value)
            ),
        }
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
