//! Consensus of results that are known differently well and may differ by more than that.

use fmm_model::Estimated;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::{Interval, UncertaintyError, coverage_factor};

/// How the variance between results is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum RandomEffects {
    /// The variance with which the weighted squares are what they should be, Q(τ²) = p − 1 (Mandel and Paule 1970).
    #[default]
    MandelPaule,
    /// From Q and the weights without it (DerSimonian and Laird 1986).
    DerSimonianLaird,
}

/// A result without the rest, or the rest without it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Influence {
    /// Its share of the weights (1).
    pub weight: f64,
    /// The consensus of the others; `None` if there is only one other.
    pub without: Option<Estimated>,
}

/// Consensus of results x with standard uncertainties u, each of which may have an effect of its own.
///
/// ```text
/// x_i = μ + b_i + e_i,     var b = τ²,  var e_i = u_i²
/// μ̂ = Σ w_i x_i/Σ w_i,     w_i = 1/(u_i² + τ²),     u(μ̂)² = max(1, q)/Σ w_i
/// q = Σ w_i (x_i − μ̂)²/(p − 1),     μ̂ ± t(p − 1) u(μ̂)
/// Q = q (p − 1) at τ = 0,     I² = max(0, 1 − (p − 1)/Q)
/// ```
///
/// The interval is that of Hartung and Knapp (2001), by Student's t instead of the normal distribution, which holds for few results; q below 1
/// does not narrow it, as with three or four results it may by chance.
///
/// ```
/// use fmm_model::Estimated;
/// use fmm_uq::{Consensus, RandomEffects};
///
/// let runs = [(0.112, 0.002), (0.118, 0.003), (0.125, 0.002), (0.109, 0.004)].map(|(mu, u)| Estimated::new(mu, u));
/// let found = Consensus::of(&runs, RandomEffects::MandelPaule)?;
/// // The runs differ by more than their uncertainties.
/// assert!(found.between() > 0.005 && found.p_value() < 0.01);
/// assert!(found.mean().uncertainty > 0.002);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
///
/// # References
/// - J. Mandel, R. C. Paule, Analytical Chemistry 42 (1970) 1194, <https://doi.org/10.1021/ac60293a019>.
/// - R. DerSimonian, N. Laird, Controlled Clinical Trials 7 (1986) 177, <https://doi.org/10.1016/0197-2456(86)90046-2>.
/// - J. Hartung, G. Knapp, Statistics in Medicine 20 (2001) 3875, <https://doi.org/10.1002/sim.1009>.
#[derive(Debug, Clone, PartialEq)]
pub struct Consensus {
    results: Vec<Estimated>,
    effects: RandomEffects,
    variance: f64,
    mean: f64,
    uncertainty: f64,
    homogeneity: f64,
}

/// Steps of the search for τ² at most; six are the rule.
const STEPS: usize = 200;

impl Consensus {
    /// The consensus of at least two results.
    ///
    /// # Errors
    /// [`UncertaintyError::TooFewObservations`]; [`UncertaintyError::OutOfRange`] if a result or its uncertainty is not finite, or an
    /// uncertainty is not positive.
    pub fn of(results: &[Estimated], effects: RandomEffects) -> Result<Self, UncertaintyError> {
        if results.len() < 2 {
            return Err(UncertaintyError::TooFewObservations { found: results.len(), needed: 2 });
        }
        for (index, result) in results.iter().enumerate() {
            if !result.value.is_finite() {
                return Err(UncertaintyError::observation_not_finite(index, result.value));
            }
            let square = result.uncertainty * result.uncertainty;
            if !(result.uncertainty > 0.0 && square.is_normal() && square.recip().is_normal()) {
                let name = format!("standard uncertainty of result {index}");
                return Err(UncertaintyError::out_of_range(
                    &name,
                    result.uncertainty,
                    "positive and finite, its square as well",
                ));
            }
        }
        let freedom = (results.len() - 1) as f64;
        let (_, homogeneity, _) = weighted(results, 0.0);
        let variance = match effects {
            RandomEffects::DerSimonianLaird => {
                let weights = || results.iter().map(|result| result.uncertainty.powi(-2));
                let (all, squares): (f64, f64) = (weights().sum(), weights().map(|weight| weight * weight).sum());
                (homogeneity - freedom) / (all - squares / all)
            }
            RandomEffects::MandelPaule => mandel_paule(results, freedom),
        };
        let variance = variance.max(0.0);
        let (mean, squares, weights) = weighted(results, variance);
        let uncertainty = ((squares / freedom).max(1.0) / weights).sqrt();
        if !(mean.is_finite() && uncertainty.is_finite()) {
            return Err(UncertaintyError::observation_not_finite(0, results[0].value));
        }
        Ok(Self { results: results.to_vec(), effects, variance, mean, uncertainty, homogeneity })
    }

