//! Structure of the residuals, and the covariance of the estimates with or without it.

use fmm_fit::{EvaluationError, Fit, autocorrelation_time};

use crate::experiment::force::{ForceRecord, deviation};
use crate::experiment::{Experiments, scaled};
use crate::finding::Source;
use crate::linear_algebra::{inverse_of_products, root_of_covariance};
use crate::problem::Problem;
use crate::residuals::knowledge::Knowledge;
use crate::residuals::noise::{ResidualNoise, Series};
use crate::residuals::rules::{CORRELATION_TIME, EXCESS, LEAST_DEGREES_OF_FREEDOM, ROUNDING_OF_RECORD};
use crate::warning::Warning;

/// Residuals of a fit beside the noise of the records.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ResidualStructure {
    /// Root mean square of the residuals, in the unit of the records.
    pub(crate) residual: f64,
    /// Standard deviation of the part that no model fits, in the same unit: white noise and rounding.
    pub(crate) noise: f64,
    /// Rounding of doubles in a record without noise, in the same unit.
    rounding: f64,
    /// τ (samples).
    pub(crate) autocorrelation_time: f64,
    /// Lines of spectra are among the residuals, which do not follow each other in time.
    has_lines: bool,
}

impl ResidualStructure {
    pub(crate) fn of<'a>(fit: &Fit, experiments: impl Into<Experiments<'a>>) -> Self {
        let decays = match experiments.into() {
            Experiments::Vibrations(decays) => decays,
            Experiments::Forces(records) => {
                let noise = records.iter().map(ForceRecord::noise).fold(0.0, f64::max);
                return Self::beside(fit, noise, ROUNDING_OF_RECORD * deviation(records));
            }
        };
        let rounding = scaled(decays)
            .map(|(decay, weight)| ROUNDING_OF_RECORD * weight * decay.summary().amplitudes.0)
            .fold(0.0, f64::max);
        // A converter step counts as the noise of its rounding.
        let noise = scaled(decays).map(|(decay, weight)| weight * decay.white_noise()).fold(rounding, f64::max);
        let has_lines = decays.iter().any(|decay| decay.lines().is_some());
        Self { has_lines, ..Self::beside(fit, noise, rounding) }
    }

    /// The structure of a fit to series with this `noise` and `rounding`, in the unit of the residuals.
    fn beside(fit: &Fit, noise: f64, rounding: f64) -> Self {
        let residual = (fit.sum_of_squares() / fit.residuals().len() as f64).sqrt();
        let autocorrelation_time = autocorrelation_time(fit.residuals()).unwrap_or(1.0);
        Self { residual, noise: noise.max(rounding), rounding, autocorrelation_time, has_lines: false }
    }

    /// True if more is left than the rounding of doubles.
    pub(crate) fn is_noisy(&self) -> bool {
        self.residual > self.rounding
    }

    /// Neighbouring residuals are alike: the law misses something, or the noise is not white.
    pub(crate) fn is_correlated(&self) -> bool {
        self.is_noisy() && self.autocorrelation_time > CORRELATION_TIME
    }

    /// The law misses something that the record shows.
    pub(crate) fn is_structured(&self) -> bool {
        self.is_excessive() && (self.is_correlated() || self.has_lines)
    }

    /// Warning about noise that is not white, for the largest `inflation` of a standard uncertainty; `None` where the
    /// law misses something or the noise is white.
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
/// V = U M U,     U = (JᵀJ)⁻¹,   M = JᵀΣJ                                                                      (1)
/// ν_i = min(n/κ_i, 2 N_i) − rank,     κ_i = V_ii/(s² U_ii)                                                     (2)
/// ```
///
/// For white noise of one variance (1) is the covariance of the [`Fit`], and ν is n less the rank. Otherwise each
/// estimate has degrees of freedom of its own: n/κ independent residuals have its variance, and the variance of the
/// noise along its influence, row i of U Jᵀ, rests on N_i ordinates of the periodogram, each with two degrees of
/// freedom. Neither (1) nor (2) depends on the units of records and parameters.
///
/// A parameter that ended on its bound counts as free, so that the uncertainties of the others include its influence.
#[derive(Debug, Clone)]
pub(crate) struct Covariance {
    count: usize,
    elements: Vec<Option<f64>>,
    /// The fit knows the parameter: it is determined, and not on a bound.
    is_inside: Vec<bool>,
    /// ν of each estimate (1).
    degrees_of_freedom: Vec<f64>,
    /// Independent residuals with the variances of the estimates, on average over these (1).
    pub(crate) effective_count: f64,
    /// Largest ratio of an uncertainty to that of independent residuals (1).
    pub(crate) inflation: f64,
    /// Noise that the residuals show.
    pub(crate) noise: ResidualNoise,
    is_white: bool,
    pub(crate) knowledge: Knowledge,
}

