//! Errors of a request for a regression.

use fmm_model::Rounded;

use crate::error::FitError;

/// A regression that is not possible with the data given.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RegressionError {
    /// A column has not one value per observation.
    #[error("{name} has {values} values for {observations} observations; give one for each")]
    DifferentLengths {
        /// What was given.
        name: String,
        /// Number of its values.
        values: usize,
        /// Number of observations.
        observations: usize,
    },
    /// A value is NaN or infinite.
    #[error("value {index} of {name} must be finite, but is {value}", value = Rounded::every_digit(*.value))]
    NotFinite {
        /// What the value belongs to.
        name: String,
        /// Index of the value, from 0.
        index: usize,
        /// The value given.
        value: f64,
    },
    /// A standard uncertainty is not a positive number, or so small that its inverse overflows.
    #[error("the standard uncertainty of observation {index} must be positive and finite, but is {value}", value = Rounded::every_digit(*.value))]
    BadUncertainty {
        /// Index of the observation, from 0.
        index: usize,
        /// The value given.
        value: f64,
    },
    /// A correlation coefficient is not between −1 and 1.
    #[error("the correlation of the errors of point {index} must lie between -1 and 1, both excluded, but is {value}", value = Rounded::every_digit(*.value))]
    BadCorrelation {
        /// Index of the point, from 0.
        index: usize,
        /// The value given.
        value: f64,
    },
    /// A point is known exactly in both directions, so that it would have all the weight.
    #[error("point {index} has no uncertainty in the direction that counts; give it one in x or in y")]
    NoUncertainty {
        /// Index of the point, from 0.
        index: usize,
    },
    /// There are not enough observations.
    #[error("{observations} observations cannot determine {coefficients} coefficients; give at least as many")]
    TooFewObservations {
        /// Number of observations.
        observations: usize,
        /// Number of coefficients.
        coefficients: usize,
    },
    /// Too many of the abscissae are equal.
    #[error("{distinct} different values of x cannot determine {coefficients} coefficients; give at least as many")]
    TooFewAbscissae {
        /// Number of different values of x that tell something.
        distinct: usize,
        /// Number of coefficients.
        coefficients: usize,
    },
    /// A power law has no value at a negative abscissa.
    #[error("value {index} of x is {value}, but a power law needs values that are not negative", value = Rounded::every_digit(*.value))]
    NegativeAbscissa {
        /// Index of the value, from 0.
        index: usize,
        /// The value given.
        value: f64,
    },
    /// There is no column to fit.
    #[error("a regression needs at least one column")]
    NoColumn,
    /// Numbers of the data are so far apart that their squares or powers overflow.
    #[error("the data span too many orders of magnitude; change the units")]
    Overflow,
    /// The line is so steep that no slope describes it.
    #[error("no slope minimises the sum of squares: the line is vertical, or there is none; exchange x and y")]
    NoSlope,
    /// The bounded solver refused the problem.
    #[error(transparent)]
    Fit(#[from] FitError),
}
