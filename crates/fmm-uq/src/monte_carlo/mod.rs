//! Propagation of distributions by a Monte Carlo method.

mod adaptive;
mod block;
mod order_statistics;
mod output_sample;
mod partial_run;
mod pool;
mod refusal;
mod region;
mod run;
mod sampler;
mod sensitivity;
mod sequences;
mod settling;
mod statement;

pub use adaptive::{Adaptive, IntervalKind};
pub use output_sample::OutputSample;
pub use partial_run::PartialRun;
pub use sensitivity::VarianceShare;
pub use statement::TrialStatement;

use std::ops::{ControlFlow, Range};

use crate::error::UncertaintyError;
use crate::inputs::Inputs;
use crate::monte_carlo::block::{BLOCK_TRIALS, Block};
use crate::monte_carlo::refusal::{AllowedFailures, HeavyTail};
use crate::monte_carlo::run::Plan;
use crate::monte_carlo::sampler::Sampler;

/// A run of JCGM 101:2008 (one output) or JCGM 102:2011 (several): the distributions of the inputs propagated through
/// the model by random trials.
///
/// Trials come in blocks of 1000. A block is drawn from a stream of its own of the ChaCha8 generator, with the
/// seed as the key and the index of the block as the stream; blocks are put together by index. So the bits of a result
/// depend on seed, inputs, model and number of trials, and on nothing else: not on the number of threads (feature
/// `rayon`, in the current pool), nor on how blocks are spread over machines
/// ([`MonteCarlo::run_blocks`], [`PartialRun`]).
///
/// A trial fails if the model gives back an error or a number that is not finite. By default a single failure is an
/// error: results without the failed trials are conditional on success, and that must be asked for
/// ([`MonteCarlo::with_allowed_failures`]).
///
/// ```
/// use fmm_uq::{Distribution, Input, Inputs, MonteCarlo};
///
/// // The sum of four rectangular quantities (JCGM 101:2008, 9.2.3).
/// let half = 3f64.sqrt();
/// let quantity = |name| Input::of(name, Distribution::rectangular(-half, half)?, "1");
/// let inputs = Inputs::new([quantity("X1")?, quantity("X2")?, quantity("X3")?, quantity("X4")?])?;
/// let sum = MonteCarlo::new(&inputs, 200_000)?.run(|x| x[0] + x[1] + x[2] + x[3])?;
/// let interval = sum.symmetric_interval(0, 0.95)?;
/// // Ends at ±3.8794, with a standard error of 0.011 here; the GUM has ±3.92.
/// assert!((interval.high - 3.8794).abs() < 0.055 && (interval.low + 3.8794).abs() < 0.055);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Clone)]
pub struct MonteCarlo<'a> {
    pub(crate) sampler: Sampler,
    pub(crate) heavy_tail: Option<HeavyTail>,
    pub(crate) fingerprint: u64,
    pub(crate) seed: u64,
    pub(crate) plan: Plan,
    pub(crate) allowed_failures: AllowedFailures,
    pub(crate) watch: Option<&'a Watch<'a>>,
}

/// Observer of the progress of a run, which may end it.
type Watch<'a> = dyn Fn(Progress) -> ControlFlow<()> + Sync + 'a;

/// Progress of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// Trials done, by all threads.
    pub done: u64,
    /// Trials in all; `None` for an adaptive run, which does not know.
    pub planned: Option<u64>,
}

impl std::fmt::Debug for MonteCarlo<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut debug = f.debug_struct("MonteCarlo");
        debug.field("seed", &self.seed).field("plan", &self.plan).field("allowed_failures", &self.allowed_failures);
        debug.finish_non_exhaustive()
    }
}

impl<'a> MonteCarlo<'a> {
    /// A fixed number of trials, with seed 0.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for zero trials or more than 2⁵³.
    pub fn new(inputs: &Inputs, trials: u64) -> Result<Self, UncertaintyError> {
        const MOST: u64 = 1 << 53;
        match trials {
            0 => Err(UncertaintyError::invalid("at least one trial is needed, but none was asked for")),
            1..=MOST => Ok(Self::with_plan(inputs, Plan::Fixed(trials))),
            _ => Err(UncertaintyError::too_many_trials(trials, MOST)),
        }
    }

    /// A number of trials that makes the results stable by `rule`, with seed 0.
    pub fn adaptive(inputs: &Inputs, rule: Adaptive) -> Self {
        Self::with_plan(inputs, Plan::Adaptive(rule))
    }

    fn with_plan(inputs: &Inputs, plan: Plan) -> Self {
        let (sampler, heavy_tail, fingerprint) = (Sampler::new(inputs), HeavyTail::of(inputs), inputs.fingerprint());
        let (allowed_failures, watch) = (AllowedFailures::default(), None);
        Self { sampler, heavy_tail, fingerprint, seed: 0, plan, allowed_failures, watch }
    }

    /// Rule by which an adaptive run stops.
    /// Number of trials, where it is fixed.
    pub(crate) const fn planned(&self) -> Option<u64> {
        match self.plan {
            Plan::Fixed(trials) => Some(trials),
            Plan::Adaptive(_) => None,
        }
    }

    pub(crate) const fn rule(&self) -> Option<Adaptive> {
        match self.plan {
            Plan::Adaptive(rule) => Some(rule),
            Plan::Fixed(_) => None,
        }
    }

    /// The same with another seed, and so with other random numbers.
    #[must_use]
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The same with a share of trials that may fail, 0 unless set.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless it lies in [0, 1).
    pub fn with_allowed_failures(mut self, share: f64) -> Result<Self, UncertaintyError> {
        self.allowed_failures = AllowedFailures::new(share)?;
        Ok(self)
    }

    /// The same with a function that receives the progress every 100 trials of a thread, and ends the run by returning
    /// [`ControlFlow::Break`].
    #[must_use]
    pub const fn with_progress(mut self, watch: &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync + 'a)) -> Self {
        self.watch = Some(watch);
        self
    }

    /// The blocks of part `index` out of `parts` of a run of a fixed number of trials, as equal as they can be; empty
    /// beyond the last part, and for an adaptive run, which does not know its blocks.
    ///
    /// ```
    /// use fmm_uq::{Input, Inputs, MonteCarlo};
    ///
    /// let inputs = Inputs::new([Input::new("x", 1.0, 0.1, "m")?])?;
    /// let run = MonteCarlo::new(&inputs, 10_000)?.with_seed(7);
    /// let parts = (0..3).map(|part| run.run_blocks(run.shard(part, 3), |x| x[0] * x[0]));
    /// let merged = parts.rev().reduce(|a, b| a?.merge(b?)).unwrap()?;
    /// assert_eq!(run.finish(merged)?, run.run(|x| x[0] * x[0])?);
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    pub fn shard(&self, index: u64, parts: u64) -> Range<u64> {
        let Some(trials) = self.planned() else { return 0..0 };
        let blocks = u128::from(trials.div_ceil(BLOCK_TRIALS as u64));
        let parts = u128::from(parts.max(1));
        let start = |index: u64| (blocks * u128::from(index).min(parts) / parts) as u64;
        start(index)..start(index.saturating_add(1))
    }

    /// The values of the inputs in one trial, such as that of a [`Failure`](crate::failure::Failure); `None` if the
    /// block has no such trial.
    pub fn trial_inputs(&self, block: u64, trial: usize) -> Option<Vec<f64>> {
        (trial < BLOCK_TRIALS).then(|| Block::inputs(self.seed, block, trial, &self.sampler))
    }
}
