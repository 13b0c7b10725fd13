//! Iteration of a fit: search, restart, sharpening.

use std::time::Instant;

use crate::algebra::spectrum::{Spectrum, is_surely_of_full_rank};
use crate::algebra::sums::half_difference_of_squares;
use crate::algebra::triangle::Triangle;
use crate::problem::residuals::Residuals;
use crate::solver::box_least_squares::{BoxLeastSquares, Side};
use crate::solver::evaluation::{Evaluator, Point, Scheme};
use crate::solver::minimizer::{Attempt, Minimizer, Phase};
use crate::solver::outcome::Outcome;

/// Radius of the first search and of those after a stall, over the scaled length of the start (1).
const RADIUS_FACTORS: [f64; 4] = [1.0, 0.1, 10.0, 0.01];
/// A search may only count as converged if the residual is that orthogonal to the free columns of the Jacobian.
const STALL_COSINE: f64 = 1e-3;
/// Factor of the radius after a step that the linear model did not foresee. In a narrow curved valley, such as that of
/// NIST's Bennett5, a quarter shortens the steps to come more than they need.
const SHRINKING: f64 = 0.35;

impl Minimizer {
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

    /// Ends the fit from outside.
    pub(crate) fn cancel<P: Residuals + ?Sized>(&mut self, problem: &P) -> Outcome {
        self.return_to_best(problem);
        self.phase = Phase::Done(Outcome::Cancelled);
        Outcome::Cancelled
    }

