//! Covariance of estimates by uncertain inputs, and the reasons why there may be none.

use crate::error::FitError;

/// Covariance of the estimates of a fit that the uncertainty of its inputs brings about (JCGM 100:2008, 5.2.2, and
/// JCGM 102:2011, 6.2.1).
#[derive(Debug, Clone, PartialEq)]
pub struct PropagatedCovariance {
    count: usize,
    elements: Vec<Option<f64>>,
}

impl PropagatedCovariance {
    pub(crate) fn new(count: usize, element: impl Fn(usize, usize) -> Option<f64>) -> Self {
        let elements = (0..count * count).map(|index| element(index / count, index % count)).collect();
        Self { count, elements }
    }

    /// Covariance of the estimates of parameters `i` and `j`, in the product of their units; `None` if either is fixed
    /// or not determined.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        if i < self.count && j < self.count { self.elements[i * self.count + j] } else { None }
    }

    /// Standard uncertainty of the estimate of parameter `i` from the inputs alone, in its unit.
    pub fn standard_uncertainty(&self, i: usize) -> Option<f64> {
        self.covariance(i, i).map(|variance| variance.max(0.0).sqrt())
    }
}

/// Why the sensitivity of a fit cannot be told.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SensitivityError {
    /// The fit is not one of the problem.
    #[error("the fit is not one of this problem: their parameters or numbers of residuals differ")]
    OtherFit,
    /// The fit ended elsewhere than at a minimum.
    #[error("the fit has not converged, and only a minimum has a sensitivity")]
    NotConverged,
    /// The blocks of the problem are not valid.
    #[error(transparent)]
    Problem(#[from] FitError),
    /// The model has no derivative at or near the fitted values.
    #[error("there is no derivative by {parameter} at or near its value: {reason}")]
    NoDerivative {
        /// Name of the parameter.
        parameter: String,
        /// What the model said.
        reason: String,
    },
    /// The second derivatives are not those of a minimum.
    #[error(
        "the second derivatives at the fitted values are not those of a minimum, so that these do not follow the inputs"
    )]
    NotAMinimum,
    /// The covariance of the inputs is not positive semidefinite, not symmetric, or of the wrong size.
    #[error("the covariance of the inputs {reason}; it needs {inputs} rows and columns")]
    InvalidCovariance {
        /// What is wrong with it.
        reason: &'static str,
        /// Number of inputs.
        inputs: usize,
    },
}
