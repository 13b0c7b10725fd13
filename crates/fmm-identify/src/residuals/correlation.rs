//! Covariance of the estimates when neighbouring residuals tell each other's value.

use std::ops::Range;

use fmm_fit::{CorrelatedCovariance, EvaluationError, Fit, Residuals};

/// Autocorrelation time (samples) below which residuals pass for independent.
const INDEPENDENT: f64 = 3.0;
/// Windows of this many correlation times lose little of the correlation,
const WINDOW: f64 = 5.0;
/// and with this many of them the covariance is known to about a third.
const FEWEST_WINDOWS: usize = 8;

/// Whether residuals with this autocorrelation time (samples) are not independent.
pub(crate) fn are_correlated(autocorrelation_time: f64) -> bool {
    autocorrelation_time > INDEPENDENT
}

/// The covariance in windows as long as residuals of this autocorrelation time (samples) ask for and the shortest of
/// `series` allows; `None` if that is too short for any.
pub(crate) fn correlated_covariance(
    problem: &impl Residuals,
    fit: &Fit,
    autocorrelation_time: f64,
    series: &[Range<usize>],
) -> Result<Option<CorrelatedCovariance>, EvaluationError> {
    let longest = series.iter().map(Range::len).min().unwrap_or(0) / FEWEST_WINDOWS;
    let span = ((WINDOW * autocorrelation_time) as usize).min(longest).max(1);
    CorrelatedCovariance::of(problem, fit, span, series)
}
