//! Successive halving: fits from several starts, of which the worse are given up.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use crate::error::FitError;
use crate::fitting::solve::Progress;
use crate::problem::residuals::Residuals;
use crate::result::fit::Fit;
use crate::solver::minimizer::Minimizer;
use crate::solver::options::Options;
use crate::solver::outcome::Outcome;
#[cfg(feature = "rayon")]
use rayon::prelude::*;

/// Trial steps of each fit before the first are given up.
const FIRST: usize = 6;
/// Two fits are one if what is between them moves the residuals by less than this share of their scatter (1).
const SAME: f64 = 0.1;

/// The best end of the fits from `starts`, of which most are given up early.
///
/// All fits go a few steps; half of them, the better ones, go twice as many, and so on until one is left, which is
/// finished. Of fits that have come to the same place one goes on, and the next best takes the room of the others. The
/// lowest minimum is missed if its fit is among the worse half at first; where that may be, give fewer starts, or
/// [`solve`](crate::solve) each.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use std::ops::ControlFlow;
///
/// use fmm_fit::{Options, Residuals, solve_best};
/// use fmm_model::Parameter;
///
/// /// sin(b t) of unknown b: one minimum for each whole number of waves more or less.
/// struct Sine([Parameter; 1]);
/// impl Residuals for Sine {
///     fn parameters(&self) -> &[Parameter] {
///         &self.0
///     }
///     fn len(&self) -> usize {
///         100
///     }
///     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
///         for (i, residual) in residuals.iter_mut().enumerate() {
///             let t = 0.1 * i as f64;
///             *residual = (p[0] * t).sin() - (3.3 * t).sin();
///         }
///         Ok(())
///     }
/// }
/// let starts: Vec<_> = (1..=8).map(|b| vec![f64::from(b)]).collect();
/// let problem = Sine([Parameter::new("rate", "b", "1/s")]);
/// let fit = solve_best(&problem, &starts, &Options::default(), |_| ControlFlow::Continue(()))?;
/// assert!((fit.values()[0] - 3.3).abs() < 1e-9);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// `observer` gets the progress after every trial step of every fit, and may end them all. Limits on iterations and
/// evaluations hold for each fit, that on time for all together. With the feature `rayon` the fits go on all threads of
/// the current pool, with the same result; their steps then come in any order. An observer that itself waits for work
/// of that pool may wait for ever.
///
/// # Errors
/// [`FitError`] of the last start if no fit can begin; [`FitError::NotStarted`] without starts.
///
/// # References
/// K. Jamieson, A. Talwalkar, "Non-stochastic best arm identification and hyperparameter optimization", Proc. 19th Int.
/// Conf. Artificial Intelligence and Statistics (2016) 240, <https://doi.org/10.48550/arXiv.1502.07943>.
pub fn solve_best<P: Residuals + Sync + ?Sized>(
    problem: &P,
    starts: &[Vec<f64>],
    options: &Options,
    observer: impl FnMut(&Progress<'_>) -> ControlFlow<()> + Send,
) -> Result<Fit, FitError> {
    let watch = Watch(Mutex::new(Some(observer)));
    let begin = |start: &Vec<f64>| {
        let mut fit = Minimizer::new(options.clone());
        fit.begin(problem, start).map(|()| fit)
    };
    let mut refused = FitError::NotStarted;
    let mut fits = Vec::with_capacity(starts.len());
    for begun in each(starts.iter().collect(), begin) {
        match begun {
            Ok(fit) => fits.push(fit),
            Err(error) => refused = error,
        }
    }
    let mut steps = FIRST;
    while fits.len() > 1 {
        fits = each(fits, |mut fit| {
            go(&mut fit, problem, steps, &watch);
            fit
        });
        if let Some(exact) = fits.iter().position(|fit| fit.outcome() == Some(Outcome::AtNoiseFloor)) {
            return Ok(fits.swap_remove(exact).into_fit());
        }
        fits.sort_by(lower);
        if watch.is_over() {
            break;
        }
        let most = fits.len().div_ceil(2);
        keep_distinct(&mut fits);
        fits.truncate(most);
        steps *= 2;
    }
    let Some(mut last) = fits.into_iter().next() else { return Err(refused) };
    go(&mut last, problem, usize::MAX, &watch);
    Ok(last.into_fit())
}

/// The observer of all fits; none once it has ended them.
struct Watch<F>(Mutex<Option<F>>);

impl<F: FnMut(&Progress<'_>) -> ControlFlow<()>> Watch<F> {
    /// Tells the observer of a step, unless it has ended all fits already.
    fn is_told_to_end(&self, progress: Progress<'_>) -> bool {
        let mut observer = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if observer.as_mut().is_some_and(|observer| observer(&progress).is_break()) {
            *observer = None;
        }
        observer.is_none()
    }

    fn is_over(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_none()
    }
}

/// Results of `work` for each of `items`, in their order.
fn each<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    #[cfg(feature = "rayon")]
    return items.into_par_iter().with_max_len(1).map(work).collect();
    #[cfg(not(feature = "rayon"))]
    return items.into_iter().map(work).collect();
}

/// Takes at most `steps` trial steps, unless the observer ends all fits.
fn go<P: Residuals + ?Sized, F: FnMut(&Progress<'_>) -> ControlFlow<()>>(
    fit: &mut Minimizer,
    problem: &P,
    steps: usize,
    watch: &Watch<F>,
) {
    for _ in 0..steps {
        if fit.outcome().is_some() {
            break;
        }
        let outcome = fit.iterate(problem);
        if watch.is_told_to_end(Progress::of(fit)) && outcome.is_none() {
            fit.cancel(problem);
        }
    }
}

fn lower(one: &Minimizer, other: &Minimizer) -> std::cmp::Ordering {
    one.lowest().total_cmp(&other.lowest())
}

/// Drops fits that are where a better one is; `fits` are sorted.
fn keep_distinct(fits: &mut Vec<Minimizer>) {
    let mut distinct: Vec<Minimizer> = Vec::with_capacity(fits.len());
    for fit in fits.drain(..) {
        if !distinct.iter().any(|better| is_same(better, &fit)) {
            distinct.push(fit);
        }
    }
    *fits = distinct;
}

fn is_same(one: &Minimizer, other: &Minimizer) -> bool {
    let freedom = one.residuals().len().saturating_sub(one.free().len()).max(1);
    let scatter = one.sum_of_squares() / freedom as f64;
    let change: Vec<f64> = one.free().iter().map(|&j| other.values()[j] - one.values()[j]).collect();
    let square: f64 = (0..change.len()).map(|row| one.factor_of_jacobian().row_times(row, &change).powi(2)).sum();
    square <= SAME * SAME * scatter
}
