//! The iteration: a trust-region search, then steps that sharpen the minimum.

use std::time::Instant;

use fmm_model::Parameter;

use crate::box_least_squares::{BoxLeastSquares, Side};
use crate::evaluation::{Evaluator, Point, Scheme};
use crate::spectrum::{Spectrum, is_surely_of_full_rank};
use crate::triangle::{Triangle, half_difference_of_squares};
use crate::trust_region::TrustRegion;
use crate::{Fit, FitError, Options, Outcome, Residuals};

/// Radius of the first search and of those after a stall, as multiples of [`Options::with_initial_radius`].
const RADIUS_FACTORS: [f64; 4] = [1.0, 0.1, 10.0, 0.01];
/// A search may only count as converged if the residual is that orthogonal to the free columns of the Jacobian.
const STALL_COSINE: f64 = 1e-3;
/// Residuals this small against what the parameters move are rounding noise of the model.
const NOISE: f64 = 1e-12;

/// The solver without its trimmings: what a Monte Carlo calculation with many small fits calls, as it keeps its
/// buffers from one fit to the next. [`solve`](crate::solve) is the short way to one fit.
///
/// A Levenberg–Marquardt method in a box. Each step minimises the linear model of the residuals within the trust
/// region *and* the bounds, so that active bounds are met exactly; a search that ends where the gradient does not
/// vanish begins again with another radius; a search that ends well is followed by Gauss–Newton steps that are
/// accepted for lowering the gradient, as the sum of squares can no longer tell them apart.
///
/// ```
/// use fmm_fit::{EvaluationError, Minimizer, Options, Residuals};
/// use fmm_model::Parameter;
///
/// struct Line<'a>(&'a [f64], [Parameter; 2]);
/// impl Residuals for Line<'_> {
///     fn parameters(&self) -> &[Parameter] {
///         &self.1
///     }
///     fn len(&self) -> usize {
///         self.0.len()
///     }
///     fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
///         for (i, r) in residuals.iter_mut().enumerate() {
///             *r = p[0] + p[1] * i as f64 - self.0[i];
///         }
///         Ok(())
///     }
/// }
///
/// let mut minimizer = Minimizer::new(Options::default());
/// for shift in [0.0, 1.0, 2.0] {
///     let data = [1.0 + shift, 3.0 + shift, 5.0 + shift];
///     let line = Line(&data, [Parameter::new("offset", "a", "1"), Parameter::new("slope", "b", "1")]);
///     assert!(minimizer.minimize(&line, &[0.0, 0.0])?.is_success());
///     assert!((minimizer.values()[0] - 1.0 - shift).abs() < 1e-9);
/// }
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Minimizer {
    options: Options,
    parameters: Vec<Parameter>,
    start: Vec<f64>,
    current: Point,
    trial: Point,
    evaluator: Evaluator,
    region: TrustRegion,
    gaps: (Vec<f64>, Vec<f64>),
    phase: Phase,
    attempt: usize,
    stalled: Option<(f64, Vec<f64>)>,
    iterations: usize,
    began: Option<Instant>,
}

#[derive(Debug, Clone, Copy, Default)]
enum Phase {
    #[default]
    Idle,
    Search,
    /// Sharpening after a search that ended with `reason`; `level` is the norm to lower.
    Polish {
        reason: Outcome,
        level: f64,
        left: usize,
    },
    Done(Outcome),
}

impl Minimizer {
    /// A solver with the given options.
    pub fn new(options: Options) -> Self {
        Self { options, ..Self::default() }
    }

    /// Fits `problem` from `start`, one value per parameter within its bounds.
    ///
    /// # Errors
    /// [`FitError`] if the start, the problem or the options do not allow a fit to begin.
    pub fn minimize<P: Residuals + ?Sized>(&mut self, problem: &P, start: &[f64]) -> Result<Outcome, FitError> {
        self.begin(problem, start)?;
        loop {
            if let Some(outcome) = self.iterate(problem) {
                return Ok(outcome);
            }
        }
    }

    /// The best values so far, one per parameter.
    pub fn values(&self) -> &[f64] {
        &self.current.values
    }

    /// The residuals at [`values`](Self::values).
    pub fn residuals(&self) -> &[f64] {
        &self.current.residuals
    }

    /// Σᵢ rᵢ² at [`values`](Self::values).
    pub fn sum_of_squares(&self) -> f64 {
        self.current.sum_of_squares
    }

