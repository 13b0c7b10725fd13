//! Share of prior knowledge in the covariance of estimates.

use fmm_fit::Fit;

use crate::finding::Source;
use crate::quantities::prior::Prior;

/// Changes of the estimates with prior knowledge, and its covariance V.
///
/// ```text
/// K = ∂θ/∂x₀ = σ² (JᵀJ)⁻¹ Eᵀ V⁻¹,     share of the covariance of θ: K V Kᵀ
/// ```
///
/// E picks the known quantities out of the parameters θ, and J has the rows of the knowledge among its own.
#[derive(Debug, Clone, Default)]
pub(crate) struct Knowledge {
    sources: Vec<Source>,
    /// Columns of K.
    slopes: Vec<Vec<f64>>,
    /// V, row by row.
    covariance: Vec<f64>,
}

impl Knowledge {
    /// Knowledge in `fit` by a `prior`, beside records with noise of standard deviation `noise`; `unit` is an element
    /// of (JᵀJ)⁻¹, 0 for parameters that are not determined.
    pub(crate) fn of(prior: &Prior, noise: f64, fit: &Fit, unit: impl Fn(usize, usize) -> f64) -> Self {
        let (count, indices) = (prior.len(), &prior.indices);
        let precision = prior.precision();
        let slope = |row: usize, of: usize| {
            let sum: f64 = (0..count).map(|k| unit(row, indices[k]) * precision[k * count + of]).sum();
            noise * noise * sum
        };
        let slopes = (0..count).map(|of| (0..fit.values().len()).map(|row| slope(row, of)).collect()).collect();
        Self { sources: prior.sources.clone(), slopes, covariance: prior.covariance.clone() }
    }

    /// Number of quantities that were known beforehand.
    pub(crate) fn len(&self) -> usize {
        self.sources.len()
    }

    /// True if nothing was known beforehand.
    pub(crate) fn is_empty(&self) -> bool {
        self.sources.is_empty()
    }

    /// Its share of the covariance of estimates `i` and `j`.
    pub(crate) fn pair(&self, i: usize, j: usize) -> f64 {
        self.form(|of| self.slopes[of][i], |of| self.slopes[of][j], |_| true)
    }

    /// Its share of the variance of what has this `gradient` over the first estimates, by source.
    pub(crate) fn parts(&self, gradient: &[f64]) -> Vec<(Source, f64)> {
        let along = |of: usize| gradient.iter().zip(&self.slopes[of]).map(|(a, b)| a * b).sum::<f64>();
        let along: Vec<f64> = (0..self.sources.len()).map(along).collect();
        let mut parts: Vec<(Source, f64)> = Vec::new();
        for source in &self.sources {
            if parts.iter().all(|(other, _)| other != source) {
                parts.push((*source, self.form(|of| along[of], |of| along[of], |of| self.sources[of] == *source)));
            }
        }
        parts
    }

    /// Σ a V b over the known quantities that count.
    fn form(&self, a: impl Fn(usize) -> f64, b: impl Fn(usize) -> f64, counts: impl Fn(usize) -> bool) -> f64 {
        let count = self.sources.len();
        let known = || (0..count).filter(|of| counts(*of));
        known().map(|i| known().map(|j| a(i) * self.covariance[i * count + j] * b(j)).sum::<f64>()).sum()
    }
}
