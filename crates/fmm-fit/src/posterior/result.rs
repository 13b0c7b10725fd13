//! Posterior of the parameters of a problem, as draws.

use fmm_model::{Bounds, Parameter};

use crate::error::FitError;
use crate::posterior::check::disagreements;
use crate::posterior::marginal::Marginal;
use crate::posterior::sampler::Chain;
use crate::posterior::warning::PosteriorWarning;
use crate::uncertainty::profile_interval::ResidualVariance;

/// R̂ above this says that the chains do not agree, and fewer effective draws than that make an interval uncertain
/// (Vehtari et al. 2021, section 4).
const LARGEST_R_HAT: f64 = 1.01;
const FEWEST_EFFECTIVE: f64 = 400.0;
/// Share of diverging trajectories that kinks of a residual and far starts make without harm.
const HARMLESS_DIVERGENCES: f64 = 1e-3;

/// The posterior of the parameters of a problem: draws by chains, with what they say about each parameter.
///
/// | method | meaning |
/// |---|---|
/// | [`marginal`](Self::marginal) | mean, standard deviation and intervals of one parameter or of the noise |
/// | [`derived`](Self::derived) | the same of anything that follows from the parameters |
/// | [`draws`](Self::draws), [`noise`](Self::noise) | the draws themselves |
/// | [`warnings`](Self::warnings) | reasons to distrust it |
///
/// The noise has two marginals beside those of the free parameters: `residual_standard_deviation`, in the unit of the
/// residuals, unless it was given, and `residual_correlation` of neighbours, if that was asked for.
///
/// `Display` gives the report.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    parameters: Vec<Parameter>,
    free: Vec<usize>,
    chains: usize,
    values: Vec<f64>,
    /// Standard deviation of a residual and correlation with its neighbour.
    noise: Vec<(f64, f64)>,
    marginals: Vec<Marginal>,
    divergences: usize,
    acceptance: f64,
    evaluations: usize,
    /// Moments that random walks without gradients find otherwise; `None` if no walk was asked for.
    disagreements: Option<Vec<PosteriorWarning>>,
}

impl Posterior {
    pub(super) fn new(
        parameters: &[Parameter],
        free: &[usize],
        chains: &[Chain],
        is_correlated: bool,
        variance: ResidualVariance,
    ) -> Result<Self, FitError> {
        let mut posterior = Self {
            parameters: parameters.to_vec(),
            free: free.to_vec(),
            chains: chains.len(),
            values: chains.iter().flat_map(|chain| chain.values.iter().copied()).collect(),
            noise: chains.iter().flat_map(|chain| chain.noise.iter()).map(|(v, rho)| (v.sqrt(), *rho)).collect(),
            marginals: Vec::new(),
            divergences: chains.iter().map(|chain| chain.run.divergences).sum(),
            acceptance: chains.iter().map(|chain| chain.run.acceptance).sum::<f64>() / chains.len() as f64,
            evaluations: chains.iter().map(|chain| chain.run.evaluations).sum(),
            disagreements: None,
        };
        let mut quantities: Vec<(Parameter, Vec<f64>)> =
            free.iter().map(|&j| (parameters[j].clone(), posterior.draws().map(|draw| draw[j]).collect())).collect();
        if variance == ResidualVariance::Estimated {
            let deviation = Parameter::new("residual_standard_deviation", "σ", "1").bounded(Bounds::NOT_NEGATIVE);
            quantities.push((deviation, posterior.noise.iter().map(|(deviation, _)| *deviation).collect()));
        }
        if is_correlated {
            let correlation = Parameter::new("residual_correlation", "ρ", "1");
            quantities.push((correlation, posterior.noise.iter().map(|(_, correlation)| *correlation).collect()));
        }
        for (parameter, draws) in quantities {
            let failed = || FitError::Sampler("a draw is no finite number".to_owned());
            posterior.marginals.push(Marginal::new(parameter, draws, chains.len()).ok_or_else(failed)?);
        }
        Ok(posterior)
    }

    /// Compares with random walks without gradients.
    pub(super) fn check(&mut self, walks: &[Vec<f64>]) {
        self.disagreements = Some(disagreements(self, walks));
    }

