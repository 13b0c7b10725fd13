//! Structure of the residuals, and the covariance of the estimates with or without it.

use fmm_fit::{EvaluationError, Fit, autocorrelation_time};

use crate::experiment::Experiment;
use crate::experiment::scaled;
use crate::finding::Source;
use crate::linear_algebra::inverse_of_products;
use crate::problem::Problem;
use crate::residuals::correlation::are_correlated;
use crate::residuals::knowledge::Knowledge;
use crate::residuals::noise::{ResidualNoise, Series};
use crate::warning::Warning;

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
    /// Lines of spectra are among the residuals, which do not follow each other in time.
    has_lines: bool,
}

/// Above this ratio of residual to noise, and with neighbours that tell each other's value, a law misses something.
const EXCESS: f64 = 1.5;

impl ResidualStructure {
    pub(crate) fn of(fit: &Fit, decays: &[Experiment]) -> Self {
        let rounding =
            scaled(decays).map(|(decay, weight)| 1e-9 * weight * decay.summary().amplitudes.0).fold(0.0, f64::max);
        // A converter step counts as the noise of its rounding.
        let noise = scaled(decays).map(|(decay, weight)| weight * decay.white_noise()).fold(rounding, f64::max);
        let has_lines = decays.iter().any(|decay| decay.lines().is_some());
        Self { has_lines, ..Self::beside(fit, noise, rounding) }
    }

    /// That of a fit to series of which the `noise` and the `rounding` are known, in the unit of the residuals.
    pub(crate) fn beside(fit: &Fit, noise: f64, rounding: f64) -> Self {
        let residual = (fit.sum_of_squares() / fit.residuals().len() as f64).sqrt();
        let autocorrelation_time = autocorrelation_time(fit.residuals()).unwrap_or(1.0);
        Self { residual, noise: noise.max(rounding), rounding, autocorrelation_time, has_lines: false }
    }

    /// Whether there is more in the residuals than the rounding of doubles.
    pub(crate) fn is_noisy(&self) -> bool {
        self.residual > self.rounding
    }

    /// Whether neighbouring residuals tell each other's value: the law misses something, or the noise is not white.
    pub(crate) fn is_correlated(&self) -> bool {
        self.is_noisy() && are_correlated(self.autocorrelation_time)
    }

    /// Whether the law misses something that the record shows.
    pub(crate) fn is_structured(&self) -> bool {
        self.is_excessive() && (self.is_correlated() || self.has_lines)
    }

    /// What a noise that is not white has to tell, for the largest `inflation` of a standard uncertainty; nothing where
    /// the law misses something or the noise is white.
    pub(crate) fn coloured_noise(&self, inflation: f64) -> Option<Warning> {
        let is_coloured = self.is_excessive() != self.is_correlated();
        let ratio = self.residual / self.noise;
        is_coloured.then_some(Warning::ColouredNoise {
            is_correlated: self.is_correlated(),
            time: self.autocorrelation_time,
            ratio,
            inflation,
        })
    }

    fn is_excessive(&self) -> bool {
        self.residual > EXCESS * self.noise
    }
}

/// Covariance of the estimates, for the noise that the residuals show.
///
/// ```text
/// V = (JᵀJ)⁻¹ JᵀΣJ (JᵀJ)⁻¹
/// ```
///
/// Where the noise is white and of one variance this is that of the [`Fit`]. A parameter that ended on its bound counts
/// as free to leave it, so that the uncertainty of the others includes what it may take from them.
#[derive(Debug, Clone)]
pub(crate) struct Covariance {
    count: usize,
    elements: Vec<Option<f64>>,
    /// Whether the fit knows the parameter: determined, and not on a bound.
    is_inside: Vec<bool>,
    degrees_of_freedom: f64,
    inflation: f64,
    noise: ResidualNoise,
    is_white: bool,
    knowledge: Knowledge,
}