    /// Trial steps taken, accepted or not.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Evaluations of the residuals, those for differences included.
    pub fn residual_evaluations(&self) -> usize {
        self.evaluator.residual_evaluations
    }

    /// Evaluations of the Jacobian by the problem itself.
    pub fn jacobian_evaluations(&self) -> usize {
        self.evaluator.jacobian_evaluations
    }

    /// How the fit ended; none before it has.
    pub fn outcome(&self) -> Option<Outcome> {
        if let Phase::Done(outcome) = self.phase { Some(outcome) } else { None }
    }

    /// The result with uncertainties and rank; a fit that was interrupted counts as cancelled.
    ///
    /// # Errors
    /// [`FitError::NotStarted`] before the first fit.
    pub fn fit(&self) -> Result<Fit, FitError> {
        if matches!(self.phase, Phase::Idle) {
            return Err(FitError::NotStarted);
        }
        Ok(Fit::new(self, self.current.residuals.clone()))
    }

    pub(crate) fn into_fit(mut self) -> Fit {
        let residuals = std::mem::take(&mut self.current.residuals);
        Fit::new(&self, residuals)
    }

    pub(crate) fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    pub(crate) fn start(&self) -> &[f64] {
        &self.start
    }

    pub(crate) fn scheme(&self) -> Scheme {
        self.evaluator.scheme
    }

    pub(crate) fn free(&self) -> &[usize] {
        &self.evaluator.free
    }

    pub(crate) fn triangle(&self) -> &Triangle {
        &self.current.triangle
    }

    pub(crate) fn model_error(&self) -> Option<&str> {
        self.evaluator.model_error.as_deref()
    }

    pub(crate) fn radius(&self) -> f64 {
        self.region.radius
    }

    /// Checks the start and evaluates it.
    pub(crate) fn begin<P: Residuals + ?Sized>(&mut self, problem: &P, start: &[f64]) -> Result<(), FitError> {
        self.phase = Phase::Idle;
        self.options.validate()?;
        let parameters = problem.parameters();
        if self.parameters != parameters {
            self.parameters = parameters.to_vec();
        }
        check_start(parameters, start)?;
        self.began = self.options.time_limit.map(|_| Instant::now());
        (self.iterations, self.attempt, self.stalled) = (0, 0, None);
        self.start.clear();
        self.start.extend_from_slice(start);
        let bounds = parameters.iter().map(|parameter| (parameter.bounds().lower(), parameter.bounds().upper()));
        self.evaluator.begin(problem.len(), bounds, start);
        let free = self.evaluator.free.len();
        if problem.len() < free {
            return Err(FitError::TooFewResiduals { residuals: problem.len(), free });
        }
        self.current.values.clone_from(&self.start);
        if !self.evaluator.residuals(problem, &mut self.current) {
            return Err(self.bad_start(problem));
        }
        if free == 0 {
            self.current.triangle.reset(0);
            self.phase = Phase::Done(Outcome::NoFreeParameters);
            return Ok(());
        }
        if !self.evaluator.factor(problem, &mut self.current) {
            return Err(self.bad_start(problem));
        }
        self.begin_search(problem);
        Ok(())
    }

    /// One trial step; the outcome once there is one.
    pub(crate) fn iterate<P: Residuals + ?Sized>(&mut self, problem: &P) -> Option<Outcome> {
        if let Phase::Search | Phase::Polish { .. } = self.phase
            && let Some(limit) = self.limit_reached()
        {
            // A search that had converged stays converged, however little it was sharpened.
            let outcome = if let Phase::Polish { reason, .. } = self.phase { reason } else { limit };
            self.return_to_best(problem);
            self.phase = Phase::Done(outcome);
        }
        match self.phase {
            Phase::Search => self.search(problem),
            Phase::Polish { reason, level, left } => self.polish(problem, reason, level, left),
            Phase::Idle | Phase::Done(_) => {}
        }
        self.outcome()
    }

    fn limit_reached(&self) -> Option<Outcome> {
        let is_late = |began: Instant| self.options.time_limit.is_some_and(|limit| began.elapsed() >= limit);
        if self.options.is_cancelled() {
            Some(Outcome::Cancelled)
        } else if self.iterations >= self.options.max_iterations {
            Some(Outcome::MaxIterations)
        } else if self.evaluator.residual_evaluations >= self.options.max_evaluations {
            Some(Outcome::MaxEvaluations)
        } else if self.began.is_some_and(is_late) {
            Some(Outcome::TimedOut)
        } else {
            None
        }
    }

