//! Fits from many starts, for sums of squares with more than one minimum.

use std::time::Instant;

use crate::error::FitError;
use crate::problem::residuals::Residuals;
use crate::solver::minimizer::Minimizer;
use crate::solver::options::Options;
use crate::starts::minima::{Finished, Minima};
use crate::starts::start_points::StartPoints;

/// Starts between two looks at the clock and two rounds of comparing results, which bounds the memory.
const BATCH: usize = 32;

/// A search for all minima, and with luck the lowest: fits from many starts.
///
/// 1. The first start is the one given.
/// 2. The others are a Latin hypercube in the bounds; a parameter that has them on one side at most is drawn from
///    within its own size of the given value, or, if that is zero, from where it alone would move the residuals by
///    their own size.
/// 3. Rounds of kicks begin around the best values so far, at distances from the whole region down to a thousandth of
///    it, which finds the deeper one among minima that lie side by side.
///
/// The result is a function of problem, start and seed, whatever the number of threads.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Minimum, MultiStart, Residuals};
/// use fmm_model::{Bounds, Parameter};
///
/// /// Himmelblau's function, which is zero at four points.
/// struct Himmelblau([Parameter; 2]);
/// impl Residuals for Himmelblau {
///     fn parameters(&self) -> &[Parameter] {
///         &self.0
///     }
///     fn len(&self) -> usize {
///         2
///     }
///     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
///         residuals.copy_from_slice(&[p[0] * p[0] + p[1] - 11.0, p[0] + p[1] * p[1] - 7.0]);
///         Ok(())
///     }
/// }
/// let square = Bounds::new(-5.0, 5.0)?;
/// let problem = Himmelblau(["x", "y"].map(|name| Parameter::new(name, name, "1").bounded(square)));
/// let found = MultiStart::default().with_starts(20).solve(&problem, &[0.0, 0.0])?;
/// let is_zero = |minimum: &&Minimum| minimum.fit().sum_of_squares() < 1e-12;
/// assert_eq!(found.minima().iter().filter(is_zero).count(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MultiStart {
    starts: usize,
    rounds: usize,
    kicks: usize,
    seed: u64,
    reach: Option<Vec<f64>>,
    options: Options,
}

impl Default for MultiStart {
    fn default() -> Self {
        Self { starts: 32, rounds: 2, kicks: 16, seed: 0, reach: None, options: Options::default() }
    }
}

impl MultiStart {
    /// The number of starts over the region, the given one included (32).
    #[must_use]
    pub fn with_starts(mut self, starts: usize) -> Self {
        self.starts = starts;
        self
    }

    /// The number of rounds, and of kicks around the best in each (2 of 16).
    #[must_use]
    pub fn with_kicks(mut self, rounds: usize, kicks: usize) -> Self {
        (self.rounds, self.kicks) = (rounds, kicks);
        self
    }

    /// The seed of the random numbers (0).
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Draw starts from within so much of the given one, one value per parameter in its unit, instead of from all
    /// that the bounds allow; 0 keeps a start value as it is. The fits themselves may leave this region.
    #[must_use]
    pub fn with_reach(mut self, reach: Vec<f64>) -> Self {
        self.reach = Some(reach);
        self
    }

    /// Options of the fits. Limits on iterations and evaluations hold for each fit, time limit and cancellation for
    /// all together.
    #[must_use]
    pub fn with_options(mut self, options: Options) -> Self {
        self.options = options;
        self
    }

    /// Fits `problem` from `start` and from others, one after the other.
    ///
    /// # Errors
    /// [`FitError`] if the start, the problem or the options do not allow any fit to begin.
    pub fn solve<P: Residuals + ?Sized>(&self, problem: &P, start: &[f64]) -> Result<Minima, FitError> {
        let mut minimizer = Minimizer::default();
        self.search(problem, start, |starts, options| {
            minimizer.options = options.clone();
            starts.iter().map(|start| finish(&mut minimizer, problem, start)).collect()
        })
    }

    /// [`solve`](Self::solve) on all threads of the present rayon pool, with the same result.
    ///
    /// # Errors
    /// Those of [`solve`](Self::solve).
    #[cfg(feature = "rayon")]
    pub fn solve_parallel<P: Residuals + Sync + ?Sized>(&self, problem: &P, start: &[f64]) -> Result<Minima, FitError> {
        use rayon::prelude::*;

        self.search(problem, start, |starts, options| {
            let minimizer = || Minimizer::new(options.clone());
            let fits = starts.par_iter().map_init(minimizer, |minimizer, start| finish(minimizer, problem, start));
            fits.collect()
        })
    }

    fn search<P: Residuals + ?Sized>(
        &self,
        problem: &P,
        start: &[f64],
        mut fit_all: impl FnMut(&[Vec<f64>], &Options) -> Vec<Result<Finished, FitError>>,
    ) -> Result<Minima, FitError> {
        let began = Instant::now();
        let parameters = problem.parameters();
        let points = self.start_points(problem, start)?;
        let mut minima = Minima::default();
        let mut run = |points: &[Vec<f64>], minima: &mut Minima| {
            for batch in points.chunks(BATCH) {
                let options = self.options.remaining(began);
                let is_over = options.is_cancelled() || options.time_limit.is_some_and(|limit| limit.is_zero());
                if is_over && minima.starts() > 0 {
                    return;
                }
                for finished in fit_all(batch, &options) {
                    minima.take(finished);
                }
            }
        };
        run(&[start.to_vec()], &mut minima);
        run(&points.latin_hypercube(self.starts.saturating_sub(1), 1), &mut minima);
        for round in 0..self.rounds {
            let first = self.starts.max(1) + round * self.kicks;
            let centre = minima.best_values().unwrap_or(start).to_vec();
            run(&points.kicks(&centre, parameters, self.kicks, first), &mut minima);
        }
        minima.sort();
        minima.refused()
    }

    /// Checks what the caller gave and lays out the region.
    fn start_points<P: Residuals + ?Sized>(&self, problem: &P, start: &[f64]) -> Result<StartPoints, FitError> {
        let parameters = problem.parameters();
        let mut minimizer = Minimizer::new(self.options.clone());
        let has_values = match minimizer.begin(problem, start) {
            Ok(()) => true,
            // Other starts may do.
            Err(FitError::NoModel { .. }) => false,
            Err(error) => return Err(error),
        };
        if let Some(reach) = &self.reach {
            let bad = reach.iter().copied().find(|reach| !(*reach >= 0.0 && reach.is_finite()));
            let value = if reach.len() == parameters.len() { bad } else { Some(reach.len() as f64) };
            if let Some(value) = value {
                let expected = "one finite value of at least 0 per parameter";
                return Err(FitError::option("the option reach", expected, value));
            }
        }
        let size = |j: usize| {
            let alone = || {
                let column = minimizer.free().iter().position(|&free| free == j).filter(|_| has_values)?;
                Some(
                    minimizer.factor_of_jacobian().residual_norm() / minimizer.factor_of_jacobian().column_norm(column),
                )
            };
            let own = Some(start[j].abs()).filter(|size| *size > 0.0);
            own.or_else(alone).filter(|size| size.is_finite() && *size > 0.0).unwrap_or(1.0)
        };
        Ok(StartPoints::new(parameters, start, self.reach.as_deref(), size, self.seed))
    }
}

fn finish<P: Residuals + ?Sized>(minimizer: &mut Minimizer, problem: &P, start: &[f64]) -> Result<Finished, FitError> {
    minimizer.minimize(problem, start)?;
    Ok(Finished { fit: minimizer.fit()?, triangle: minimizer.factor_of_jacobian().clone() })
}
