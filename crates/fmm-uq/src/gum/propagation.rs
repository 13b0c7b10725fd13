//! Several results of the same inputs, with their covariance.

use crate::{Budget, UncertaintyError};

/// The budgets of all outputs of a model, and how the outputs are correlated (JCGM 102:2011, 6.2).
#[derive(Debug, Clone, PartialEq)]
pub struct Propagation {
    budgets: Vec<Budget>,
}

impl Propagation {
    pub(crate) const fn new(budgets: Vec<Budget>) -> Self {
        Self { budgets }
    }

    /// The budgets in the order of the outputs.
    pub fn outputs(&self) -> &[Budget] {
        &self.budgets
    }

    /// The budget of the only output.
    ///
    /// # Errors
    /// [`UncertaintyError::Model`] if there are more.
    pub fn single(mut self) -> Result<Budget, UncertaintyError> {
        let found = self.budgets.len();
        match (self.budgets.pop(), found) {
            (Some(budget), 1) => Ok(budget),
            _ => Err(UncertaintyError::output_count(1, found)),
        }
    }

    /// u(y_i, y_j), covariance of two outputs (product of their units); 0 if there is no such output.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        match (self.budgets.get(i), self.budgets.get(j)) {
            (Some(first), Some(second)) => first.covariance_with(second).unwrap_or(0.0),
            _ => 0.0,
        }
    }

    /// Correlation coefficient of two outputs (1); 0 if one of them has no uncertainty.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        match (self.budgets.get(i), self.budgets.get(j)) {
            (Some(first), Some(second))
                if first.standard_uncertainty() > 0.0 && second.standard_uncertainty() > 0.0 =>
            {
                let scaled = self.covariance(i, j) / first.standard_uncertainty();
                (scaled / second.standard_uncertainty()).clamp(-1.0, 1.0)
            }
            _ => 0.0,
        }
    }
}
