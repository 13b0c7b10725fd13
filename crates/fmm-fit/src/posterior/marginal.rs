//! Marginal posterior of one quantity.

use fmm_model::Parameter;

use crate::posterior::convergence::{Convergence, quantile};

/// The posterior of one quantity by itself: its draws, moments and intervals, and how well the chains know them.
///
/// | method | meaning | unit |
/// |---|---|---|
/// | [`mean`](Self::mean), [`standard_deviation`](Self::standard_deviation) | moments of the draws | of the quantity |
/// | [`interval`](Self::interval) | between quantiles, as much probability beyond each end | of the quantity |
/// | [`shortest_interval`](Self::shortest_interval) | the shortest that holds the probability | of the quantity |
/// | [`r_hat`](Self::r_hat) | spread of all chains over that within one; 1 if they agree | 1 |
/// | [`bulk_effective_size`](Self::bulk_effective_size), [`tail_effective_size`](Self::tail_effective_size) | independent draws that would say as much | 1 |
/// | [`error_of_mean`](Self::error_of_mean), [`error_of_deviation`](Self::error_of_deviation) | Monte Carlo standard errors | of the quantity |
///
/// ```
/// use fmm_fit::posterior::Marginal;
/// use fmm_model::Parameter;
///
/// // Two chains of four draws.
/// let draws = vec![1.0, 3.0, 2.0, 4.0, 2.0, 4.0, 1.0, 3.0];
/// let marginal = Marginal::new(Parameter::new("load", "N", "N"), draws, 2).expect("two chains of equal length");
/// assert_eq!(marginal.mean(), 2.5);
/// assert_eq!(marginal.interval(0.5), Some((1.75, 3.25)));
/// ```
///
/// # References
/// A. Vehtari et al., Bayesian Analysis 16 (2021) 667, <https://doi.org/10.1214/20-BA1221>.
#[derive(Debug, Clone, PartialEq)]
pub struct Marginal {
    parameter: Parameter,
    draws: Vec<f64>,
    sorted: Vec<f64>,
    mean: f64,
    deviation: f64,
    convergence: Convergence,
}

impl Marginal {
    /// The marginal of the `draws` of `chains` chains, one chain after the other, in the unit of the `parameter`.
    ///
    /// `None` unless all draws are finite and all chains have the same number of them, at least four.
    pub fn new(parameter: Parameter, draws: Vec<f64>, chains: usize) -> Option<Self> {
        let is_even = chains > 0 && draws.len().is_multiple_of(chains) && draws.len() / chains >= 4;
        if !is_even || draws.iter().any(|draw| !draw.is_finite()) {
            return None;
        }
        let mut sorted = draws.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let count = draws.len() as f64;
        let mean = draws.iter().sum::<f64>() / count;
        let variance = draws.iter().map(|draw| (draw - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let convergence = Convergence::of(&draws, chains, &sorted);
        Some(Self { parameter, draws, sorted, mean, deviation: variance.sqrt(), convergence })
    }

    /// Name, symbol and unit.
    pub fn parameter(&self) -> &Parameter {
        &self.parameter
    }

    /// The draws, one chain after the other, in the unit of the parameter.
    pub fn draws(&self) -> &[f64] {
        &self.draws
    }

    /// The mean, in the unit of the parameter.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The standard deviation, in the unit of the parameter.
    pub fn standard_deviation(&self) -> f64 {
        self.deviation
    }

    /// The value below which the share `level` of the draws lies, in the unit of the parameter; `None` for a level
    /// outside (0, 1).
    pub fn quantile(&self, level: f64) -> Option<f64> {
        (level > 0.0 && level < 1.0).then(|| quantile(&self.sorted, level))
    }

    /// The interval that holds the quantity with probability `level`, with (1 − `level`)/2 beyond either end, in the
    /// unit of the parameter; `None` for a level outside (0, 1).
    pub fn interval(&self, level: f64) -> Option<(f64, f64)> {
        let tail = 0.5 * (1.0 - level);
        Some((self.quantile(tail)?, self.quantile(1.0 - tail)?))
    }

    /// The shortest interval that holds the share `level` of the draws, in the unit of the parameter: that of highest
    /// density if there is one peak. `None` for a level outside (0, 1).
    pub fn shortest_interval(&self, level: f64) -> Option<(f64, f64)> {
        (level > 0.0 && level < 1.0).then(|| {
            let last = self.sorted.len() - 1;
            let reach = ((level * self.sorted.len() as f64).ceil() as usize).min(last);
            let width = |first: &usize| self.sorted[first + reach] - self.sorted[*first];
            let first = (0..=last - reach).min_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(0);
            (self.sorted[first], self.sorted[first + reach])
        })
    }

    /// R̂ (1), rank-normalised, split and folded: above 1.01 the chains do not agree yet.
    pub fn r_hat(&self) -> f64 {
        self.convergence.r_hat
    }

    /// Number of independent draws that would know the middle of the distribution as well (1).
    pub fn bulk_effective_size(&self) -> f64 {
        self.convergence.bulk
    }

    /// Number of independent draws that would know the 5 % and the 95 % quantile as well (1).
    pub fn tail_effective_size(&self) -> f64 {
        self.convergence.tail
    }

    /// Monte Carlo standard error of the mean, in the unit of the parameter.
    pub fn error_of_mean(&self) -> f64 {
        self.convergence.error_of_mean
    }

    /// Monte Carlo standard error of the standard deviation, in the unit of the parameter.
    pub fn error_of_deviation(&self) -> f64 {
        self.convergence.error_of_deviation
    }
}