impl Covariance {
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit, structure: &ResidualStructure) -> Result<Self, EvaluationError> {
        let columns = problem.columns(fit.values(), &Self::known(fit))?;
        let noise = Self::noise(problem, fit, structure, &columns, &inverse_of_products(&columns));
        Ok(Self::of_noise(fit, structure, &columns, noise).with_knowledge(problem, fit))
    }

    /// Adds prior knowledge: the elements hold the part by the residuals of the records, and the share of the
    /// knowledge.
    fn with_knowledge(mut self, problem: &Problem<'_>, fit: &Fit) -> Self {
        let variance = fit.residual_standard_deviation().map_or(0.0, |s| s * s).max(f64::MIN_POSITIVE);
        let unit = |i: usize, j: usize| Self::of_white_noise(fit, i, j).map_or(0.0, |covariance| covariance / variance);
        let knowledge = Knowledge::of(&problem.prior, problem.noise, fit, unit);
        if !knowledge.is_empty() {
            // White residuals of the knowledge are among those of the fit; the noise of the records has none.
            let counted = if self.is_white { variance / problem.noise.powi(2) } else { 0.0 };
            for (at, element) in self.elements.iter_mut().enumerate() {
                let share = knowledge.pair(at / self.count, at % self.count);
                *element = element.map(|element| element + share * (1.0 - counted));
            }
        }
        self.knowledge = knowledge;
        self
    }

    /// Share of prior knowledge in the variance of a quantity with this `gradient` over the first estimates, by source.
    pub(crate) fn of_knowledge(&self, gradient: &[f64]) -> Vec<(Source, f64)> {
        self.knowledge.parts(gradient)
    }

    /// The parameters of a fit that have a variance.
    pub(crate) fn known(fit: &Fit) -> Vec<usize> {
        let has_variance = |i: &usize| Self::of_white_noise(fit, *i, *i).is_some();
        (0..fit.values().len()).filter(has_variance).collect()
    }

    fn of_white_noise(fit: &Fit, i: usize, j: usize) -> Option<f64> {
        fit.relaxed_covariance(i, j).or_else(|| fit.covariance(i, j))
    }

    /// The covariance of a `fit` whose residuals show this `noise`; `columns` are the derivatives by the
    /// [`known`](Self::known) parameters.
    pub(crate) fn of_noise(
        fit: &Fit,
        structure: &ResidualStructure,
        columns: &[Vec<f64>],
        noise: ResidualNoise,
    ) -> Self {
        let count = fit.values().len();
        let independent = fit.degrees_of_freedom() as f64;
        let mut covariance = Self {
            count,
            elements: (0..count * count).map(|at| Self::of_white_noise(fit, at / count, at % count)).collect(),
            is_inside: fit.estimates().iter().map(|estimate| estimate.standard_uncertainty().is_some()).collect(),
            degrees_of_freedom: vec![independent; count],
            effective_count: independent + fit.rank() as f64,
            inflation: 1.0,
            noise,
            is_white: true,
            knowledge: Knowledge::default(),
        };
        let known = Self::known(fit);
        if structure.is_noisy() && !covariance.noise.is_white() && !known.is_empty() {
            covariance.take_noise(fit, &known, columns);
        }
        covariance
    }

    /// Puts the noise of the residuals in the place of white noise, by (1) and (2).
    fn take_noise(&mut self, fit: &Fit, known: &[usize], columns: &[Vec<f64>]) {
        self.is_white = false;
        let (order, rank) = (known.len(), fit.rank() as f64);
        let variance = fit.residual_standard_deviation().map_or(0.0, |s| s * s).max(f64::MIN_POSITIVE);
        let pairs = known.iter().flat_map(|i| known.iter().map(move |j| (*i, *j)));
        let unit: Vec<f64> =
            pairs.clone().map(|(i, j)| self.elements[i * self.count + j].unwrap_or(0.0) / variance).collect();
        // U JᵀΣJ U = L (Zᵀ Σ Z) Lᵀ with U = L Lᵀ and the orthonormal columns Z = J L: no variance is a difference.
        let root = root_of_covariance(&unit, order);
        let transposed: Vec<f64> = (0..order * order).map(|at| root[at % order * order + at / order]).collect();
        let directions: Vec<Vec<f64>> = transposed.chunks(order).map(|row| influence(row, columns)).collect();
        let sandwich = product(&product(&root, &self.noise.products(&directions), order), &transposed, order);
        let mut counts = Vec::with_capacity(order);
        for (place, &i) in known.iter().enumerate() {
            let white = self.elements[i * (self.count + 1)].unwrap_or(f64::INFINITY);
            let ratio = sandwich[place * (order + 1)] / white;
            let count = self.effective_count_of(fit, ratio, &influence(&unit[place * order..][..order], columns));
            self.degrees_of_freedom[i] =
                (count - rank).max(LEAST_DEGREES_OF_FREEDOM).min(fit.degrees_of_freedom() as f64);
            self.inflation = self.inflation.max(ratio.sqrt());
            counts.push(self.degrees_of_freedom[i] + rank);
        }
        self.effective_count = order as f64 / counts.iter().map(|count| count.recip()).sum::<f64>();
        for ((i, j), element) in pairs.zip(sandwich) {
            self.elements[i * self.count + j] = Some(element);
        }
    }

    /// Independent residuals that an estimate rests on, whose variance is `ratio` times that by white noise.
    fn effective_count_of(&self, fit: &Fit, ratio: f64, influence: &[f64]) -> f64 {
        let by_variance = fit.residuals().len() as f64 / ratio.max(1.0);
        by_variance.min(2.0 * self.noise.ordinates_along(influence))
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
            .map(|(record, rows)| match problem.forces() {
                Some(forces) => {
                    let period = forces.records()[record].period();
                    Series { rows, signal: None, period, columns, weights, plateaus: Vec::new() }
                }
                None => Series {
                    rows,
                    signal: structure.is_noisy().then_some(signals[record].as_slice()),
                    period: problem.experiments()[record].record().rate()
                        / problem.experiments()[record].guess.frequency(),
                    columns,
                    weights,
                    plateaus: problem.experiments()[record].stays(),
                },
            })
            .collect();
        ResidualNoise::of(fit.residuals(), &series)
    }

    /// This covariance with all variances `factor` times as large.
    pub(crate) fn times(mut self, factor: f64) -> Self {
        self.elements.iter_mut().flatten().for_each(|element| *element *= factor);
        self
    }

    /// Covariance of parameters `i` and `j`; `None` for those that the record does not determine, or on a bound.
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

    /// ν of the estimate at place `i` (1).
    pub(crate) fn degrees_of_freedom(&self, i: usize) -> f64 {
        self.degrees_of_freedom[i]
    }

    /// ν of a quantity with this `gradient` by the parameters (1): the harmonic mean over the estimates that it follows
    /// from, each weighted by its part of the variance.
    pub(crate) fn degrees_of_freedom_along(&self, gradient: &[f64]) -> f64 {
        let part = |(i, slope): (usize, &f64)| Some((self.degrees_of_freedom[i], slope * slope * self.relaxed(i)?));
        let parts = || gradient.iter().enumerate().filter_map(part).filter(|(_, part)| *part > 0.0);
        let Some((first, _)) = parts().next() else { return f64::INFINITY };
        if parts().all(|(freedom, _)| freedom == first) {
            return first;
        }
        let whole: f64 = parts().map(|(_, part)| part).sum();
        parts().map(|(freedom, part)| part / whole / freedom).sum::<f64>().recip()
    }
}

/// Product of two square matrices of this `order`, row by row.
fn product(a: &[f64], b: &[f64], order: usize) -> Vec<f64> {
    let element = |at: usize| (0..order).map(|k| a[at / order * order + k] * b[k * order + at % order]).sum();
    (0..order * order).map(element).collect()
}

/// Row of U Jᵀ: the change of an estimate by each residual, from its row of U.
fn influence(row: &[f64], columns: &[Vec<f64>]) -> Vec<f64> {
    let mut influence = vec![0.0; columns[0].len()];
    for (weight, column) in row.iter().zip(columns) {
        influence.iter_mut().zip(column).for_each(|(sum, derivative)| *sum += weight * derivative);
    }
    influence
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
