//! Sensitivity indices: shares of the inputs in the spread of a result.

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::error::UncertaintyError;
use crate::inputs::{Input, Inputs};
use crate::model::ModelOutput;
use crate::moments::Moments;
use crate::monte_carlo::block::BLOCK_TRIALS;
use crate::monte_carlo::refusal::{AllowedFailures, HeavyTail};
use crate::monte_carlo::sampler::Sampler;
use crate::stream::Stream;

/// Streams of the second, independent set of inputs: those with the top bit set, which no run of trials reaches.
const SECOND: u64 = 1 << 63;

/// Shares of the variance of the first output that an input accounts for.
///
/// ```text
/// S = V(E(y|x_i))/V(y)   alone,      S_T = E(V(y|all but x_i))/V(y)   with all its interactions
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct VarianceShare {
    /// Name of the input.
    pub input: String,
    /// S, share of the input alone (1).
    pub first_order: f64,
    /// Standard error of S from the limited number of trials (1).
    pub first_order_error: f64,
    /// S_T, share of the input with its interactions (1).
    pub total: f64,
    /// Standard error of S_T (1).
    pub total_error: f64,
}

impl VarianceShare {
    /// The Sobol' indices of all inputs, from `trials` (n + 2) evaluations for n inputs.
    ///
    /// ```text
    /// S = Σ f(B) (f(A_B) − f(A))/(N V),   S_T = Σ (f(A) − f(A_B))²/(2 N V)
    /// ```
    ///
    /// A and B are independent sets of trials, A_B is A with one column of B. Trials come in blocks as in a
    /// [`MonteCarlo`](crate::MonteCarlo) and give the same bits for any number of threads. Where the model fails for
    /// any of the n + 2 points of a row, the row is left out for all; `allowed_failures` is the share of rows for which
    /// that may happen.
    ///
    /// # Errors
    /// [`UncertaintyError::NoAnswer`] if inputs are correlated, an input has Student's t of ν ≤ 2, the output does not
    /// vary, or the squares of the values vanish. [`UncertaintyError::Invalid`] for fewer than 10 blocks of 1000
    /// trials, from which the errors come, for more than 2⁴⁰ trials, for a share outside [0, 1), or if the squares of
    /// the values overflow. [`UncertaintyError::Model`] if more rows fail than allowed, or all.
    ///
    /// # Panics
    /// If the model does.
    ///
    /// # References
    /// A. Saltelli, P. Annoni, I. Azzini, F. Campolongo, M. Ratto, S. Tarantola, "Variance based sensitivity analysis
    /// of model output", Comput. Phys. Commun. 181 (2010) 259, doi:10.1016/j.cpc.2009.09.018, Table 2 (b) and (f).
    pub fn of_all<R: ModelOutput<f64>>(
        inputs: &Inputs,
        trials: u64,
        seed: u64,
        allowed_failures: f64,
        model: impl Fn(&[f64]) -> R + Sync,
    ) -> Result<Vec<Self>, UncertaintyError> {
        let refuse = |option, value, must_be| Err(UncertaintyError::out_of_range(option, value, must_be));
        if let Some((first, second)) = inputs.dependent_pair() {
            let what = format!("variance shares need independent inputs, but `{first}` and `{second}` are not");
            return Err(UncertaintyError::no_answer(what));
        }
        HeavyTail::require_variance(HeavyTail::of(inputs).as_ref())?;
        let blocks = trials.div_ceil(BLOCK_TRIALS as u64);
        if blocks < 10 {
            return refuse("number of trials for variance shares", trials as f64, "at least 10000");
        }
        let allowed_failures = AllowedFailures::new(allowed_failures)?;
        let most = 1 << 40;
        let count = usize::try_from(blocks).ok().filter(|_| trials <= most);
        let count = count.ok_or_else(|| UncertaintyError::too_many_trials(trials, most))?;
        let sampler = Sampler::new(inputs);
        let one = |block: usize| Rows::run(seed, block as u64, &sampler, &model);
        #[cfg(feature = "rayon")]
        let rows: Vec<Rows> = (0..count).into_par_iter().map(one).collect();
        #[cfg(not(feature = "rayon"))]
        let rows: Vec<Rows> = (0..count).map(one).collect();
        let (failed, all) = (rows.iter().map(|r| r.failed).sum::<u64>(), blocks * BLOCK_TRIALS as u64);
        if !allowed_failures.allow(failed, all) {
            let AllowedFailures(share) = allowed_failures;
            let what = format!("the model failed in {failed} of {all} rows, more than the allowed share of {share}");
            return Err(UncertaintyError::model(what));
        }
        let base: Vec<f64> = rows.iter().flat_map(|r| r.a.iter().chain(&r.b)).copied().collect();
        if base.is_empty() {
            return Err(UncertaintyError::no_success());
        }
        let moments = Moments::of_values(&base);
        moments.require_squares(&base, "the output")?;
        let overflow = || UncertaintyError::uncertainty_out_of_range("the output", f64::INFINITY, "(its unit)");
        let moments = moments.if_finite().ok_or_else(overflow)?;
        if moments.sum_of_squares() == 0.0 {
            let what = "the output does not vary, so that there is no variance to share among the inputs";
            return Err(UncertaintyError::no_answer(what));
        }
        let variance = moments.sum_of_squares() / base.len() as f64;
        let names = inputs.as_slice().iter().enumerate();
        let share = |(i, input): (usize, &Input)| {
            let of = |figure: &dyn Fn(&Rows) -> Option<f64>| {
                let figures: Vec<f64> = rows.iter().filter_map(figure).collect();
                let over = Moments::of_values(&figures);
                let error = over.standard_deviation().unwrap_or(0.0) / (figures.len() as f64).sqrt();
                (over.mean() / variance, error / variance)
            };
            // About the mean, which changes no expectation and takes away most of the scatter.
            let (first_order, first_order_error) =
                of(&|rows| rows.average(i, |a, b, exchanged| (b - moments.mean()) * (exchanged - a)));
            let (total, total_error) =
                of(&|rows| rows.average(i, |a, _, exchanged| 0.5 * (a - exchanged) * (a - exchanged)));
            Self { input: input.name().to_owned(), first_order, first_order_error, total, total_error }
        };
        Ok(names.map(share).collect())
    }
}

