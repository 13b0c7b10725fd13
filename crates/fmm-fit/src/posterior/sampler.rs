//! Request for a posterior, and its run.

use fmm_model::Parameter;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution};

use crate::error::FitError;
use crate::posterior::check;
use crate::posterior::coordinates::Whitening;
use crate::posterior::mode::{no_start, whiten};
use crate::posterior::nuts::{self, Run};
use crate::posterior::prior::{Prior, outside_bounds, standard_normal};
use crate::posterior::result::Posterior;
use crate::posterior::target::Target;
use crate::problem::residuals::Residuals;
use crate::result::fit::Fit;
use crate::uncertainty::profile_interval::ResidualVariance;

/// Distance of the starts of chains from the mode, in standard deviations of the fit (1).
const OVERDISPERSION: f64 = 2.0;
/// Starts tried for a chain; every tenth failure halves their distance.
const TRIES: usize = 100;

/// A request for the posterior of the parameters of a problem: priors, noise, chains.
///
/// ```text
/// p(θ, σ, ρ | y) ∝ p(θ) p(ρ)/σ · σ⁻ⁿ exp(−Q/2σ²),      Q = Σ rᵢ²(θ) for independent residuals
/// ```
///
/// * **Noise**: residuals are normal with one standard deviation σ, of which nothing is known (Jeffreys' prior), and
///   which is integrated out; or of standard deviation 1, see [`with_variance`](Self::with_variance). Neighbours are
///   independent, or [correlated](Self::with_correlated_residuals).
/// * **Priors** are flat within the bounds of the parameters, unless [given](Self::with_prior).
/// * **Bounds** are met by coordinates without any: the logarithm of the distance from one bound, the logit between
///   two.
/// * **Chains** of the no-U-turn sampler begin about the fit, overdispersed, in coordinates in which the posterior is
///   nearly standard normal by the curvature at its mode. Gradients come from the Jacobian of the problem.
/// * **A check** by random-walk steps, which need no gradient, is compared with them: where a motion sticks or turns
///   back the residuals have kinks, at which a gradient says nothing.
///
/// The result is a function of problem, fit and seed, whatever the number of threads.
///
/// ```
/// use fmm_fit::posterior::{PosteriorWarning, Prior, Sampler};
/// use fmm_fit::{Options, curve, solve};
/// use fmm_fit::Scalar;
///
/// let (t, x) = ([0.0, 1.0, 2.0, 3.0, 4.0], [2.003, 1.211, 0.738, 0.442, 0.271]);
/// let decay = curve(&t, &x, ["amplitude", "rate"], |t, [a, b]| a * (-b * t).exp())?;
/// let fit = solve(&decay, &[1.0, 0.1], &Options::default())?;
/// let posterior = Sampler::default().with_prior("amplitude", Prior::normal(2.0, 0.1)?).sample(&decay, &fit)?;
///
/// let rate = posterior.marginal("rate").expect("a parameter");
/// // Three degrees of freedom: the deviation of Student's t is √3 times its scale.
/// let u = fit.estimate("rate").and_then(|rate| rate.standard_uncertainty()).expect("determined");
/// assert!((rate.mean() - 0.501).abs() < 0.001 && rate.standard_deviation() > u);
///
/// // Random walks without gradients find the same; otherwise a warning says in which moment they differ.
/// assert!(!posterior.warnings().iter().any(|warning| matches!(warning, PosteriorWarning::Disagrees { .. })));
/// println!("{posterior}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # References
/// A. Gelman et al., "Bayesian Data Analysis", 3rd ed., CRC (2013), ch. 12 and 14; H. Jeffreys, Proc. R. Soc. A 186
/// (1946) 453, <https://doi.org/10.1098/rspa.1946.0056>.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Sampler {
    chains: usize,
    warm_up: usize,
    draws: usize,
    seed: u64,
    priors: Vec<(String, Prior)>,
    variance: ResidualVariance,
    is_correlated: bool,
    check_steps: usize,
}

pub(super) fn too_few(what: &str, least: usize, given: usize) -> FitError {
    FitError::out_of_range(format!("at least {least} {what} are needed, but {given} are asked for"), given as f64)
}

impl Default for Sampler {
    fn default() -> Self {
        Self {
            chains: 4,
            warm_up: 300,
            draws: 1000,
            seed: 0,
            priors: Vec::new(),
            variance: ResidualVariance::Estimated,
            is_correlated: false,
            check_steps: 2000,
        }
    }
}

impl Sampler {
    /// The number of chains (4), at least two, or there is nothing to compare.
    #[must_use]
    pub fn with_chains(mut self, chains: usize) -> Self {
        self.chains = chains;
        self
    }

    /// The number of draws of each chain (1000), at least 100.
    #[must_use]
    pub fn with_draws(mut self, draws: usize) -> Self {
        self.draws = draws;
        self
    }

