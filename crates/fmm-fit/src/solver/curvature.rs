//! Curvature of the residuals, which their linear model lacks.
//!
//! ```text
//! ½ ∇∇S = Jᵀ J + Σᵢ rᵢ ∇∇rᵢ
//! ```
//!
//! The second part is left out by the search. Where the residuals are large and J has a weak direction, that part
//! decides: whether a point where the gradient vanishes is a minimum or a saddle, and where exactly the minimum is.

use crate::algebra::definite;
use crate::algebra::spectrum::{Spectrum, is_surely_of_full_rank};
use crate::problem::residuals::Residuals;
use crate::solver::evaluation::Scheme;
use crate::solver::iteration::{largest_cosine, loose};
use crate::solver::minimizer::{Attempt, Minimizer, Phase};
use crate::solver::outcome::Outcome;

/// The step of a difference of gradients in units of the values: its error is the square, and noise of 1e-10 in the
/// gradients becomes 1e-6.
const STEP: f64 = 1e-4;
/// Directions whose singular value is a smaller share of the largest may be ruled by the second derivatives.
const WEAK: f64 = 1e-6;
/// Steps along a direction of negative curvature, in units of the values.
const TRIALS: [f64; 4] = [1e-3, 1e-2, 0.1, 1.0];
/// The relative reduction of S over a step as long as the values that is no error of a difference.
const NEGATIVE: f64 = 1e-5;
/// A sharpening step that is relatively longer is no rounding of one.
const SHORT: f64 = 1e-9;
/// The share to which a step by the whole curvature must lower the gradient to be one.
const LOWER: f64 = 0.1;
/// Steps with one matrix of second derivatives; each gains about as many digits as the differences are good for.
const NEWTON_STEPS: usize = 6;

impl Minimizer {
    /// Leaves a point that is no minimum although the gradient vanishes, by way of a direction that the residuals
    /// hardly see to first order; whether there is one. It is tried once in a fit.
    pub(crate) fn leave_saddle<P: Residuals + ?Sized>(&mut self, problem: &P, reason: Outcome) -> bool {
        // Forward differences are refined where a direction is weak.
        let is_rough = self.evaluator.scheme == Scheme::Forward;
        if self.is_saddle_left || is_rough || is_surely_of_full_rank(&self.current.triangle, WEAK) {
            return false;
        }
        let Some(direction) = self.negative_direction(problem) else { return false };
        let here = Attempt { sum_of_squares: self.current.sum_of_squares, values: self.current.values.clone(), reason };
        let mut best: Option<Vec<f64>> = None;
        let mut least = here.sum_of_squares * (1.0 - 1e-9);
        for length in TRIALS.iter().flat_map(|length| [*length, -length]) {
            self.move_along(&here.values, &direction, length);
            if self.evaluator.residuals(problem, &mut self.trial) && self.trial.sum_of_squares < least {
                least = self.trial.sum_of_squares;
                best = Some(self.trial.values.clone());
            }
        }
        let Some(values) = best else { return false };
        self.trial.values = values;
        if !(self.evaluator.residuals(problem, &mut self.trial) && self.evaluator.factor(problem, &mut self.trial)) {
            return false;
        }
        std::mem::swap(&mut self.current, &mut self.trial);
        self.is_saddle_left = true;
        // Whatever comes of it, the fit ends no higher.
        self.best = Some(here);
        self.begin_search(problem);
        true
    }

    /// The values at a relative `length` along a direction of the free parameters, within the bounds, as the trial.
    fn move_along(&mut self, from: &[f64], direction: &[f64], length: f64) {
        let evaluator = &self.evaluator;
        self.trial.values.clear();
        self.trial.values.extend_from_slice(from);
        for (&j, d) in evaluator.free.iter().zip(direction) {
            self.trial.values[j] = (from[j] + length * d).max(evaluator.lower[j]).min(evaluator.upper[j]);
        }
    }

