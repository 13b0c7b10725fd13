//! Simulation-based calibration of a posterior.

use std::fmt;

use fmm_model::Parameter;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::error::FitError;
use crate::fitting::solve::solve;
use crate::posterior::result::Posterior;
use crate::posterior::sampler::{Sampler, too_few};
use crate::problem::residuals::{EvaluationError, Residuals};
use crate::solver::options::Options;

/// Draws of each posterior among which the truth has its rank; with the truth they fill the bins evenly.
const DRAWS: usize = 99;
const BINS: usize = 20;
/// Below five records a bin the χ² distribution is no good approximation.
const FEWEST_RECORDS: usize = 5 * BINS;

/// The ranks of true values among the draws of their posteriors, over many simulated records.
///
/// ```text
/// θ ~ prior,   record ~ p(y | θ),   θ₁ … θ_L ~ p(θ | y):     the number of θᵢ below θ is uniform on 0 … L
/// ```
///
/// Anything else says that sampler, derivatives or noise are not those of the simulation: ranks at both ends that the
/// posterior is too narrow, in the middle that it is too wide, at one end that it is biased. The test is χ² with 19
/// degrees of freedom.
///
/// It is a tool for a law of one's own: simulate records with it, and see whether its posterior is right.
///
/// ```
/// use fmm_fit::posterior::{Calibration, Prior, Sampler};
/// use fmm_fit::{Automatic, Bounds, EvaluationError, Model, Parameter, ResidualVariance, Scalar, Weighted};
/// use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
/// use rand_distr::{Distribution, Normal};
///
/// /// A decay at five times.
/// struct Decay {
///     data: [f64; 5],
///     parameters: [Parameter; 2],
/// }
///
/// fn decay<S: Scalar>(p: &[S], t: f64) -> S {
///     p[0] * (-p[1] * t).exp()
/// }
///
/// impl Model for Decay {
///     fn parameters(&self) -> &[Parameter] {
///         &self.parameters
///     }
///     fn len(&self) -> usize {
///         5
///     }
///     fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
///         for (i, (r, data)) in residuals.iter_mut().zip(self.data).enumerate() {
///             *r = decay(p, i as f64) - data;
///         }
///         Ok(())
///     }
/// }
///
/// let noise = Normal::new(0.0, 0.02)?;
/// let parameters = ["amplitude", "rate"].map(|name| Parameter::from(name).bounded(Bounds::NOT_NEGATIVE));
/// let sampler = Sampler::default()
///     .with_prior("amplitude", Prior::normal(2.0, 0.2)?)
///     .with_prior("rate", Prior::log_normal(0.5, 0.2)?)
///     .with_variance(ResidualVariance::Unit)
///     .with_draws(100)
///     .with_check_steps(0);
/// let calibration = Calibration::of(&sampler, &parameters, 100, |p, seed| {
///     let mut random = ChaCha8Rng::seed_from_u64(seed);
///     let data = [0.0, 1.0, 2.0, 3.0, 4.0].map(|t| decay(p, t) + noise.sample(&mut random));
///     Ok(Weighted::new(Automatic::<_, 2>::new(Decay { data, parameters: parameters.clone() }), vec![0.02; 5])?)
/// })?;
/// assert!(calibration.p_value("rate").expect("a parameter") > 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # References
/// S. Talts, M. Betancourt, D. Simpson, A. Vehtari, A. Gelman, "Validating Bayesian inference algorithms with
/// simulation-based calibration", <https://arxiv.org/abs/1804.06788>.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    parameters: Vec<Parameter>,
    /// Ranks of each parameter, one per record.
    ranks: Vec<Vec<usize>>,
    failures: Vec<String>,
}