    fn bad_start<P: Residuals + ?Sized>(&self, problem: &P) -> FitError {
        if self.evaluator.model_error.is_some() {
            // Ask again for the error itself: a pure function fails in the same way.
            let mut residuals = vec![0.0; problem.len()];
            let mut jacobian = vec![0.0; problem.len() * self.parameters.len()];
            if let Err(error) = problem.residuals_and_jacobian(&self.start, &mut residuals, &mut jacobian) {
                return FitError::ModelFailed(error.into_boxed());
            }
        }
        if !self.current.sum_of_squares.is_finite() {
            let size = |value: f64| if value.is_nan() { f64::INFINITY } else { value.abs() };
            let worst = self.current.residuals.iter().copied().enumerate().fold((0, 0.0), |worst, next| {
                if size(next.1) > size(worst.1) { next } else { worst }
            });
            return FitError::ResidualNotFinite { index: worst.0, value: worst.1 };
        }
        let column = self.evaluator.first_bad_column(problem.len()).unwrap_or(self.evaluator.free[0]);
        FitError::DerivativeNotFinite { parameter: self.parameters[column].name().to_owned() }
    }

    fn begin_search<P: Residuals + ?Sized>(&mut self, problem: &P) {
        let factor = self.options.initial_radius * RADIUS_FACTORS[self.attempt];
        let free_values = self.evaluator.free.iter().map(|&j| self.current.values[j]);
        self.region.begin(&self.current.triangle, free_values, factor);
        self.phase = Phase::Search;
        self.linearise(problem);
    }

    /// Makes the current point the model of the trust region. Where forward differences cannot tell a weak
    /// direction from none, central ones take over for good.
    fn linearise<P: Residuals + ?Sized>(&mut self, problem: &P) {
        let threshold = self.rank_threshold();
        let rank = self.region.set_model(&self.current.triangle, threshold);
        if rank < self.evaluator.free.len()
            && self.evaluator.scheme == Scheme::Forward
            && self.refine_derivatives(problem)
        {
            self.region.set_model(&self.current.triangle, self.rank_threshold());
        }
        if self.largest_cosine() <= self.options.gradient_tolerance {
            self.end_search(problem, Outcome::GradientSmall);
        }
    }

    /// Central differences at the current point; the forward ones stay if that fails.
    fn refine_derivatives<P: Residuals + ?Sized>(&mut self, problem: &P) -> bool {
        self.evaluator.scheme = Scheme::Central;
        self.trial.triangle.copy_from(&self.current.triangle);
        let refined = self.evaluator.factor(problem, &mut self.current);
        if !refined {
            self.current.triangle.copy_from(&self.trial.triangle);
            self.evaluator.scheme = Scheme::Forward;
        }
        refined
    }

    fn rank_threshold(&self) -> f64 {
        self.evaluator.scheme.rank_threshold(self.current.residuals.len())
    }

    fn search<P: Residuals + ?Sized>(&mut self, problem: &P) {
        self.iterations += 1;
        self.measure_gaps();
        let step = self.region.propose(&self.gaps.0, &self.gaps.1);
        take(step, &self.evaluator, &self.current.values, &mut self.trial.values);
        let length = self.region.scaled_length(self.region_step());
        let predicted = self.region.predicted_reduction(&self.current.triangle);
        let half_cost = 0.5 * self.current.sum_of_squares;

        let is_finite = self.evaluator.residuals(problem, &mut self.trial);
        let actual = if is_finite {
            half_difference_of_squares(&self.current.residuals, &self.trial.residuals)
        } else {
            f64::NEG_INFINITY
        };
        let ratio = if predicted > 0.0 { actual / predicted } else { 0.0 };
        let is_better = ratio > 1e-4;
        let accepted = is_better && self.evaluator.factor(problem, &mut self.trial);
        if ratio < 0.25 || (is_better && !accepted) {
            self.region.radius = 0.25 * length.min(self.region.radius);
        } else if ratio > 0.75 && length >= 0.9 * self.region.radius {
            self.region.radius = 2.0 * length;
        }
        if accepted {
            std::mem::swap(&mut self.current, &mut self.trial);
            self.evaluator.remember_magnitudes(&self.current.values);
            self.region.rescale(&self.current.triangle);
            self.linearise(problem);
            if !matches!(self.phase, Phase::Search) {
                return;
            }
        }
        let negligible = self.options.cost_tolerance * half_cost;
        let free_values = self.evaluator.free.iter().map(|&j| self.current.values[j]);
        let shortest = self.options.step_tolerance * self.region.scaled_length(free_values);
        if predicted <= negligible && actual.abs() <= negligible {
            self.end_search(problem, Outcome::CostConverged);
        } else if length.min(self.region.radius) <= shortest.max(f64::MIN_POSITIVE) {
            let left_the_model = !is_finite || (is_better && !accepted);
            self.end_search(problem, if left_the_model { Outcome::NonFinite } else { Outcome::StepConverged });
        }
    }

