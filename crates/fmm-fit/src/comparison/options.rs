//! Options of a comparison of models.

/// How many independent residuals a comparison counts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ResidualCount {
    /// All of them.
    All,
    /// n/τ with the autocorrelation time τ of the best fitting model: what it leaves is the nearest there is to noise.
    #[default]
    OfBest,
    /// So many; at most all of them count.
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

/// How models are compared.
///
/// ```
/// use fmm_fit::{ComparisonOptions, Criterion, ResidualCount};
///
/// let comparing = ComparisonOptions::default().by(Criterion::Bayesian).counting(ResidualCount::All).with_margin(2.0);
/// # let _ = comparing;
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ComparisonOptions {
    pub(crate) criterion: Criterion,
    pub(crate) count: ResidualCount,
    pub(crate) margin: f64,
    pub(crate) significance: f64,
    pub(crate) floor: f64,
}

impl Default for ComparisonOptions {
    fn default() -> Self {
        Self {
            criterion: Criterion::default(),
            count: ResidualCount::default(),
            margin: 4.0,
            significance: 0.05,
            floor: 0.0,
        }
    }
}

impl ComparisonOptions {
    /// The criterion that ranks (corrected Akaike).
    #[must_use]
    pub fn by(mut self, criterion: Criterion) -> Self {
        self.criterion = criterion;
        self
    }

    /// How many residuals count (those of the best model, over their autocorrelation time).
    #[must_use]
    pub fn counting(mut self, count: ResidualCount) -> Self {
        self.count = count;
        self
    }

    /// By how much the score of the winner must be below all others (4). Burnham and Anderson call the support for a
    /// model substantial within 2 of the best, considerably less from 4 on, and none beyond 10.
    #[must_use]
    pub fn with_margin(mut self, margin: f64) -> Self {
        self.margin = margin;
        self
    }

    /// The probability above which an F-test does not reject the special case (0.05).
    #[must_use]
    pub fn with_significance(mut self, significance: f64) -> Self {
        self.significance = significance;
        self
    }

    /// A sum of squares below which fits are equally good, such as that of the resolution of the data (0).
    #[must_use]
    pub fn with_floor(mut self, sum_of_squares: f64) -> Self {
        self.floor = sum_of_squares;
        self
    }
}