    pub(crate) fn limit_reached(&self) -> Option<Outcome> {
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

    pub(crate) fn begin_search<P: Residuals + ?Sized>(&mut self, problem: &P) {
        let factor = RADIUS_FACTORS[self.attempt];
        let free_values = self.evaluator.free.iter().map(|&j| self.current.values[j]);
        self.region.begin(&self.current.triangle, free_values, factor);
        self.phase = Phase::Search;
        self.linearise(problem);
    }

    /// Makes the current point the model of the trust region. Where forward differences cannot tell a weak
    /// direction from none, central ones take over for good.
    fn linearise<P: Residuals + ?Sized>(&mut self, problem: &P) {
        let rank = self.region.set_model(&self.current.triangle, self.rank_threshold());
        if rank < self.evaluator.free.len()
            && self.evaluator.scheme == Scheme::Forward
            && self.refine_derivatives(problem)
        {
            self.region.set_model(&self.current.triangle, self.rank_threshold());
        }
        if largest_cosine(&self.current, &self.evaluator) <= self.options.gradient_tolerance {
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

    pub(crate) fn rank_threshold(&self) -> f64 {
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
            self.region.radius = SHRINKING * length.min(self.region.radius);
        }
        // A step that was good and might have been longer says nothing about what is left to gain.
        let is_held_back = accepted && ratio > 0.75 && length >= 0.9 * self.region.radius;
        if is_held_back {
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
        if predicted <= negligible && actual.abs() <= negligible && !is_held_back {
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

    /// Decides what the end of a search is worth: a minimum to sharpen, or a reason to begin again.
    fn end_search<P: Residuals + ?Sized>(&mut self, problem: &P, reason: Outcome) {
        let is_noise = is_at_noise_floor(&self.current, &self.evaluator);
        let reason = match reason {
            _ if is_noise => Outcome::AtNoiseFloor,
            Outcome::NonFinite if largest_cosine(&self.current, &self.evaluator) > STALL_COSINE => Outcome::NonFinite,
            _ if largest_cosine(&self.current, &self.evaluator) > STALL_COSINE => Outcome::Stalled,
            Outcome::NonFinite => Outcome::StepConverged,
            converged => converged,
        };
        let is_worse = self.best.as_ref().is_some_and(|best| best.sum_of_squares < self.current.sum_of_squares);
        if reason.is_success() && !is_worse {
            if self.may_leave_saddle(reason) && self.leave_saddle(problem, reason) {
                return;
            }
            self.begin_polish(problem, reason);
            return;
        }
        if !is_worse {
            let values = self.current.values.clone();
            self.best = Some(Attempt { sum_of_squares: self.current.sum_of_squares, values, reason });
        }
        if self.attempt < self.options.restarts.min(RADIUS_FACTORS.len() - 1) {
            self.attempt += 1;
            self.current.values.clone_from(&self.start);
            self.evaluate_again(problem);
            self.begin_search(problem);
        } else {
            let reason = self.return_to_best(problem).unwrap_or(reason);
            if reason.is_success() {
                self.begin_polish(problem, reason);
            } else {
                self.phase = Phase::Done(reason);
            }
        }
    }

    /// Moves back to the best end of a search, if one was better than where the fit is now, and says how it ended.
    fn return_to_best<P: Residuals + ?Sized>(&mut self, problem: &P) -> Option<Outcome> {
        let best = self.best.take().filter(|best| best.sum_of_squares <= self.current.sum_of_squares)?;
        if best.values != self.current.values {
            self.current.values = best.values;
            self.evaluate_again(problem);
        }
        Some(best.reason)
    }

    /// Residuals and derivatives at current values that had both before. If that was by the shorter steps of forward
    /// differences and the longer ones leave what the model can do, the shorter ones come back.
    pub(crate) fn evaluate_again<P: Residuals + ?Sized>(&mut self, problem: &P) {
        self.evaluator.residuals(problem, &mut self.current);
        if !self.evaluator.factor(problem, &mut self.current) && self.evaluator.scheme == Scheme::Central {
            self.evaluator.scheme = Scheme::Forward;
            self.evaluator.factor(problem, &mut self.current);
        }
    }

    fn begin_polish<P: Residuals + ?Sized>(&mut self, problem: &P, reason: Outcome) {
        if self.options.polish_steps == 0 {
            self.finish(problem, reason, 0.0);
            return;
        }
        if self.evaluator.scheme == Scheme::Forward {
            self.refine_derivatives(problem);
        }
        self.region.set_model(&self.current.triangle, self.rank_threshold());
        let level = projected_residual(&self.current, &self.evaluator);
        self.phase = Phase::Polish { reason, level, left: self.options.polish_steps };
    }

    /// One Gauss–Newton step, kept if it makes the residual more orthogonal to what the free parameters move.
    fn polish<P: Residuals + ?Sized>(&mut self, problem: &P, reason: Outcome, level: f64, left: usize) {
        self.iterations += 1;
        self.measure_gaps();
        let step = self.region.gauss_newton(&self.gaps.0, &self.gaps.1);
        take(step, &self.evaluator, &self.current.values, &mut self.trial.values);
        let moved = self.trial.values != self.current.values;
        let free_values = self.evaluator.free.iter().map(|&j| self.current.values[j]);
        let length = self.region.scaled_length(self.region_step()) / self.region.scaled_length(free_values);
        let tolerated = self.current.sum_of_squares * (1.0 + 1e-9);
        if !(moved
            && self.evaluator.residuals(problem, &mut self.trial)
            && self.trial.sum_of_squares <= tolerated
            && self.evaluator.factor(problem, &mut self.trial))
        {
            self.finish(problem, reason, length);
            return;
        }
        let next = projected_residual(&self.trial, &self.evaluator);
        if next < level {
            std::mem::swap(&mut self.current, &mut self.trial);
            self.region.set_model(&self.current.triangle, self.rank_threshold());
        }
        if next > 0.9 * level || left == 1 {
            self.finish(problem, reason, length);
        } else {
            self.phase = Phase::Polish { reason, level: next, left: left - 1 };
        }
    }

    /// Ends a fit whose last sharpening step was relatively so long.
    fn finish<P: Residuals + ?Sized>(&mut self, problem: &P, reason: Outcome, length: f64) {
        self.sharpen_by_curvature(problem, length);
        self.phase = Phase::Done(if is_at_noise_floor(&self.current, &self.evaluator) {
            Outcome::AtNoiseFloor
        } else if largest_cosine(&self.current, &self.evaluator) <= self.options.gradient_tolerance {
            Outcome::GradientSmall
        } else {
            reason
        });
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

/// Residuals this small against what the parameters move are rounding noise of the model.
const NOISE: f64 = 1e-12;

/// True if rounding of the parameters would move the residuals by as much as is left of them.
pub(crate) fn is_at_noise_floor(point: &Point, evaluator: &Evaluator) -> bool {
    let influence = |(column, &j): (usize, &usize)| point.values[j].abs() * point.triangle.column_norm(column);
    let reach: f64 = evaluator.free.iter().enumerate().map(influence).sum();
    point.sum_of_squares.sqrt() <= NOISE * reach
}

/// The largest cosine between the residual and a column of the Jacobian that no bound holds back.
pub(crate) fn largest_cosine(point: &Point, evaluator: &Evaluator) -> f64 {
    let residual = point.triangle.residual_norm();
    let cosine = |column| point.triangle.gradient(column).abs() / (point.triangle.column_norm(column) * residual);
    // A column or a residual of zero gives NaN, which `max` passes over.
    loose(point, evaluator).map(cosine).fold(0.0, f64::max)
}

/// Norm of the part of the residual that the parameters that no bound holds back can move.
pub(crate) fn projected_residual(point: &Point, evaluator: &Evaluator) -> f64 {
    let columns: Vec<usize> = loose(point, evaluator).collect();
    let mut face = Triangle::default();
    face.select(&point.triangle, &columns, |row| point.triangle.q(row), &mut Vec::new());
    let threshold = evaluator.scheme.rank_threshold(point.residuals.len());
    if is_surely_of_full_rank(&face, threshold) {
        (0..columns.len()).map(|row| face.q(row).powi(2)).sum::<f64>().sqrt()
    } else {
        let spectrum = Spectrum::of(&face);
        spectrum.along[..spectrum.rank(threshold)].iter().map(|along| along * along).sum::<f64>().sqrt()
    }
}

/// The free parameters, as columns, that do not lie on a bound that the gradient pushes them against.
pub(crate) fn loose<'a>(point: &'a Point, evaluator: &'a Evaluator) -> impl Iterator<Item = usize> + 'a {
    let is_held = |column: usize| {
        let (j, gradient) = (evaluator.free[column], point.triangle.gradient(column));
        (point.values[j] == evaluator.lower[j] && gradient > 0.0)
            || (point.values[j] == evaluator.upper[j] && gradient < 0.0)
    };
    (0..point.triangle.order()).filter(move |&column| !is_held(column))
}