    /// The number of draws of each chain before those that count (300), at least 50, for the step and the scales.
    #[must_use]
    pub fn with_warm_up(mut self, warm_up: usize) -> Self {
        self.warm_up = warm_up;
        self
    }

    /// The seed of the random numbers (0).
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The seed of the random numbers.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// A prior for the parameter of this name; the last one given counts.
    #[must_use]
    pub fn with_prior(mut self, name: impl Into<String>, prior: Prior) -> Self {
        self.priors.push((name.into(), prior));
        self
    }

    /// The knowledge of the variance of the residuals: nothing, or that it is 1 or another number, which then counts as
    /// exact.
    #[must_use]
    pub fn with_variance(mut self, variance: ResidualVariance) -> Self {
        self.variance = variance;
        self
    }

    /// Let residuals be correlated with their neighbours of the same block, rᵢ = ρ rᵢ₋₁ + noise, with any ρ in (−1, 1)
    /// as likely.
    #[must_use]
    pub fn with_correlated_residuals(mut self) -> Self {
        self.is_correlated = true;
        self
    }

    /// The number of random-walk steps of each chain of the check (2000), half of them to forget the start; 0 for no
    /// check.
    #[must_use]
    pub fn with_check_steps(mut self, steps: usize) -> Self {
        self.check_steps = steps;
        self
    }

    /// The prior of the parameter of this name.
    pub(super) fn prior(&self, name: &str) -> Prior {
        self.priors.iter().rev().find(|(of, _)| of == name).map_or(Prior::FLAT, |(_, prior)| *prior)
    }

    /// Noise of which a record can be simulated.
    pub(super) fn require_known_noise(&self) -> Result<(), FitError> {
        if self.variance == ResidualVariance::Unit && !self.is_correlated {
            return Ok(());
        }
        Err(FitError::problem(
            "noise can be simulated only if it is known: divide the residuals by their standard deviation, and take \
             their variance as 1",
        ))
    }

    /// Draws from the posterior of `problem` about its `fit`, one chain after the other.
    ///
    /// # Errors
    /// [`FitError`] if the fit is that of another problem, if a prior names no free parameter, if there are too
    /// few chains or draws, or if there is no posterior: nothing determines a direction, or no residual is left.
    pub fn sample<P: Residuals + ?Sized>(&self, problem: &P, fit: &Fit) -> Result<Posterior, FitError> {
        let plan = self.plan(problem, fit)?;
        let chains = (0..self.chains).map(|chain| self.chain(&plan, chain)).collect::<Result<Vec<_>, _>>()?;
        let walk = plan.walk(&chains);
        let walks = (0..self.walks()).map(|chain| self.walk(&plan, &walk, chain)).collect::<Result<Vec<_>, _>>()?;
        self.posterior(&plan, &chains, &walks)
    }

    /// [`sample`](Self::sample) on all threads of the present rayon pool, with the same result.
    ///
    /// # Errors
    /// Those of [`sample`](Self::sample).
    #[cfg(feature = "rayon")]
    pub fn sample_parallel<P: Residuals + Sync + ?Sized>(&self, problem: &P, fit: &Fit) -> Result<Posterior, FitError> {
        use rayon::prelude::*;

        let plan = self.plan(problem, fit)?;
        let all = (0..self.chains).into_par_iter();
        let chains = all.map(|chain| self.chain(&plan, chain)).collect::<Result<Vec<_>, _>>()?;
        let walk = plan.walk(&chains);
        let all = (0..self.walks()).into_par_iter();
        let walks = all.map(|chain| self.walk(&plan, &walk, chain)).collect::<Result<Vec<_>, _>>()?;
        self.posterior(&plan, &chains, &walks)
    }

