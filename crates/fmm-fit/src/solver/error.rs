//! What a caller can do wrong when asking for a fit.

use fmm_model::Rounded;
use std::error::Error;

/// A fit that could not begin.
///
/// What happens once a fit runs is not an error but an [`Outcome`](crate::Outcome): the best point found is
/// worth having, however the search ended.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// The start has not one value per parameter.
    #[error("the start has {values} values, but the problem has {parameters} parameters")]
    StartLength {
        /// Number of values given.
        values: usize,
        /// Number of parameters.
        parameters: usize,
    },
    /// A start value is NaN or infinite.
    #[error("the start value of {parameter} must be finite, but is {value}", value = Rounded::every_digit(*.value))]
    StartNotFinite {
        /// Name of the parameter.
        parameter: String,
        /// The value given.
        value: f64,
    },
    /// A start value lies outside the bounds of its parameter.
    #[error("the start value of {parameter} is {value}, outside its bounds [{lower}, {upper}]", value = Rounded::every_digit(*.value), lower = Rounded::every_digit(*.lower), upper = Rounded::every_digit(*.upper))]
    StartOutsideBounds {
        /// Name of the parameter.
        parameter: String,
        /// The value given.
        value: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// Bounds that no value satisfies.
    #[error("the bounds of {parameter} exclude each other: at least {lower} and at most {upper}", lower = Rounded::every_digit(*.lower), upper = Rounded::every_digit(*.upper))]
    EmptyBounds {
        /// Name of the parameter.
        parameter: String,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// Two parameters with one name.
    #[error("two parameters are called {name}; give each a name of its own")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A residual at the start is NaN, infinite, or so large that the sum of squares overflows.
    #[error("residual {index} is {value} at the start, so that the sum of squares is not finite", value = Rounded::every_digit(*.value))]
    ResidualNotFinite {
        /// Index of the residual, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The residuals at the start are not zero, but so small that squares of what a fit leaves of them underflow.
    #[error(
        "the residuals at the start are at most {largest:e}, so that their squares underflow; give them in a smaller \
         unit, or divide them by their uncertainties"
    )]
    ResidualsUnderflow {
        /// The largest of their magnitudes.
        largest: f64,
    },
    /// A derivative at the start is NaN, infinite, or so large that its square overflows.
    #[error("the derivative of the residuals by {parameter} is not finite at the start")]
    DerivativeNotFinite {
        /// Name of the parameter.
        parameter: String,
    },
    /// There are not enough residuals to determine anything.
    #[error("{residuals} residuals cannot determine {free} free parameters; give at least as many residuals")]
    TooFewResiduals {
        /// Number of residuals.
        residuals: usize,
        /// Number of parameters that are not fixed.
        free: usize,
    },
    /// A block names a parameter that does not exist, or one twice.
    #[error("block {block} names parameter {index}; it may name each of the {parameters} parameters once")]
    InvalidBlock {
        /// Index of the block, from 0.
        block: usize,
        /// The index that it names, from 0.
        index: usize,
        /// Number of parameters.
        parameters: usize,
    },
    /// The blocks do not cover the residuals.
    #[error("the blocks have {rows} residuals together, but the problem has {residuals}")]
    BlockRows {
        /// Sum of the residuals of all blocks.
        rows: usize,
        /// Number of residuals.
        residuals: usize,
    },
    /// The model failed at the start.
    #[error("the model failed at the start: {0}")]
    ModelFailed(#[source] Box<dyn Error + Send + Sync>),
    /// An option has an impossible value.
    #[error("the option {option} must be {expected}, but is {value}", value = Rounded::every_digit(*.value))]
    InvalidOption {
        /// Name of the option.
        option: &'static str,
        /// What it may be.
        expected: &'static str,
        /// The value given.
        value: f64,
    },
    /// There is not one abscissa per ordinate.
    #[error("there are {abscissae} abscissae for {ordinates} ordinates; give one for each")]
    DataLength {
        /// Number of abscissae given.
        abscissae: usize,
        /// Number of ordinates given.
        ordinates: usize,
    },
    /// There is not one standard uncertainty per residual.
    #[error("{uncertainties} standard uncertainties were given for {residuals} residuals; give one for each")]
    UncertaintyCount {
        /// Number of uncertainties given.
        uncertainties: usize,
        /// Number of residuals.
        residuals: usize,
    },
    /// A standard uncertainty cannot be divided by.
    #[error("the standard uncertainty of residual {index} must be positive and finite, but is {value}", value = Rounded::every_digit(*.value))]
    BadUncertainty {
        /// Index of the residual, from 0.
        index: usize,
        /// The value given.
        value: f64,
    },
    /// A fit was asked for before the solver had run.
    #[error("the solver has not run yet, so there is no fit to report")]
    NotStarted,
}