impl Calibration {
    /// Calibrates the posterior by `sampler` of as many `records` as `simulate` makes of true values of the
    /// `parameters` and a seed: a problem with those parameters whose residuals have the standard deviation 1.
    ///
    /// True values are drawn from the priors of the sampler. The result is a function of its seed.
    ///
    /// # Errors
    /// [`FitError`] below a hundred records, for a parameter whose prior is
    /// flat without two bounds, or a sampler that does not take the variance of the residuals as 1. Records without a
    /// posterior are counted as [failures](Self::failures).
    pub fn of<P: Residuals>(
        sampler: &Sampler,
        parameters: &[Parameter],
        records: usize,
        mut simulate: impl FnMut(&[f64], u64) -> Result<P, EvaluationError>,
    ) -> Result<Self, FitError> {
        if records < FEWEST_RECORDS {
            return Err(too_few("records", FEWEST_RECORDS, records));
        }
        sampler.require_known_noise()?;
        let free: Vec<usize> = (0..parameters.len()).filter(|&j| !parameters[j].bounds().is_fixed()).collect();
        let mut calibration = Self {
            parameters: free.iter().map(|&j| parameters[j].clone()).collect(),
            ranks: vec![Vec::with_capacity(records); free.len()],
            failures: Vec::new(),
        };
        let mut random = ChaCha8Rng::seed_from_u64(sampler.seed());
        // The last stream but one: chains count up from the first.
        random.set_stream(u64::MAX - 1);
        for _ in 0..records {
            let draw = |parameter: &Parameter| sampler.prior(parameter.name()).draw(parameter, &mut random);
            let truth = parameters.iter().map(draw).collect::<Result<Vec<f64>, _>>()?;
            let seed = random.random::<u64>();
            let posterior = simulate(&truth, seed).map_err(|error| error.to_string()).and_then(|problem| {
                let fit = solve(&problem, &truth, &Options::default()).map_err(|error| error.to_string())?;
                sampler.clone().with_seed(seed).sample(&problem, &fit).map_err(|error| error.to_string())
            });
            match posterior {
                Ok(posterior) => calibration.take(&posterior, &free, &truth),
                Err(error) => calibration.failures.push(error),
            }
        }
        Ok(calibration)
    }

    fn take(&mut self, posterior: &Posterior, free: &[usize], truth: &[f64]) {
        for (ranks, &j) in self.ranks.iter_mut().zip(free) {
            let draws: Vec<f64> = posterior.draws().map(|draw| draw[j]).collect();
            let kept = (0..DRAWS).map(|i| draws[i * draws.len() / DRAWS]);
            ranks.push(kept.filter(|draw| *draw < truth[j]).count());
        }
    }

    fn ranks_of(&self, name: &str) -> Option<&[usize]> {
        let place = self.parameters.iter().position(|parameter| parameter.name() == name)?;
        Some(&self.ranks[place])
    }

    /// The number of records whose true value of the parameter of this name has a rank in each of twenty equal bins;
    /// `None` for the name of none.
    pub fn histogram(&self, name: &str) -> Option<Vec<usize>> {
        let mut counts = vec![0; BINS];
        self.ranks_of(name)?.iter().for_each(|rank| counts[rank * BINS / (DRAWS + 1)] += 1);
        Some(counts)
    }

    /// Probability that uniform ranks are as uneven as those of the parameter of this name (1), by the χ² test; `None`
    /// for the name of none, or without a record.
    pub fn p_value(&self, name: &str) -> Option<f64> {
        let counts = self.histogram(name)?;
        let expected = counts.iter().sum::<usize>() as f64 / BINS as f64;
        let square: f64 = counts.iter().map(|count| (*count as f64 - expected).powi(2) / expected).sum();
        square.is_finite().then(|| ChiSquared::new((BINS - 1) as f64).map(|chi| chi.sf(square)).ok()).flatten()
    }

    /// The parameters whose ranks were counted.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The failure of each record that has no posterior.
    pub fn failures(&self) -> &[String] {
        &self.failures
    }
}

impl fmt::Display for Calibration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let records = self.ranks.first().map_or(0, Vec::len);
        writeln!(f, "[[calibration]] {records} records, {} failed", self.failures.len())?;
        let width = self.parameters.iter().map(|parameter| parameter.name().chars().count()).max().unwrap_or(0);
        for parameter in &self.parameters {
            let (name, counts) = (parameter.name(), self.histogram(parameter.name()).unwrap_or_default());
            let p = self.p_value(name).unwrap_or(f64::NAN);
            let verdict = if p < 0.01 { "not uniform" } else { "uniform" };
            writeln!(f, "  {name:<width$} ranks {verdict}, p = {p:.3}, {counts:?}")?;
        }
        Ok(())
    }
}
