//! Fits from several starts, of which the worse are given up early (successive halving).

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use fmm_model::Parameter;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::error::FitError;
use crate::problem::residuals::Residuals;
use crate::result::fit::Fit;
use crate::solver::minimizer::Minimizer;
use crate::solver::options::Options;
use crate::solver::outcome::Outcome;

/// Trial steps of each fit before the first are given up.
const FIRST: usize = 6;
/// Two fits are one if what is between them moves the residuals by less than this share of their scatter (1).
const SAME: f64 = 0.1;

/// A search for the lowest of several minima: fits from many starts, most of which are given up early.
///
/// All fits go a few steps; half of them, the better ones, go twice as many, and so on until one is left, which is
/// finished. Of fits that have come to the same place one goes on, and the next best takes the room of the others. The
/// lowest minimum is missed if its fit is among the worse half at first; where that may be, give fewer starts, or
/// [`solve`](crate::solve) each.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{MultiStart, Residuals};
/// use fmm_model::{Bounds, Parameter};
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
/// let problem = Sine([Parameter::new("rate", "b", "1/s").bounded(Bounds::new(0.0, 8.0)?)]);
/// let fit = MultiStart::around(problem.parameters(), &[1.0], 20, 0).solve(&problem)?;
/// assert!((fit.values()[0] - 3.3).abs() < 1e-9);
///
/// let own = MultiStart::from_starts((1..=8).map(|b| vec![f64::from(b)]).collect());
/// assert!((own.solve(&problem)?.values()[0] - 3.3).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Limits on iterations and evaluations hold for each fit, that on time for all together. With the feature `rayon` the
/// fits go on all threads of the current pool, with the same result.
///
/// # References
/// K. Jamieson, A. Talwalkar, "Non-stochastic best arm identification and hyperparameter optimization", Proc. 19th Int.
/// Conf. Artificial Intelligence and Statistics (2016) 240, <https://doi.org/10.48550/arXiv.1502.07943>;
/// M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21 (1979) 239,
/// <https://doi.org/10.1080/00401706.1979.10489755> (Latin hypercube).
#[derive(Debug, Clone)]
pub struct MultiStart {
    starts: Vec<Vec<f64>>,
    options: Options,
}

impl MultiStart {
    /// Begins at `starts`, each with one value per parameter.
    pub fn from_starts(starts: Vec<Vec<f64>>) -> Self {
        Self { starts, options: Options::default() }
    }

    /// Begins at `start` and at a number of `others` that are a Latin hypercube, drawn with this `seed`.
    ///
    /// A parameter with two bounds is drawn from between them. Any other is drawn from within its own size of the start
    /// value, or from within 1 in its unit if that is zero.
    pub fn around(parameters: &[Parameter], start: &[f64], others: usize, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut starts = vec![Vec::with_capacity(start.len()); others];
        for (parameter, start) in parameters.iter().zip(start) {
            let bounds = parameter.bounds();
            let size = if *start == 0.0 { 1.0 } else { start.abs() };
            let (lower, upper) = match (bounds.lower(), bounds.upper()) {
                (lower, upper) if (upper - lower).is_finite() => (lower, upper),
                _ => (start - size, start + size),
            };
            let mut parts: Vec<usize> = (0..others).collect();
            parts.shuffle(&mut random);
            for (point, part) in starts.iter_mut().zip(parts) {
                let share = (part as f64 + random.random::<f64>()) / others as f64;
                point.push(bounds.clamp((1.0 - share) * lower + share * upper));
            }
        }
        starts.insert(0, start.to_vec());
        Self::from_starts(starts)
    }

    /// Options of the fits.
    #[must_use]
    pub fn with_options(self, options: Options) -> Self {
        Self { options, ..self }
    }

    /// The best end of all fits.
    ///
    /// # Errors
    /// [`FitError`] of the last start if no fit can begin; [`FitError::NotStarted`] without starts.
    pub fn solve<P: Residuals + Sync + ?Sized>(&self, problem: &P) -> Result<Fit, FitError> {
        self.solve_observed(problem, |_| ControlFlow::Continue(()))
    }

    /// [`solve`](Self::solve) with an `observer` that gets the solver of each fit after every trial step, and may
    /// end them all.
    ///
    /// With the feature `rayon` the steps come in any order. An observer that itself waits for work of the pool may
    /// wait for ever.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve).
    pub fn solve_observed<P: Residuals + Sync + ?Sized>(
        &self,
        problem: &P,
        observer: impl FnMut(&Minimizer) -> ControlFlow<()> + Send,
    ) -> Result<Fit, FitError> {
        let watch = Watch(Mutex::new(Some(observer)));
        let begin = |start: &Vec<f64>| {
            let mut fit = Minimizer::new(self.options.clone());
            fit.begin(problem, start).map(|()| fit)
        };
        let mut refused = FitError::NotStarted;
        let mut fits = Vec::with_capacity(self.starts.len());
        for begun in each(self.starts.iter().collect(), begin) {
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
}

/// The observer of all fits; none once it has ended them.
struct Watch<F>(Mutex<Option<F>>);

impl<F: FnMut(&Minimizer) -> ControlFlow<()>> Watch<F> {
    /// Tells the observer of a step, unless it has ended all fits already.
    fn is_told_to_end(&self, fit: &Minimizer) -> bool {
        let mut observer = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if observer.as_mut().is_some_and(|observer| observer(fit).is_break()) {
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
fn go<P: Residuals + ?Sized, F: FnMut(&Minimizer) -> ControlFlow<()>>(
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
        if watch.is_told_to_end(fit) && outcome.is_none() {
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
