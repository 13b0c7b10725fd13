//! Consensus of results that are known differently well and may differ by more than that.

use fmm_model::{Estimated, Interval, coverage_factor};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

use crate::error::UncertaintyError;

/// Estimator of the variance between results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum RandomEffects {
    /// The variance at which the weighted squares have their expectation, Q(τ²) = p − 1 (Mandel and Paule 1970).
    #[default]
    MandelPaule,
    /// Formula by Q and the weights without τ² (DerSimonian and Laird 1986).
    DerSimonianLaird,
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
/// The interval is that of Hartung and Knapp (2001): the spread of the results themselves widens it, and Student's t
/// takes the place of the normal distribution, so that it holds for few results. By chance q may be far below 1 with
/// three or four of them, which would make it narrower than the usual one; max(1, q) does not let it (Röver, Knapp and
/// Friede 2015). The price is an interval that covers more than it says where the results do not differ (τ = 0): 99 %
/// of six results and more of fewer, instead of 95 %.
///
/// An input that several results share, such as the mass of one machine, does not average out: see
/// [`Consensus::with_shared`].
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
/// - C. Röver, G. Knapp, T. Friede, BMC Medical Research Methodology 15 (2015) 99,
///   <https://doi.org/10.1186/s12874-015-0091-1>.
/// - J. P. T. Higgins, S. G. Thompson, Statistics in Medicine 21 (2002) 1539, <https://doi.org/10.1002/sim.1186> (I²).
#[derive(Debug, Clone, PartialEq)]
pub struct Consensus {
    results: Vec<Estimated>,
    effects: RandomEffects,
    variance: f64,
    mean: f64,
    uncertainty: f64,
    homogeneity: f64,
    /// Contributions of each shared input to the results.
    shared: Vec<Vec<f64>>,
}

/// Steps of the search for τ² at most; six are the rule. Each at least doubles a value that is small beside the
/// solution, and f64 has some 2100 doublings.
const STEPS: usize = 2200;

impl Consensus {
    /// The consensus of at least two results.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for fewer than two results, or if a result is not finite, or its uncertainty, or
    /// the square of it, is not positive and finite.
    pub fn of(results: &[Estimated], effects: RandomEffects) -> Result<Self, UncertaintyError> {
        if results.len() < 2 {
            return Err(UncertaintyError::too_few_observations(results.len(), 2));
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
            RandomEffects::DerSimonianLaird => (homogeneity - freedom) / weight_between(results),
            RandomEffects::MandelPaule => mandel_paule(results, freedom),
        };
        let variance = variance.max(0.0);
        let (mean, squares, weights) = weighted(results, variance);
        let uncertainty = ((squares / freedom).max(1.0) / weights).sqrt();
        if !(mean.is_finite() && uncertainty.is_finite()) {
            return Err(UncertaintyError::observation_not_finite(0, results[0].value));
        }
        Ok(Self { results: results.to_vec(), effects, variance, mean, uncertainty, homogeneity, shared: Vec::new() })
    }

    /// The same consensus of results that share inputs, such as the mass of one machine. Each input is a list of
    /// its contributions to the results, c_i = (∂x_i/∂input) u(input) with its sign, in the unit of the results; 0 for
    /// a result without it. The uncertainties u_i of the results must then be without those of the shared inputs.
    ///
    /// ```text
    /// u_s = |Σ w_i c_i|/Σ w_i     for each shared input s
    /// u² = u(μ̂)² + Σ_s u_s²,     ν = (p − 1) u⁴/u(μ̂)⁴,     μ̂ ± t(ν) u
    /// ```
    ///
    /// An input is one quantity, so its contributions add up with their signs before they are squared (JCGM 100:2008,
    /// 5.2.2, correlation 1), and more results do not make them smaller. They do not enter the weights or τ. The shared
    /// inputs are taken to be known with infinitely many degrees of freedom, which makes ν that of Welch and
    /// Satterthwaite (G.4.1).
    ///
    /// ```
    /// use fmm_model::Estimated;
    /// use fmm_uq::{Consensus, RandomEffects};
    ///
    /// // Six runs that each know their own to 0.3, under one load that makes 0.5 of each.
    /// let runs = [10.0; 6].map(|mu| Estimated::new(mu, 0.3));
    /// let found = Consensus::of(&runs, RandomEffects::MandelPaule)?.with_shared(&[vec![0.5; 6]])?;
    /// assert!((found.mean().uncertainty - (0.3_f64.powi(2) / 6.0 + 0.5_f64.powi(2)).sqrt()).abs() < 1e-14);
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an input with another number of contributions than results, or if a
    /// contribution, or the uncertainty with all of them, is not finite.
    pub fn with_shared(self, inputs: &[Vec<f64>]) -> Result<Self, UncertaintyError> {
        for (input, contributions) in inputs.iter().enumerate() {
            if contributions.len() != self.results.len() {
                let (found, results) = (contributions.len(), self.results.len());
                return Err(UncertaintyError::invalid(format!(
                    "a shared input contributes to each of the {results} results, by 0 where it has no part, but for \
                     input {input} there are {found} contributions"
                )));
            }
            if let Some(wrong) = contributions.iter().find(|contribution| !contribution.is_finite()) {
                let name = format!("contribution of shared input {input}");
                return Err(UncertaintyError::out_of_range(&name, *wrong, "finite"));
            }
        }
        let with_shared = Self { shared: inputs.to_vec(), ..self };
        for Estimated { uncertainty, .. } in [with_shared.mean(), with_shared.without_effects()] {
            if !uncertainty.is_finite() {
                return Err(UncertaintyError::out_of_range("uncertainty with shared inputs", uncertainty, "finite"));
            }
        }
        Ok(with_shared)
    }

