//! A model that takes part in a comparison.

use crate::diagnostics::residual_diagnostics::autocorrelation_time;
use crate::diagnostics::runs_test::{RunsTest, runs_test};
use crate::regression::linear_regression::LinearRegression;
use crate::result::fit::Fit;

/// A model that takes part in a comparison: its name and what its fit left.
#[derive(Debug, Clone)]
pub struct Contender {
    pub(crate) name: String,
    pub(crate) count: usize,
    pub(crate) sum_of_squares: f64,
    pub(crate) rank: usize,
    pub(crate) is_finished: bool,
    pub(crate) runs: Option<RunsTest>,
    pub(crate) autocorrelation_time: f64,
    pub(crate) contains: Vec<String>,
}

impl Contender {
    /// A model whose fit left `residuals` and determined `rank` parameters.
    pub fn new(name: impl Into<String>, residuals: &[f64], rank: usize) -> Self {
        Self {
            name: name.into(),
            count: residuals.len(),
            sum_of_squares: residuals.iter().map(|r| r * r).sum(),
            rank,
            is_finished: true,
            runs: runs_test(residuals),
            autocorrelation_time: autocorrelation_time(residuals).unwrap_or(1.0),
            contains: Vec::new(),
        }
    }

    /// The model of a fit. One that did not end at a minimum takes part, but keeps the data from deciding.
    pub fn of_fit(name: impl Into<String>, fit: &Fit) -> Self {
        let is_finished = fit.outcome().is_success();
        Self { is_finished, ..Self::new(name, fit.residuals(), fit.rank()) }
    }

    /// The model of a regression.
    pub fn of_regression(name: impl Into<String>, regression: &LinearRegression) -> Self {
        Self::new(name, regression.residuals(), regression.rank())
    }

    /// Replaces the autocorrelation time, in samples, that was found over all residuals in a row; needed where they are
    /// several series, such as one per record. Less than 1 counts as 1.
    #[must_use]
    pub fn with_autocorrelation_time(mut self, samples: f64) -> Self {
        self.autocorrelation_time = samples.max(1.0);
        self
    }

    /// Says that the model called `name` is a special case of this one.
    #[must_use]
    pub fn containing(mut self, name: impl Into<String>) -> Self {
        self.contains.push(name.into());
        self
    }
}
