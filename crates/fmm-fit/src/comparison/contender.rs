//! A model that takes part in a comparison.

use crate::diagnostics::autocorrelation_time;
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

    /// Says that the model called `name` is a special case of this one.
    #[must_use]
    pub fn containing(mut self, name: impl Into<String>) -> Self {
        self.contains.push(name.into());
        self
    }
}

/// Number of independent residuals in a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ResidualCount {
    /// All of them.
    All,
    /// n/τ with the autocorrelation time τ of the best fitting model: what it leaves is the nearest there is to noise.
    #[default]
    OfBest,
    /// This many; at most all of them count.
    Given(f64),
}

/// The information criterion that ranks models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Criterion {
    /// Akaike's, corrected for few residuals: which model predicts best. A further parameter costs little more than 2,
    /// so that it hardly ever decides against a model that contains the true one.
    #[default]
    CorrectedAkaike,
    /// Schwarz' Bayesian one: which model is the most probable if one of them is true.
    Bayesian,
}

/// Options of a comparison of models.
///
/// ```
/// use fmm_fit::{ComparisonOptions, Criterion, ResidualCount};
///
/// let comparing = ComparisonOptions::default().by(Criterion::Bayesian).counting(ResidualCount::All);
/// # let _ = comparing;
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct ComparisonOptions {
    pub(crate) criterion: Criterion,
    pub(crate) count: ResidualCount,
}

impl ComparisonOptions {
    /// The criterion that ranks (corrected Akaike).
    #[must_use]
    pub fn by(mut self, criterion: Criterion) -> Self {
        self.criterion = criterion;
        self
    }

    /// The number of residuals that count (those of the best model, over their autocorrelation time).
    #[must_use]
    pub fn counting(mut self, count: ResidualCount) -> Self {
        self.count = count;
        self
    }
}