impl Covariance {
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit, structure: &ResidualStructure) -> Result<Self, EvaluationError> {
        let columns = problem.columns(fit.values(), &Self::known(fit))?;
        let noise = Self::noise(problem, fit, structure, &columns, &inverse_of_products(&columns));
        Ok(Self::of_noise(fit, structure, &columns, noise).with_knowledge(problem, fit))
    }

    /// The same with what was known before the fit: the elements hold what the residuals of the records make of them,
    /// and the share of that knowledge.
    fn with_knowledge(mut self, problem: &Problem<'_>, fit: &Fit) -> Self {
        let variance = fit.residual_standard_deviation().map_or(0.0, |s| s * s).max(f64::MIN_POSITIVE);
        let unit = |i: usize, j: usize| Self::plain(fit, i, j).map_or(0.0, |covariance| covariance / variance);
        let knowledge = Knowledge::of(problem.prior(), problem.noise(), fit, unit);
        if !knowledge.is_empty() {
            // White residuals of the knowledge are among those of the fit; in the noise of the records there are none.
            let counted = if self.is_white { variance / problem.noise().powi(2) } else { 0.0 };
            for (at, element) in self.elements.iter_mut().enumerate() {
                let share = knowledge.pair(at / self.count, at % self.count);
                *element = element.map(|element| element + share * (1.0 - counted));
            }
        }
        self.knowledge = knowledge;
        self
    }

    /// Share of what was known before the fit in the variance of what has this `gradient` over the first estimates, by
    /// source.
    pub(crate) fn of_knowledge(&self, gradient: &[f64]) -> Vec<(Source, f64)> {
        self.knowledge.parts(gradient)
    }

    /// The parameters of a fit that have a variance.
    pub(crate) fn known(fit: &Fit) -> Vec<usize> {
        let has_variance = |i: &usize| Self::plain(fit, *i, *i).is_some();
        (0..fit.values().len()).filter(has_variance).collect()
    }

    fn plain(fit: &Fit, i: usize, j: usize) -> Option<f64> {
        fit.relaxed_covariance(i, j).or_else(|| fit.covariance(i, j))
    }

    /// That of a `fit` whose residuals show this `noise`; `columns` are the derivatives by the [`known`](Self::known)
    /// parameters.
    pub(crate) fn of_noise(
        fit: &Fit,
        structure: &ResidualStructure,
        columns: &[Vec<f64>],
        noise: ResidualNoise,
    ) -> Self {
        let count = fit.values().len();
        let plain = |at: usize| Self::plain(fit, at / count, at % count);
        let mut elements: Vec<Option<f64>> = (0..count * count).map(plain).collect();
        let known = Self::known(fit);
        let variance = fit.residual_standard_deviation().map_or(0.0, |s| s * s);
        let scale = 1.0 / variance.max(f64::MIN_POSITIVE);
        let pairs = known.iter().flat_map(|i| known.iter().map(move |j| i * count + j));
        let unit: Vec<f64> = pairs.map(|at| elements[at].unwrap_or(0.0) * scale).collect();
        let independent = fit.degrees_of_freedom() as f64;
        let (mut degrees_of_freedom, mut inflation) = (independent, 1.0_f64);
        let mut is_white = true;
        if structure.is_noisy() && !noise.is_plain() && !known.is_empty() {
            is_white = false;
            let order = known.len();
            let middle = noise.products(columns);
            let element = |matrix: &[f64], i: usize, j: usize| matrix[i * order + j];
            // A parameter's influence on the residuals of one that holds all others apart from what they can take over.
            let mut sum = 0.0;
            for (a, &i) in known.iter().enumerate() {
                for (b, &j) in known.iter().enumerate() {
                    let mut covariance = 0.0;
                    for k in 0..order {
                        for l in 0..order {
                            covariance += element(&unit, a, k) * element(&middle, k, l) * element(&unit, l, b);
                        }
                    }
                    if a == b {
                        let ratio = covariance / elements[i * count + j].unwrap_or(f64::INFINITY);
                        inflation = inflation.max(ratio.sqrt());
                        sum += ratio;
                    }
                    elements[i * count + j] = Some(covariance);
                }
            }
            // So many residuals tell no more than one.
            let alike = (sum / order as f64).max(1.0);
            let influence: Vec<f64> =
                (0..columns[0].len()).map(|row| columns.iter().map(|column| column[row]).sum()).collect();
            let told = (fit.residuals().len() as f64 / alike).min(2.0 * noise.ordinates_along(&influence));
            degrees_of_freedom = (told - fit.rank() as f64).max(1.5).min(independent);
        }
        let is_inside = fit.estimates().iter().map(|estimate| estimate.standard_uncertainty().is_some()).collect();
        Self {
            count,
            elements,
            is_inside,
            degrees_of_freedom,
            inflation,
            noise,
            is_white,
            knowledge: Knowledge::default(),
        }
    }

    fn noise(
        problem: &Problem<'_>,
        fit: &Fit,
        structure: &ResidualStructure,
        columns: &[Vec<f64>],
        weights: &[f64],
    ) -> ResidualNoise {
        let signals: Vec<Vec<f64>> =
            (0..problem.experiments().len()).map(|record| problem.signal(record, fit)).collect();
        let series: Vec<Series<'_>> = problem
            .row_ranges()
            .enumerate()
            .map(|(record, rows)| Series {
                rows,
                signal: structure.is_noisy().then_some(signals[record].as_slice()),
                period: problem.experiments()[record].record().rate()
                    / problem.experiments()[record].guess().frequency(),
                columns,
                weights,
                stays: problem.experiments()[record].stays(),
            })
            .collect();
        ResidualNoise::of(fit.residuals(), &series)
    }

    /// Covariance of parameters `i` and `j`; `None` where the record does not determine them, or for those on a bound.
    pub(crate) fn get(&self, i: usize, j: usize) -> Option<f64> {
        if self.is_inside[i] && self.is_inside[j] { self.elements[i * self.count + j] } else { None }
    }

    /// Variance of parameter `i` as if it were not on its bound.
    pub(crate) fn relaxed(&self, i: usize) -> Option<f64> {
        self.relaxed_pair(i, i)
    }

    /// Covariance of parameters `i` and `j` as if they were not on their bounds.
    pub(crate) fn relaxed_pair(&self, i: usize, j: usize) -> Option<f64> {
        self.elements[i * self.count + j]
    }

    /// Degrees of freedom of the covariance.
    pub(crate) fn degrees_of_freedom(&self) -> f64 {
        self.degrees_of_freedom
    }

    /// Largest ratio of an uncertainty to that of independent residuals.
    pub(crate) fn inflation(&self) -> f64 {
        self.inflation
    }

    /// The noise behind it.
    pub(crate) fn noise_of_residuals(&self) -> &ResidualNoise {
        &self.noise
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_are_white_or_coloured_noise_or_structured() {
        // Residual (in units of the noise), autocorrelation time (samples): whether structured, whether coloured.
        let cases = [
            (1.0, 1.0, false, false),
            (1.0, 20.0, false, true),
            (3.3, 2.9994, false, true),
            (3.3, 3.1, true, false),
            (3.3, 20.0, true, false),
            (1.4, 2.9, false, false),
        ];
        for (residual, autocorrelation_time, is_structured, is_coloured) in cases {
            let structure =
                ResidualStructure { residual, noise: 1.0, rounding: 1e-9, autocorrelation_time, has_lines: false };
            assert_eq!(structure.is_structured(), is_structured, "{structure:?}");
            let warning = structure.coloured_noise(2.0);
            assert_eq!(warning.is_some(), is_coloured, "{structure:?}");
            let sentence = warning.map_or(String::new(), |warning| warning.to_string());
            assert_eq!(sentence.contains("3.3 times the noise"), residual > 3.0 && is_coloured, "{sentence}");
        }
        let exact = ResidualStructure {
            residual: 1e-10,
            noise: 1e-9,
            rounding: 1e-9,
            autocorrelation_time: 20.0,
            has_lines: false,
        };
        assert_eq!(exact.coloured_noise(1.0), None);
    }
}