    /// The last step of the trust region, in the free parameters, as far as the bounds let it be taken.
    fn region_step(&self) -> impl Iterator<Item = f64> {
        self.evaluator.free.iter().map(|&j| self.trial.values[j] - self.current.values[j])
    }

    fn measure_gaps(&mut self) {
        let Evaluator { free, lower, upper, .. } = &self.evaluator;
        let values = &self.current.values;
        self.gaps.0.clear();
        self.gaps.0.extend(free.iter().map(|&j| lower[j] - values[j]));
        self.gaps.1.clear();
        self.gaps.1.extend(free.iter().map(|&j| upper[j] - values[j]));
    }

    /// Decides what the end of a search is worth.
    fn end_search<P: Residuals + ?Sized>(&mut self, problem: &P, reason: Outcome) {
        let is_noise = self.is_at_noise_floor();
        if !is_noise && self.largest_cosine() > STALL_COSINE {
            self.stall(problem, if reason == Outcome::NonFinite { reason } else { Outcome::Stalled });
            return;
        }
        if self.stalled.as_ref().is_some_and(|(sum, _)| *sum < self.current.sum_of_squares) {
            self.stall(problem, Outcome::Stalled);
            return;
        }
        let reason = if reason == Outcome::NonFinite { Outcome::StepConverged } else { reason };
        if self.options.polish_steps == 0 {
            self.finish(reason);
            return;
        }
        if self.evaluator.scheme == Scheme::Forward {
            self.refine_derivatives(problem);
        }
        self.region.set_model(&self.current.triangle, self.rank_threshold());
        let level = self.projected_residual(&self.current);
        self.phase = Phase::Polish { reason, level, left: self.options.polish_steps };
    }

    /// Begins again from the start with another radius, or gives up at the best point seen.
    fn stall<P: Residuals + ?Sized>(&mut self, problem: &P, reason: Outcome) {
        self.keep_if_best();
        if self.attempt < self.options.restarts.min(RADIUS_FACTORS.len() - 1) {
            self.attempt += 1;
            self.current.values.clone_from(&self.start);
            // Both were finite when the fit began.
            self.evaluator.residuals(problem, &mut self.current);
            self.evaluator.factor(problem, &mut self.current);
            self.begin_search(problem);
        } else {
            self.return_to_best(problem);
            self.phase = Phase::Done(reason);
        }
    }

    fn keep_if_best(&mut self) {
        let sum = self.current.sum_of_squares;
        if self.stalled.as_ref().is_none_or(|(best, _)| sum < *best) {
            self.stalled = Some((sum, self.current.values.clone()));
        }
    }

    fn return_to_best<P: Residuals + ?Sized>(&mut self, problem: &P) {
        if let Some((sum, values)) = self.stalled.take()
            && sum < self.current.sum_of_squares
        {
            self.current.values = values;
            self.evaluator.residuals(problem, &mut self.current);
            self.evaluator.factor(problem, &mut self.current);
        }
    }

    /// One Gauss–Newton step, kept if it makes the residual more orthogonal to what the free parameters move.
    fn polish<P: Residuals + ?Sized>(&mut self, problem: &P, reason: Outcome, level: f64, left: usize) {
        self.iterations += 1;
        self.measure_gaps();
        let step = self.region.gauss_newton(&self.gaps.0, &self.gaps.1);
        take(step, &self.evaluator, &self.current.values, &mut self.trial.values);
        let moved = self.trial.values != self.current.values;
        let tolerated = self.current.sum_of_squares * (1.0 + 1e-9);
        if !(moved
            && self.evaluator.residuals(problem, &mut self.trial)
            && self.trial.sum_of_squares <= tolerated
            && self.evaluator.factor(problem, &mut self.trial))
        {
            self.finish(reason);
            return;
        }
        let next = self.projected_residual(&self.trial);
        if next < level {
            std::mem::swap(&mut self.current, &mut self.trial);
            self.region.set_model(&self.current.triangle, self.rank_threshold());
        }
        if next > 0.9 * level || left == 1 {
            self.finish(reason);
        } else {
            self.phase = Phase::Polish { reason, level: next, left: left - 1 };
        }
    }

