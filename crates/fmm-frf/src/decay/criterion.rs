//! Criterion of a term: regression of the points of a backbone with its Bayesian score.

use fmm_fit::{LinearRegression, Weighting};
use fmm_model::Estimated;

/// Least value of a coefficient, in its standard uncertainties.
pub(crate) const SIGNIFICANT: f64 = 2.0;
/// Points that are told by one window: neighbours share three quarters of theirs.
const POINTS_PER_WINDOW: f64 = 2.0;

/// Coefficients of `columns` for `values`, and the Bayesian criterion of what they leave; `None` if they are not told
/// apart.
///
/// Values are taken to be good to a relative `accuracy` (1) at best.
pub(crate) fn scored(columns: &[Vec<f64>], values: &[Estimated], accuracy: f64) -> Option<(f64, Vec<Estimated>)> {
    let count = values.len() as f64 / POINTS_PER_WINDOW;
    if count < columns.len() as f64 + 1.0 {
        return None;
    }
    let right: Vec<f64> = values.iter().map(|value| value.value).collect();
    let weights: Vec<f64> =
        values.iter().map(|value| value.uncertainty.hypot(accuracy * value.value).max(f64::MIN_POSITIVE)).collect();
    let named: Vec<(&str, &[f64])> = columns.iter().map(|column| ("term", column.as_slice())).collect();
    let regression = LinearRegression::fit(&named, &right, Weighting::Absolute(&weights)).ok()?;
    // The points share samples, and are not better than their uncertainties.
    let spread = (regression.sum_of_squares() / values.len() as f64).max(1.0);
    let inflation = (POINTS_PER_WINDOW * spread).sqrt();
    let found = (0..columns.len())
        .map(|j| Some(Estimated::new(regression.coefficients()[j], inflation * regression.standard_uncertainty(j)?)));
    let score = count * spread.ln() + columns.len() as f64 * count.ln();
    Some((score, found.collect::<Option<_>>()?))
}
