//! One chain of the no-U-turn sampler.
//!
//! # References
//! M. D. Hoffman, A. Gelman, "The No-U-Turn Sampler", J. Mach. Learn. Res. 15 (2014) 1593,
//! <https://jmlr.org/papers/v15/hoffman14a.html>; the crate nuts-rs is that of nutpie and PyMC.

use std::collections::HashMap;

use nuts_rs::{Chain, CpuLogpFunc, CpuMath, CpuMathError, DiagNutsSettings, HasDims, LogpError, Settings};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

use crate::error::FitError;
use crate::posterior::coordinates::Whitening;
use crate::posterior::target::Target;
use crate::problem::residuals::Residuals;

/// Share of points accepted at which steps are aimed where a bound cuts: towards it the density of a logarithm falls
/// off ever more steeply, and long steps diverge there.
const CAUTIOUS: f64 = 0.92;

/// Result of one chain.
#[derive(Debug, Clone, Default)]
pub(super) struct Run {
    /// z of each draw, one after the other.
    pub(super) positions: Vec<f64>,
    pub(super) divergences: usize,
    /// Mean probability of acceptance over trajectories.
    pub(super) acceptance: f64,
    pub(super) evaluations: usize,
}

/// A posterior over whitened coordinates, as the sampler asks for it.
struct Density<'a, P: ?Sized> {
    target: Target<'a, P>,
    whitening: &'a Whitening,
    psi: Vec<f64>,
}

/// The model has no finite value at a point; the sampler counts that as a divergence.
#[derive(Debug, thiserror::Error)]
#[error("the model has no finite value here")]
struct NoValue;

impl LogpError for NoValue {
    fn is_recoverable(&self) -> bool {
        true
    }
}

impl<P: ?Sized> HasDims for Density<'_, P> {
    fn dim_sizes(&self) -> HashMap<String, u64> {
        HashMap::from([("unconstrained_parameter".to_owned(), self.whitening.order() as u64)])
    }
}

impl<P: Residuals + ?Sized> CpuLogpFunc for Density<'_, P> {
    type LogpError = NoValue;
    type FlowParameters = ();
    type ExpandedVector = Vec<f64>;

    fn dim(&self) -> usize {
        self.whitening.order()
    }

    fn logp(&mut self, z: &[f64], gradient: &mut [f64]) -> Result<f64, NoValue> {
        self.whitening.coordinates(z, &mut self.psi);
        let density = self.target.log_density_and_gradient(&self.psi, gradient).ok_or(NoValue)?;
        self.whitening.gradient(&self.psi, gradient);
        Ok(density)
    }

    fn expand_vector<R: Rng + ?Sized>(&mut self, _: &mut R, z: &[f64]) -> Result<Vec<f64>, CpuMathError> {
        Ok(z.to_vec())
    }
}

/// Draws from the posterior of `target`, from `start` on; `warm_up` draws are for step and scales, and thrown away.
pub(super) fn run<P: Residuals + ?Sized>(
    target: Target<'_, P>,
    whitening: &Whitening,
    start: &[f64],
    (warm_up, draws): (usize, usize),
    random: &mut ChaCha8Rng,
) -> Result<Run, FitError> {
    let failed = |error: &dyn std::fmt::Display| FitError::Sampler(error.to_string());
    let mut settings = DiagNutsSettings::default();
    (settings.num_tune, settings.num_draws) = (warm_up as u64, draws as u64);
    if whitening.has_cut() {
        settings.adapt_options.step_size_settings.target_accept = CAUTIOUS;
    }
    let density = Density { target, whitening, psi: Vec::new() };
    let mut chain = settings.new_chain(0, CpuMath::new(density), random).map_err(|error| failed(&error))?;
    chain.set_position(start).map_err(|error| failed(&error))?;
    let mut run = Run { positions: Vec::with_capacity(draws * whitening.order()), ..Run::default() };
    for _ in 0..warm_up {
        chain.draw().map_err(|error| failed(&error))?;
    }
    for _ in 0..draws {
        let (position, _, stats, progress) = chain.expanded_draw().map_err(|error| failed(&error))?;
        run.positions.extend_from_slice(&position);
        run.divergences += usize::from(progress.diverging);
        run.acceptance += stats.adapt.step_size.mean_tree_accept / draws as f64;
        run.evaluations += progress.num_gradients as usize;
    }
    Ok(run)
}