    /// A direction with next to no influence to first order along which S falls; its longest component is as long as
    /// its value.
    fn negative_direction<P: Residuals + ?Sized>(&mut self, problem: &P) -> Option<Vec<f64>> {
        let spectrum = Spectrum::of(&self.current.triangle);
        let rank = spectrum.rank(WEAK);
        let values = self.current.values.clone();
        let magnitudes: Vec<f64> =
            self.evaluator.free.iter().map(|&j| self.evaluator.magnitude(values[j], j)).collect();
        let to_size = |direction: Vec<f64>| {
            let relative = direction.iter().zip(&magnitudes).map(|(d, magnitude)| d.abs() / magnitude);
            let largest = relative.fold(0.0, f64::max);
            direction.iter().map(|d| d / largest).collect::<Vec<f64>>()
        };
        let null = spectrum.right[rank..].iter();
        let null = null.map(|right| to_size(right.iter().zip(&spectrum.scales).map(|(v, scale)| v / scale).collect()));
        let null: Vec<Vec<f64>> = null.filter(|direction| direction.iter().all(|d| d.is_finite())).collect();
        let mut bends = Vec::with_capacity(null.len());
        for direction in &null {
            bends.push(self.bend(problem, &values, direction)?);
        }
        let along = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        // Symmetric starts mix the directions in pairs.
        let mut lowest = (-NEGATIVE * self.current.sum_of_squares, None);
        for a in 0..null.len() {
            let own = along(&bends[a], &null[a]);
            if own < lowest.0 {
                lowest = (own, Some(null[a].clone()));
            }
            for b in 0..a {
                let mixed = 0.5 * (along(&bends[a], &null[b]) + along(&bends[b], &null[a]));
                // The angle at which (cos, sin) of the two has the lowest form.
                let other = along(&bends[b], &null[b]);
                let angle = 0.5 * (-2.0 * mixed).atan2(other - own);
                let (sin, cos) = angle.sin_cos();
                let form = own * cos * cos + other * sin * sin + 2.0 * mixed * sin * cos;
                if form < lowest.0 {
                    let both = null[a].iter().zip(&null[b]).map(|(x, y)| cos * x + sin * y);
                    lowest = (form, Some(to_size(both.collect())));
                }
            }
        }
        lowest.1
    }

    /// The change of the gradient along a direction of the free parameters, per unit of it.
    fn bend<P: Residuals + ?Sized>(&mut self, problem: &P, from: &[f64], direction: &[f64]) -> Option<Vec<f64>> {
        let mut gradients = [Vec::new(), Vec::new()];
        for (gradient, length) in gradients.iter_mut().zip([STEP, -STEP]) {
            self.move_along(from, direction, length);
            // Clamped to a bound, the difference would be that of another direction.
            let is_inside = self.evaluator.free.iter().zip(direction).all(|(&j, d)| {
                let target = from[j] + length * d;
                self.evaluator.lower[j] <= target && target <= self.evaluator.upper[j]
            });
            if !is_inside
                || !self.evaluator.residuals(problem, &mut self.trial)
                || !self.evaluator.differentiate(problem, &self.trial)
            {
                return None;
            }
            gradient.extend(self.evaluator.free.iter().map(|&j| self.evaluator.product(j, &self.trial.residuals)));
        }
        let [above, below] = gradients;
        let bend: Vec<f64> = above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * STEP)).collect();
        bend.iter().all(|b| b.is_finite()).then_some(bend)
    }

    /// Sharpens the minimum by Newton's method where steps by the linear model did not end, the last of them being
    /// `length` in units of the values. Only for exact derivatives: others are not worth it.
    pub(crate) fn sharpen_by_curvature<P: Residuals + ?Sized>(&mut self, problem: &P, length: f64) {
        if self.evaluator.scheme != Scheme::Exact || length <= SHORT || self.limit_reached().is_some() {
            return;
        }
        let columns: Vec<usize> = loose(&self.current, &self.evaluator).collect();
        let free = self.evaluator.free.clone();
        let values = self.current.values.clone();
        let mut matrix = Vec::with_capacity(columns.len() * columns.len());
        for &column in &columns {
            let mut direction = vec![0.0; free.len()];
            direction[column] = self.evaluator.magnitude(values[free[column]], free[column]);
            let Some(bend) = self.bend(problem, &values, &direction) else { return };
            matrix.extend(columns.iter().map(|&other| bend[other] / direction[column]));
        }
        let order = columns.len();
        for row in 0..order {
            for column in 0..row {
                let mean = 0.5 * (matrix[row * order + column] + matrix[column * order + row]);
                (matrix[row * order + column], matrix[column * order + row]) = (mean, mean);
            }
        }
        if !definite::factor(&mut matrix, order, |_| 0.0) {
            return;
        }
        for _ in 0..NEWTON_STEPS {
            let mut step: Vec<f64> = columns.iter().map(|&column| -self.current.triangle.gradient(column)).collect();
            definite::solve(&matrix, &mut step);
            let mut direction = vec![0.0; free.len()];
            columns.iter().zip(&step).for_each(|(&column, step)| direction[column] = *step);
            let from = self.current.values.clone();
            self.move_along(&from, &direction, 1.0);
            let tolerated = self.current.sum_of_squares * (1.0 + 1e-9);
            let is_sharper = self.evaluator.residuals(problem, &mut self.trial)
                && self.trial.sum_of_squares <= tolerated
                && self.evaluator.factor(problem, &mut self.trial)
                && largest_cosine(&self.trial, &self.evaluator)
                    < LOWER * largest_cosine(&self.current, &self.evaluator);
            if !is_sharper {
                return;
            }
            std::mem::swap(&mut self.current, &mut self.trial);
        }
    }

    /// True at the end of a search that counts.
    pub(crate) fn may_leave_saddle(&self, reason: Outcome) -> bool {
        reason.is_success() && reason != Outcome::AtNoiseFloor && matches!(self.phase, Phase::Search)
    }
}