    /// Checks what is asked for, and finds the mode with the coordinates about it.
    fn plan<'a, P: Residuals + ?Sized>(&self, problem: &'a P, fit: &Fit) -> Result<Plan<'a, P>, FitError> {
        fit.require_of(problem)?;
        for (what, least, given) in
            [("chains", 2, self.chains), ("draws of a chain", 100, self.draws), ("warm-up draws", 50, self.warm_up)]
        {
            if given < least {
                return Err(too_few(what, least, given));
            }
        }
        let parameters = problem.parameters();
        let mut priors = vec![Prior::FLAT; parameters.len()];
        for (name, prior) in &self.priors {
            let index =
                parameters.iter().position(|parameter| parameter.name() == name && !parameter.bounds().is_fixed());
            let Some(index) = index else {
                let free = parameters.iter().filter(|parameter| !parameter.bounds().is_fixed());
                let known = free.map(Parameter::name).collect::<Vec<_>>().join(", ");
                return Err(FitError::unknown_name(format!(
                    "there is no free parameter called {name}; those of the problem are: {known}"
                )));
            };
            let (bounds, support) = (parameters[index].bounds(), prior.support());
            if bounds.at_least(support.lower()).at_most(support.upper()).is_empty() {
                return Err(outside_bounds(&parameters[index]));
            }
            priors[index] = *prior;
        }
        if fit.sum_of_squares() == 0.0 && self.variance == ResidualVariance::Estimated {
            return Err(FitError::undetermined(
                "the residuals of the fit are zero, so that there is no noise whose posterior could be found",
            ));
        }
        let mut target = Target::new(problem, fit.values(), &priors, self.variance, self.is_correlated)?;
        let whitening = whiten(&mut target, fit)?;
        Ok(Plan { target, whitening })
    }

    /// The random numbers of a chain; those of the check have other streams than those of the chains.
    fn stream(&self, stream: usize) -> ChaCha8Rng {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(stream as u64);
        random
    }

    /// One chain, and the noise of each of its draws.
    fn chain<P: Residuals + ?Sized>(&self, plan: &Plan<'_, P>, chain: usize) -> Result<Chain, FitError> {
        let mut random = self.stream(chain);
        let mut target = plan.target.clone();
        let (start, _) = plan.start(&mut target, &mut random)?;
        let run = nuts::run(target, &plan.whitening, &start, (self.warm_up, self.draws), &mut random)?;
        let mut target = plan.target.clone();
        let mut chain = Chain { noise: Vec::with_capacity(self.draws), values: Vec::new(), run };
        let mut psi = Vec::new();
        for z in chain.run.positions.chunks_exact(plan.whitening.order()) {
            plan.whitening.coordinates(z, &mut psi);
            target.log_density(&psi).ok_or_else(|| no_start(&target))?;
            let (square, correlation) = target.square_and_correlation(&psi);
            let variance = match self.variance {
                ResidualVariance::Unit => 1.0,
                ResidualVariance::Effective { variance, .. } => variance,
                ResidualVariance::Estimated => {
                    let freedom = target.residual_count() as f64;
                    let chi_squared = ChiSquared::new(freedom).map_err(|error| FitError::Sampler(error.to_string()))?;
                    square / chi_squared.sample(&mut random)
                }
            };
            chain.values.extend_from_slice(target.values());
            chain.noise.push((variance / (1.0 - correlation * correlation), correlation));
        }
        Ok(chain)
    }

    fn walks(&self) -> usize {
        if self.check_steps == 0 { 0 } else { self.chains }
    }

    fn walk<P: Residuals + ?Sized>(
        &self,
        plan: &Plan<'_, P>,
        walk: &check::Walk,
        chain: usize,
    ) -> Result<Vec<f64>, FitError> {
        let mut random = self.stream(self.chains + chain);
        let mut target = plan.target.clone();
        let start = plan.start(&mut target, &mut random)?;
        Ok(walk.run(&mut target, &plan.whitening, start, self.check_steps, &mut random))
    }

    fn posterior<P: Residuals + ?Sized>(
        &self,
        plan: &Plan<'_, P>,
        chains: &[Chain],
        walks: &[Vec<f64>],
    ) -> Result<Posterior, FitError> {
        let (parameters, free) = (plan.target.parameters(), plan.target.free());
        let mut posterior = Posterior::new(parameters, free, chains, self.is_correlated, self.variance)?;
        if !walks.is_empty() {
            posterior.check(walks);
        }
        Ok(posterior)
    }
}

/// The posterior over coordinates about its mode.
struct Plan<'a, P: ?Sized> {
    target: Target<'a, P>,
    whitening: Whitening,
}

impl<P: Residuals + ?Sized> Plan<'_, P> {
    /// A start away from the mode, where the posterior has a density, which is given too.
    fn start(&self, target: &mut Target<'_, P>, random: &mut ChaCha8Rng) -> Result<(Vec<f64>, f64), FitError> {
        let (mut psi, mut gradient) = (Vec::new(), vec![0.0; self.whitening.order()]);
        for attempt in 0..TRIES {
            let reach = OVERDISPERSION * 0.5f64.powf((attempt / 10) as f64);
            let z: Vec<f64> = gradient.iter().map(|_| reach * standard_normal(random)).collect();
            self.whitening.coordinates(&z, &mut psi);
            if let Some(density) = target.log_density_and_gradient(&psi, &mut gradient) {
                return Ok((z, density));
            }
        }
        Err(no_start(target))
    }

    /// Steps of the size that the chains found.
    fn walk(&self, chains: &[Chain]) -> check::Walk {
        let positions: Vec<&[f64]> = chains.iter().map(|chain| chain.run.positions.as_slice()).collect();
        check::Walk::of(&positions.concat(), self.whitening.order())
    }
}

/// The draws of one chain.
#[derive(Debug)]
pub(super) struct Chain {
    pub(super) run: Run,
    /// All parameters of each draw, one draw after the other.
    pub(super) values: Vec<f64>,
    /// Variance of a residual and correlation with its neighbour, of each draw.
    pub(super) noise: Vec<(f64, f64)>,
}
