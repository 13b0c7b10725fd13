//! Whether the residuals are noise, and the covariance of the estimates either way.

use std::ops::Range;

use fmm_fit::{CorrelatedCovariance, EvaluationError, Fit, Residuals, autocorrelation_time};

use crate::RingDown;
use crate::correlation::{are_correlated, correlated_covariance};

/// What the residuals of a fit look like beside the noise of the records.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ResidualStructure {
    /// Root mean square of the residuals, in the unit of the records.
    pub(crate) residual: f64,
    /// Standard deviation of what cannot be fitted: white noise and rounding, in the same unit.
    pub(crate) noise: f64,
    /// What rounding of doubles alone makes of a record without noise, in the same unit.
    rounding: f64,
    /// τ (samples).
    pub(crate) autocorrelation_time: f64,
}

/// Above this ratio of residual to noise, and with neighbours that tell each other's value, a law misses something.
const EXCESS: f64 = 1.5;

impl ResidualStructure {
    pub(crate) fn of(fit: &Fit, decays: &[RingDown]) -> Self {
        let summaries = || decays.iter().map(RingDown::summary);
        let rounding = summaries().map(|summary| 1e-9 * summary.amplitudes.0).fold(0.0, f64::max);
        // A converter step counts as the noise of its rounding.
        let noise = summaries()
            .map(|summary| summary.noise.hypot(summary.resolution.unwrap_or(0.0) / 12f64.sqrt()))
            .fold(rounding, f64::max);
        let count = fit.residuals().len() as f64;
        Self {
            residual: (fit.sum_of_squares() / count).sqrt(),
            noise,
            rounding,
            autocorrelation_time: autocorrelation_time(fit.residuals()).unwrap_or(1.0),
        }
    }

    /// Whether neighbouring residuals tell each other's value: the law misses something, or a coarse converter rounds
    /// neighbours alike.
    pub(crate) fn is_correlated(&self) -> bool {
        self.residual > self.rounding && are_correlated(self.autocorrelation_time)
    }

    /// Whether the law misses something that the record shows.
    pub(crate) fn is_structured(&self) -> bool {
        self.residual > EXCESS * self.noise && self.is_correlated()
    }
}

/// Covariance of the estimates: that of independent residuals or, if they are correlated, the larger of that and the one
/// that takes their correlation into account. A parameter that ended on its bound counts as free to leave it, so that
/// the uncertainty of the others includes what it may take from them.
pub(crate) struct Covariance<'a> {
    fit: &'a Fit,
    correlated: Option<CorrelatedCovariance>,
}

impl<'a> Covariance<'a> {
    pub(crate) fn of(
        problem: &impl Residuals,
        fit: &'a Fit,
        structure: &ResidualStructure,
        decays: &[RingDown],
    ) -> Result<Self, EvaluationError> {
        let mut correlated = None;
        if structure.is_correlated() {
            let mut end = 0;
            let series: Vec<Range<usize>> = decays
                .iter()
                .map(|decay| {
                    let start = end;
                    end += decay.summary().samples;
                    start..end
                })
                .collect();
            correlated = correlated_covariance(problem, fit, structure.autocorrelation_time, &series)?;
        }
        Ok(Self { fit, correlated })
    }

    /// Covariance of parameters `i` and `j`; none where the record does not determine them.
    pub(crate) fn get(&self, i: usize, j: usize) -> Option<f64> {
        match &self.correlated {
            None if self.fit.estimates()[i].standard_uncertainty().is_some() => {
                self.fit.relaxed_covariance(i, j).or_else(|| self.fit.covariance(i, j))
            }
            None => None,
            Some(correlated) => Some(correlated.covariance(i, j)? * self.widening(i) * self.widening(j)),
        }
    }

    /// Factor that keeps an uncertainty from falling below that of independent residuals without bounds.
    fn widening(&self, i: usize) -> f64 {
        let correlated = self.correlated.as_ref().and_then(|covariance| covariance.standard_uncertainty(i));
        match (correlated, self.fit.relaxed_covariance(i, i).map(f64::sqrt)) {
            (Some(correlated), Some(white)) if correlated > 0.0 => (white / correlated).max(1.0),
            _ => 1.0,
        }
    }

    /// Degrees of freedom of the covariance.
    pub(crate) fn degrees_of_freedom(&self) -> f64 {
        let independent = self.fit.degrees_of_freedom() as f64;
        self.correlated.as_ref().map_or(independent, |covariance| covariance.degrees_of_freedom().min(independent))
    }

    /// Largest ratio of an uncertainty to that of independent residuals.
    pub(crate) fn inflation(&self) -> f64 {
        let estimates = self.fit.estimates().iter().enumerate();
        estimates
            .filter(|(_, estimate)| estimate.standard_uncertainty().is_some())
            .filter_map(|(i, _)| Some((self.get(i, i)? / self.fit.relaxed_covariance(i, i)?).sqrt()))
            .fold(1.0, f64::max)
    }
}