    /// μ̂ with u(μ̂), whose degrees of freedom are p − 1 (unit of the results).
    pub fn mean(&self) -> Estimated {
        Estimated::new(self.mean, self.uncertainty)
    }

    /// p − 1 (1).
    pub fn degrees_of_freedom(&self) -> f64 {
        (self.results.len() - 1) as f64
    }

    /// τ, standard deviation between the results beyond their uncertainties (their unit).
    pub fn between(&self) -> f64 {
        self.variance.sqrt()
    }

    /// The interval that covers μ with probability `level` (unit of the results).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless 0 < level < 1.
    pub fn interval(&self, level: f64) -> Result<Interval, UncertaintyError> {
        let reach = self.uncertainty * coverage_factor(level, self.degrees_of_freedom())?;
        Ok(Interval { low: self.mean - reach, high: self.mean + reach, level })
    }

    /// The interval in which one more result that is known without noise would lie with probability `level` (unit of the results).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless 0 < level < 1.
    pub fn prediction(&self, level: f64) -> Result<Interval, UncertaintyError> {
        let reach = self.uncertainty.hypot(self.between()) * coverage_factor(level, self.degrees_of_freedom())?;
        Ok(Interval { low: self.mean - reach, high: self.mean + reach, level })
    }

    /// Q, Cochran's statistic of homogeneity (1).
    pub fn q(&self) -> f64 {
        self.homogeneity
    }

    /// Probability of a Q as large if the results differed by their uncertainties only (1).
    pub fn p_value(&self) -> f64 {
        ChiSquared::new(self.degrees_of_freedom()).map_or(1.0, |distribution| distribution.sf(self.homogeneity))
    }

    /// I², share of the squares that the uncertainties do not explain (1).
    pub fn i_squared(&self) -> f64 {
        if self.homogeneity > 0.0 { (1.0 - self.degrees_of_freedom() / self.homogeneity).max(0.0) } else { 0.0 }
    }

    /// What each result does to the consensus, in their order.
    pub fn influences(&self) -> Vec<Influence> {
        let weight = |result: &Estimated| (result.uncertainty * result.uncertainty + self.variance).recip();
        let all: f64 = self.results.iter().map(weight).sum();
        let influence = |(index, result): (usize, &Estimated)| {
            let mut others = self.results.clone();
            others.remove(index);
            let without = Self::of(&others, self.effects).ok().map(|consensus| consensus.mean());
            Influence { weight: weight(result) / all, without }
        };
        self.results.iter().enumerate().map(influence).collect()
    }
}

/// Weighted mean, Σ w (x − mean)² and Σ w with `variance` between the results.
fn weighted(results: &[Estimated], variance: f64) -> (f64, f64, f64) {
    let weight = |result: &Estimated| (result.uncertainty * result.uncertainty + variance).recip();
    let weights: f64 = results.iter().map(weight).sum();
    // About the first, so that a constant in all costs no digits.
    let first = results[0].value;
    let mean = results.iter().map(|result| weight(result) * (result.value - first)).sum::<f64>() / weights;
    let squares = results.iter().map(|result| weight(result) * (result.value - first - mean).powi(2)).sum();
    (first + mean, squares, weights)
}

/// τ² with Q(τ²) = `freedom`; 0 if Q is less without it. Q falls and is convex, so that Newton's steps from 0 do not pass the solution.
fn mandel_paule(results: &[Estimated], freedom: f64) -> f64 {
    let mut variance = 0.0;
    for _ in 0..STEPS {
        let (mean, squares, _) = weighted(results, variance);
        let slope: f64 = results
            .iter()
            .map(|result| ((result.value - mean) / (result.uncertainty * result.uncertainty + variance)).powi(2))
            .sum();
        let step = (squares - freedom) / slope;
        if !(step > 1e-15 * variance) {
            break;
        }
        variance += step;
    }
    variance
}