    /// μ̂ with u, that of the shared inputs included (unit of the results).
    pub fn mean(&self) -> Estimated {
        Estimated::new(self.mean, self.uncertainty.hypot(self.shared_uncertainty()))
    }

    /// ν, the degrees of freedom of u (1): p − 1, and more where inputs are shared.
    pub fn degrees_of_freedom(&self) -> f64 {
        self.freedom() * (self.mean().uncertainty / self.uncertainty).powi(4)
    }

    /// p − 1.
    fn freedom(&self) -> f64 {
        (self.results.len() - 1) as f64
    }

    /// u_s of each shared input, in their order (unit of the results).
    pub fn shared(&self) -> Vec<f64> {
        self.shared_at(self.variance)
    }

    /// √Σ u_s², the part of the shared inputs in u (unit of the results).
    pub fn shared_uncertainty(&self) -> f64 {
        self.shared().into_iter().fold(0.0, f64::hypot)
    }

    /// u_s of each shared input in a mean with `variance` between the results.
    fn shared_at(&self, variance: f64) -> Vec<f64> {
        let shares = self.shares(variance);
        let of = |contributions: &Vec<f64>| {
            shares.iter().zip(contributions).map(|(share, contribution)| share * contribution).sum::<f64>().abs()
        };
        self.shared.iter().map(of).collect()
    }

    /// Shares of the weights with `variance` between the results.
    fn shares(&self, variance: f64) -> Vec<f64> {
        let weights = self.results.iter().map(|result| weight(result, variance));
        let all: f64 = weights.clone().sum();
        weights.map(|weight| weight / all).collect()
    }

    /// τ, standard deviation between the results beyond their uncertainties (their unit).
    pub fn between(&self) -> f64 {
        self.variance.sqrt()
    }

    /// The interval that covers μ with probability `level` (unit of the results).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless 0 < level < 1.
    pub fn interval(&self, level: f64) -> Result<Interval, UncertaintyError> {
        let factor = coverage_factor(level, self.degrees_of_freedom());
        let reach = self.mean().uncertainty * factor.ok_or_else(|| UncertaintyError::level(level))?;
        Ok(Interval { low: self.mean - reach, high: self.mean + reach, level })
    }

    /// The mean weighted by the uncertainties alone, 1/u², as if the results differed by no more, and its standard
    /// uncertainty by them and the shared inputs (unit of the results).
    ///
    /// It claims too little where they differ by more: of four results with τ = 2 and u near 0.4, its 95 % interval
    /// holds in 27 % of cases.
    pub fn without_effects(&self) -> Estimated {
        let (mean, _, weights) = weighted(&self.results, 0.0);
        Estimated::new(mean, self.shared_at(0.0).into_iter().fold(weights.sqrt().recip(), f64::hypot))
    }

    /// Q, Cochran's statistic of homogeneity (1).
    pub fn q(&self) -> f64 {
        self.homogeneity
    }

    /// Probability of a Q as large if the results differed by their uncertainties only (1).
    pub fn p_value(&self) -> f64 {
        ChiSquared::new(self.freedom()).map_or(1.0, |distribution| distribution.sf(self.homogeneity))
    }

    /// I², share of the squares that the uncertainties do not explain (1).
    pub fn i_squared(&self) -> f64 {
        if self.homogeneity > 0.0 { (1.0 - self.freedom() / self.homogeneity).max(0.0) } else { 0.0 }
    }

