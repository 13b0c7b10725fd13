//! Sources of the uncertainty of a friction curve.

use nalgebra::{DMatrix, DVector};

use crate::finding::Source;
use crate::friction_curve::levels::LEVELS;
use crate::friction_curve::mixture::Posterior;

/// Parts of the covariance C of the levels, relative to the scale of the posterior.
///
/// ```text
/// E(b) moves by C dη with the record, and var η = Λ:
/// C Λ C     scatter of the mean from record to record
/// C − C Λ C     what the prior of the curve leaves, alike in all records of one curve
/// ```
///
/// With a prior that is one normal distribution of precision P, C = (Λ + P)⁻¹ and the second part is C P C. Of the
/// scatter what each declared value makes is a part of its own.
#[derive(Debug, Clone)]
pub(super) struct Sources {
    scatter: DMatrix<f64>,
    /// Change of the levels for one standard uncertainty of each declared value.
    by_declared: Vec<(Source, DVector<f64>)>,
}

impl Sources {
    /// Sources of a `posterior` by records of which the levels have this `precision`, and of which each declared value
    /// changes the information so much, relative to `scale`.
    pub(super) fn of(
        posterior: &Posterior,
        precision: &DMatrix<f64>,
        by_declared: &[(Source, DVector<f64>)],
        scale: f64,
    ) -> Self {
        let covariance = posterior.covariance();
        let scatter = &covariance * (precision * (scale * scale)) * &covariance;
        let moved = |(source, by): &(Source, DVector<f64>)| (*source, &covariance * by * scale);
        Self { scatter, by_declared: by_declared.iter().map(moved).collect() }
    }

    /// Variances by source of what has these `weights` over the levels, and the `variance` in all.
    pub(super) fn parts(&self, weights: &[f64; LEVELS], variance: f64) -> Vec<(Source, f64)> {
        let weights = DVector::from_column_slice(weights);
        let scatter = weights.dot(&(&self.scatter * &weights)).min(variance);
        let declared: Vec<(Source, f64)> =
            self.by_declared.iter().map(|(source, by)| (*source, by.dot(&weights).powi(2))).collect();
        let by_declared: f64 = declared.iter().map(|(_, variance)| variance).sum();
        let own = [(Source::Residuals, (scatter - by_declared).max(0.0)), (Source::Smoothness, variance - scatter)];
        own.into_iter().chain(declared).collect()
    }
}