    fn finish(&mut self, reason: Outcome) {
        self.phase = Phase::Done(if self.is_at_noise_floor() {
            Outcome::AtNoiseFloor
        } else if self.largest_cosine() <= self.options.gradient_tolerance {
            Outcome::GradientSmall
        } else {
            reason
        });
    }

    /// Whether rounding the parameters would move the residuals by as much as is left of them.
    fn is_at_noise_floor(&self) -> bool {
        let triangle = &self.current.triangle;
        let influence = |(column, &j): (usize, &usize)| self.current.values[j].abs() * triangle.column_norm(column);
        let reach: f64 = self.evaluator.free.iter().enumerate().map(influence).sum();
        self.current.sum_of_squares.sqrt() <= NOISE * reach
    }

    /// Whether free parameter `column` lies on a bound that the gradient pushes it against.
    fn is_held(&self, point: &Point, column: usize) -> bool {
        let j = self.evaluator.free[column];
        let gradient = point.triangle.gradient(column);
        (point.values[j] == self.evaluator.lower[j] && gradient > 0.0)
            || (point.values[j] == self.evaluator.upper[j] && gradient < 0.0)
    }

    /// The largest cosine between the residual and a column of the Jacobian that is not held by a bound.
    fn largest_cosine(&self) -> f64 {
        let triangle = &self.current.triangle;
        let residual = triangle.residual_norm();
        (0..triangle.order())
            .filter(|&column| !self.is_held(&self.current, column))
            .map(|column| triangle.gradient(column).abs() / (triangle.column_norm(column) * residual))
            .fold(0.0, f64::max)
    }

    /// Norm of the part of the residual that the parameters not held by a bound can move.
    fn projected_residual(&self, point: &Point) -> f64 {
        let free: Vec<usize> =
            (0..point.triangle.order()).filter(|&column| !self.is_held(point, column)).collect();
        let mut face = Triangle::default();
        face.select(&point.triangle, &free, |row| point.triangle.q(row), &mut Vec::new());
        let threshold = self.rank_threshold();
        let norm = |along: &mut dyn Iterator<Item = f64>| along.map(|q| q * q).sum::<f64>().sqrt();
        if is_surely_of_full_rank(&face, threshold) {
            norm(&mut (0..free.len()).map(|row| face.q(row)))
        } else {
            let spectrum = Spectrum::of(&face);
            norm(&mut spectrum.along[..spectrum.rank(threshold)].iter().copied())
        }
    }
}

/// Writes `from` plus the step to `to`; components on a bound are set to the bound itself.
fn take(step: &BoxLeastSquares, evaluator: &Evaluator, from: &[f64], to: &mut Vec<f64>) {
    to.clear();
    to.extend_from_slice(from);
    for ((&j, side), change) in evaluator.free.iter().zip(&step.sides).zip(&step.step) {
        to[j] = match side {
            Side::Lower => evaluator.lower[j],
            Side::Upper => evaluator.upper[j],
            Side::Inside => (from[j] + change).max(evaluator.lower[j]).min(evaluator.upper[j]),
        };
    }
}

fn check_start(parameters: &[Parameter], start: &[f64]) -> Result<(), FitError> {
    if start.len() != parameters.len() {
        return Err(FitError::StartLength { values: start.len(), parameters: parameters.len() });
    }
    for (parameter, &value) in parameters.iter().zip(start) {
        let bounds = parameter.bounds();
        if !value.is_finite() {
            return Err(FitError::StartNotFinite { parameter: parameter.name().to_owned(), value });
        }
        if !bounds.contains(value) {
            let (lower, upper) = (bounds.lower(), bounds.upper());
            return Err(FitError::StartOutsideBounds { parameter: parameter.name().to_owned(), value, lower, upper });
        }
    }
    Ok(())
}
