//! Errors of a request for a fit.

use std::error::Error;

use fmm_model::Rounded;

/// A fit that could not begin.
///
/// What happens once a fit runs is not an error but an [`Outcome`](crate::Outcome): the best point found is
/// worth having, however the search ended.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Start values, data or uncertainties that are not as many as they have to be: give one for each.
    #[error("{what}")]
    Count {
        /// How many there are, and how many are needed.
        what: String,
    },
    /// A start value, an uncertainty, a residual or an option that cannot be: give another.
    #[error("{what}")]
    OutOfRange {
        /// What it is given for, its value, and what it may be.
        what: String,
        /// The value.
        value: f64,
    },
    /// Parameters, bounds or blocks of a problem that contradict each other: mend the problem.
    #[error("{what}")]
    Problem {
        /// Which they are, and what is wrong with them.
        what: String,
    },
    /// A model that fails at the start, or has no finite residuals or derivatives there: begin elsewhere.
    #[error("{what}")]
    NoModel {
        /// What it gives.
        what: String,
        /// What the model itself reported.
        source: Option<Box<dyn Error + Send + Sync>>,
    },
    /// There are not enough residuals to determine anything.
    #[error("{residuals} residuals cannot determine {free} free parameters; give at least as many residuals")]
    TooFewResiduals {
        /// Number of residuals.
        residuals: usize,
        /// Number of parameters that are not fixed.
        free: usize,
    },
    /// A fit was asked for before the solver had run.
    #[error("the solver has not run yet, so there is no fit to report")]
    NotStarted,
}

impl FitError {
    /// A model that failed at the start.
    pub(crate) fn model_failed(source: Box<dyn Error + Send + Sync>) -> Self {
        Self::NoModel { what: format!("the model failed at the start: {source}"), source: Some(source) }
    }

    /// The start has not one value per parameter.
    pub(crate) fn start_length(values: usize, parameters: usize) -> Self {
        let what = format!("the start has {values} values, but the problem has {parameters} parameters");
        Self::Count { what }
    }

    /// A start value is NaN or infinite.
    pub(crate) fn start_not_finite(parameter: &str, value: f64) -> Self {
        let what = format!(
            "the start value of {parameter} must be finite, but is {value}",
            value = Rounded::every_digit(value)
        );
        Self::OutOfRange { what, value }
    }

    /// A start value lies outside the bounds of its parameter.
    pub(crate) fn start_outside_bounds(parameter: &str, value: f64, lower: f64, upper: f64) -> Self {
        let what = format!(
            "the start value of {parameter} is {value}, outside its bounds [{lower}, {upper}]",
            value = Rounded::every_digit(value),
            lower = Rounded::every_digit(lower),
            upper = Rounded::every_digit(upper)
        );
        Self::OutOfRange { what, value }
    }

    /// Bounds that no value satisfies.
    pub(crate) fn empty_bounds(parameter: &str, lower: f64, upper: f64) -> Self {
        let what = format!(
            "the bounds of {parameter} exclude each other: at least {lower} and at most {upper}",
            lower = Rounded::every_digit(lower),
            upper = Rounded::every_digit(upper)
        );
        Self::Problem { what }
    }

    /// Two parameters with one name.
    pub(crate) fn duplicate_name(name: &str) -> Self {
        let what = format!("two parameters are called {name}; give each a name of its own");
        Self::Problem { what }
    }

    /// A residual at the start is NaN, infinite, or so large that the sum of squares overflows.
    pub(crate) fn residual_not_finite(index: usize, value: f64) -> Self {
        let what = format!(
            "residual {index} is {value} at the start, so that the sum of squares is not finite",
            value = Rounded::every_digit(value)
        );
        Self::NoModel { what, source: None }
    }

    /// The residuals at the start are not zero, but so small that squares of what a fit leaves of them underflow.
    pub(crate) fn residuals_underflow(largest: f64) -> Self {
        let what = format!(
            "the residuals at the start are at most {largest:e}, so that their squares underflow; give them in a smaller unit, or divide them by their uncertainties"
        );
        Self::OutOfRange { what, value: largest }
    }

    /// A derivative at the start is NaN, infinite, or so large that its square overflows.
    pub(crate) fn derivative_not_finite(parameter: &str) -> Self {
        let what = format!("the derivative of the residuals by {parameter} is not finite at the start");
        Self::NoModel { what, source: None }
    }

    /// A block names a parameter that does not exist, or one twice.
    pub(crate) fn invalid_block(block: usize, index: usize, parameters: usize) -> Self {
        let what =
            format!("block {block} names parameter {index}; it may name each of the {parameters} parameters once");
        Self::Problem { what }
    }

    /// The blocks do not cover the residuals.
    pub(crate) fn block_rows(rows: usize, residuals: usize) -> Self {
        let what = format!("the blocks have {rows} residuals together, but the problem has {residuals}");
        Self::Count { what }
    }

    /// An option has an impossible value.
    pub(crate) fn invalid_option(option: &str, expected: &str, value: f64) -> Self {
        let what =
            format!("the option {option} must be {expected}, but is {value}", value = Rounded::every_digit(value));
        Self::OutOfRange { what, value }
    }

    /// There is not one abscissa per ordinate.
    pub(crate) fn data_length(abscissae: usize, ordinates: usize) -> Self {
        let what = format!("there are {abscissae} abscissae for {ordinates} ordinates; give one for each");
        Self::Count { what }
    }

    /// There is not one standard uncertainty per residual.
    pub(crate) fn uncertainty_count(uncertainties: usize, residuals: usize) -> Self {
        let what =
            format!("{uncertainties} standard uncertainties were given for {residuals} residuals; give one for each");
        Self::Count { what }
    }

    /// A standard uncertainty cannot be divided by.
    pub(crate) fn bad_uncertainty(index: usize, value: f64) -> Self {
        let what = format!(
            "the standard uncertainty of residual {index} must be positive and finite, but is {value}",
            value = Rounded::every_digit(value)
        );
        Self::OutOfRange { what, value }
    }
}