    /// All parameters of the problem, the fixed ones among them.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    pub(super) fn free(&self) -> &[usize] {
        &self.free
    }

    /// Number of chains.
    pub fn chains(&self) -> usize {
        self.chains
    }

    /// Number of draws of all chains together.
    pub fn len(&self) -> usize {
        self.noise.len()
    }

    /// True without draws, which never happens.
    pub fn is_empty(&self) -> bool {
        self.noise.is_empty()
    }

    /// The draws, one chain after the other: all parameters of the problem in their order, each in its unit.
    pub fn draws(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.values.chunks_exact(self.parameters.len().max(1))
    }

    /// For each draw the standard deviation of a residual (unit of the residuals), and its correlation with its
    /// neighbour (1).
    pub fn noise(&self) -> &[(f64, f64)] {
        &self.noise
    }

    /// The marginal posterior of each free parameter, then those of the noise.
    pub fn marginals(&self) -> &[Marginal] {
        &self.marginals
    }

    /// The marginal posterior of the parameter of this name; `None` for a name that is none, or that of a fixed
    /// parameter.
    pub fn marginal(&self, name: &str) -> Option<&Marginal> {
        self.marginals.iter().find(|marginal| marginal.parameter().name() == name)
    }

    /// The posterior of a quantity that follows from the values of all parameters; `None` if it is not finite for some
    /// draw.
    ///
    /// ```
    /// use fmm_fit::posterior::Sampler;
    /// use fmm_fit::{Options, Parameter, curve, solve};
    /// use fmm_fit::Scalar;
    ///
    /// let (t, x) = ([0.0, 1.0, 2.0, 3.0, 4.0, 5.0], [2.003, 1.211, 0.738, 0.442, 0.271, 0.166]);
    /// let decay = curve(&t, &x, ["amplitude", "rate"], |t, [a, b]| a * (-b * t).exp())?;
    /// let posterior = Sampler::default().sample(&decay, &solve(&decay, &[1.0, 0.1], &Options::default())?)?;
    /// let half_life = posterior.derived(Parameter::new("half_life", "t½", "s"), |p| 2f64.ln() / p[1]).expect("finite");
    /// assert!((half_life.mean() - 1.383).abs() < 0.002);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn derived(&self, parameter: Parameter, f: impl Fn(&[f64]) -> f64) -> Option<Marginal> {
        Marginal::new(parameter, self.draws().map(f).collect(), self.chains)
    }

    /// Number of diverged trajectories among those that count.
    pub fn divergences(&self) -> usize {
        self.divergences
    }

    /// Mean probability with which the points of a trajectory are accepted (1).
    pub fn acceptance(&self) -> f64 {
        self.acceptance
    }

    /// Evaluations of the density with its gradient, those before the draws that count left out.
    pub fn evaluations(&self) -> usize {
        self.evaluations
    }

    /// Moments that random walks without gradients find otherwise; `None` if no walk was asked for.
    pub(super) fn disagreements(&self) -> Option<&[PosteriorWarning]> {
        self.disagreements.as_deref()
    }

    /// Reasons to distrust this posterior; empty if there are none.
    pub fn warnings(&self) -> Vec<PosteriorWarning> {
        let mut warnings = Vec::new();
        let name = |marginal: &Marginal| marginal.parameter().name().to_owned();
        let worst = self.marginals.iter().max_by(|a, b| a.r_hat().total_cmp(&b.r_hat()));
        if let Some(marginal) = worst.filter(|marginal| !(marginal.r_hat() <= LARGEST_R_HAT)) {
            warnings.push(PosteriorWarning::ChainsDiffer { quantity: name(marginal), r_hat: marginal.r_hat() });
        }
        let effective = |marginal: &Marginal| marginal.bulk_effective_size().min(marginal.tail_effective_size());
        let fewest = self.marginals.iter().min_by(|a, b| effective(a).total_cmp(&effective(b)));
        if let Some(marginal) = fewest.filter(|marginal| !(effective(marginal) >= FEWEST_EFFECTIVE)) {
            let warning =
                PosteriorWarning::FewEffectiveDraws { quantity: name(marginal), effective: effective(marginal) };
            warnings.push(warning);
        }
        if self.divergences as f64 > HARMLESS_DIVERGENCES * self.len() as f64 {
            warnings.push(PosteriorWarning::Divergences { count: self.divergences, draws: self.len() });
        }
        warnings.extend(self.disagreements.iter().flatten().cloned());
        warnings
    }
}