    /// The consensus of the other results, after the same method and with the same shared inputs.
    ///
    /// ```
    /// use fmm_model::Estimated;
    /// use fmm_uq::{Consensus, RandomEffects};
    ///
    /// let runs = [(10.1, 0.1), (10.2, 0.1), (10.0, 0.2), (12.0, 0.1)].map(|(mu, u)| Estimated::new(mu, u));
    /// let found = Consensus::of(&runs, RandomEffects::MandelPaule)?;
    /// let without_last = found.without(3)?;
    /// assert!(without_last.interval(0.95)?.high < 10.6 && found.interval(0.95)?.high > 12.0);
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] if there is no result `index`, counted from 0, or only one other.
    pub fn without(&self, index: usize) -> Result<Self, UncertaintyError> {
        if index >= self.results.len() {
            let results = self.results.len();
            let what = format!("there is no result {index}; {results} were given, counted from 0");
            return Err(UncertaintyError::invalid(what));
        }
        let mut others = self.results.clone();
        others.remove(index);
        let mut shared = self.shared.clone();
        for contributions in &mut shared {
            contributions.remove(index);
        }
        Self::of(&others, self.effects)?.with_shared(&shared)
    }

    /// Probability that one of the results lies as far from the consensus of the others as result `index` does, if all
    /// belonged together (1). A small one marks a result to be looked at, not one to be left out.
    ///
    /// ```text
    /// t = (x_i − μ̂₋ᵢ)/√(u_i² + τ₋ᵢ² + u(μ̂₋ᵢ)²),     p P(|t(p − 2)| > |t|)     for p results (Bonferroni)
    /// ```
    ///
    /// ```
    /// use fmm_model::Estimated;
    /// use fmm_uq::{Consensus, RandomEffects};
    ///
    /// let runs = [10.1, 10.2, 10.0, 10.1, 9.9, 11.1].map(|mu| Estimated::new(mu, 0.05));
    /// let found = Consensus::of(&runs, RandomEffects::MandelPaule)?;
    /// assert!(found.outlier_p_value(5)? < 0.02 && found.outlier_p_value(0)? > 0.5);
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`without`](Self::without), so that there must be three results.
    pub fn outlier_p_value(&self, index: usize) -> Result<f64, UncertaintyError> {
        let others = self.without(index)?;
        let Estimated { value, uncertainty } = self.results[index];
        let spread = uncertainty.hypot(others.between()).hypot(others.uncertainty);
        let distance = (value - others.mean).abs() / spread;
        let tail = StudentsT::new(0.0, 1.0, others.freedom()).map_or(0.5, |distribution| distribution.sf(distance));
        Ok((2.0 * tail * self.results.len() as f64).min(1.0))
    }

    /// Share of the weights that each result has (1), in their order.
    ///
    /// ```
    /// use fmm_model::Estimated;
    /// use fmm_uq::{Consensus, RandomEffects};
    ///
    /// let runs = [(10.1, 0.1), (10.2, 0.1), (10.0, 0.2), (12.0, 0.1)].map(|(mu, u)| Estimated::new(mu, u));
    /// let weights = Consensus::of(&runs, RandomEffects::MandelPaule)?.weights();
    /// // Where results differ by more than their uncertainties, all weigh nearly the same.
    /// assert!(weights.iter().all(|weight| (weight - 0.25).abs() < 0.01));
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    pub fn weights(&self) -> Vec<f64> {
        self.shares(self.variance)
    }
}

/// w with `variance` between the results.
fn weight(result: &Estimated, variance: f64) -> f64 {
    (result.uncertainty * result.uncertainty + variance).recip()
}

/// Weighted mean, Σ w (x − mean)² and Σ w with `variance` between the results.
fn weighted(results: &[Estimated], variance: f64) -> (f64, f64, f64) {
    let weight = |result: &Estimated| weight(result, variance);
    let weights: f64 = results.iter().map(weight).sum();
    let from =
        |origin: f64| results.iter().map(|result| weight(result) * (result.value - origin)).sum::<f64>() / weights;
    // About one of them, so that a constant in all costs no digits, and again about the result, as that one may be
    // far off.
    let first = results[0].value;
    let near = first + from(first);
    let mean = from(near);
    let squares = results.iter().map(|result| weight(result) * (result.value - near - mean).powi(2)).sum();
    (near + mean, squares, weights)
}

/// Σ w − Σ w²/Σ w = 2 Σ w_i (Σ_{j<i} w_j/Σ w), which is not lost where one weight is nearly all of them.
fn weight_between(results: &[Estimated]) -> f64 {
    let weights = || results.iter().map(|result| weight(result, 0.0));
    let (all, mut before): (f64, f64) = (weights().sum(), 0.0);
    let pairs = weights().map(|weight| {
        let pair = weight * (before / all);
        before += weight;
        pair
    });
    2.0 * pairs.sum::<f64>()
}

/// τ² with Q(τ²) = `freedom`; 0 if Q(0) is less already. Q falls and is convex, so that Newton's steps from 0 do not
/// pass the solution.
fn mandel_paule(results: &[Estimated], freedom: f64) -> f64 {
    let mut variance = 0.0;
    for _ in 0..STEPS {
        let (mean, squares, weights) = weighted(results, variance);
        // −dQ/dτ² = Σ w² (x − μ̂)², by shares of the weights, of which the squares may be beyond f64.
        let share = |result: &Estimated| {
            let weight = weight(result, variance);
            weight / weights * (weight * (result.value - mean).powi(2))
        };
        let step = (squares - freedom) / results.iter().map(share).sum::<f64>() / weights;
        if !(step > 1e-15 * variance) {
            break;
        }
        variance += step;
    }
    variance
}