/// The results of one block of rows of which every point succeeded.
struct Rows {
    a: Vec<f64>,
    b: Vec<f64>,
    exchanged: Vec<Vec<f64>>,
    failed: u64,
}

impl Rows {
    fn run<R: ModelOutput<f64>>(seed: u64, block: u64, sampler: &Sampler, model: &impl Fn(&[f64]) -> R) -> Self {
        let width = sampler.width();
        let (mut first, mut second) = (vec![0.0; width * BLOCK_TRIALS], vec![0.0; width * BLOCK_TRIALS]);
        sampler.fill(&mut Stream::new(seed, block), &mut first);
        sampler.fill(&mut Stream::new(seed, SECOND | block), &mut second);
        let mut outputs = Vec::new();
        let mut evaluate = |x: &[f64]| -> Option<f64> {
            outputs.clear();
            model(x).append_to(&mut outputs).ok()?;
            outputs.first().copied().filter(|y| y.is_finite())
        };
        let mut rows = Self { a: Vec::new(), b: Vec::new(), exchanged: vec![Vec::new(); width], failed: 0 };
        let mut mixed = vec![0.0; width];
        for (a, b) in first.chunks_exact(width).zip(second.chunks_exact(width)) {
            let mut exchange = |i: usize| {
                mixed.copy_from_slice(a);
                mixed[i] = b[i];
                evaluate(&mixed)
            };
            let exchanged: Option<Vec<f64>> = (0..width).map(&mut exchange).collect();
            if let (Some(exchanged), Some(a), Some(b)) = (exchanged, evaluate(a), evaluate(b)) {
                rows.a.push(a);
                rows.b.push(b);
                rows.exchanged.iter_mut().zip(exchanged).for_each(|(column, y)| column.push(y));
            } else {
                rows.failed += 1;
            }
        }
        rows
    }

    /// Mean of a function of the outputs at a point of either sample and with input `i` exchanged.
    fn average(&self, i: usize, of: impl Fn(f64, f64, f64) -> f64) -> Option<f64> {
        let triples = self.a.iter().zip(&self.b).zip(&self.exchanged[i]);
        let values: Vec<f64> = triples.map(|((&a, &b), &exchanged)| of(a, b, exchanged)).collect();
        Moments::of(&values).map(|moments| moments.mean())
    }
}
