//! Derivatives by differences, and the choice of their steps.
//!
//! A step may go wrong in two ways that the difference alone does not show. It may cross a place where the model jumps,
//! and then the "derivative" is the jump over the step, larger than all others. Or it may be too short for the
//! residuals to tell it from none, and then the derivative is rounding over the step. Both are looked for where the
//! change of the residuals is out of proportion to them.

use crate::algebra::sums::sum_of_squares;
use crate::problem::residuals::{EvaluationError, Residuals};
use crate::solver::evaluation::{Evaluator, Point, Scheme};

/// A step that moves the residuals by more than this share of them may have crossed a jump.
const LARGE: f64 = 0.1;
/// Slopes to both sides that differ by less than this share of the larger are those of a smooth model.
const STRAIGHT: f64 = 0.5;
/// Changes of a residual by fewer of its last digits than this are rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// A change by this share of the residuals has lost half of the digits to rounding and none to curvature.
const CLEAR: f64 = 1e-6;
/// Halvings of the exponent between the smallest number and one that leave a factor of two.
const BISECTIONS: usize = 10;

/// Residuals at one or two other values of a parameter.
#[derive(Debug, Clone, Copy)]
struct Slope {
    /// The two displacements, 0 for the point itself, and the change of the residuals for each.
    displacements: [f64; 2],
    changes: [f64; 2],
    /// True if the slopes to both are alike; a single one is not known to be.
    is_straight: bool,
}

impl Slope {
    fn largest_change(&self) -> f64 {
        self.changes[0].max(self.changes[1])
    }

    /// The larger of the two slopes.
    fn steepest(&self) -> f64 {
        let slope =
            |k: usize| if self.displacements[k] == 0.0 { 0.0 } else { self.changes[k] / self.displacements[k].abs() };
        slope(0).max(slope(1))
    }

    fn may_have_jumped(&self, point: &Point) -> bool {
        !self.is_straight && self.largest_change() > LARGE * point.sum_of_squares.sqrt()
    }

    /// The side to look at instead: the one not seen, or of both the one where less happens.
    fn other_side(&self) -> f64 {
        let [a, b] = self.displacements;
        if a * b < 0.0 && self.changes[0] < self.changes[1] { a.signum() } else { -a.signum() }
    }
}

impl Evaluator {
    /// Size by which a step of parameter `j` from `value` is measured.
    pub(crate) fn magnitude(&self, value: f64, j: usize) -> f64 {
        let width = self.upper[j] - self.lower[j];
        let magnitude = value.abs().max(self.floor[j]);
        match (magnitude > 0.0, width.is_finite()) {
            (true, _) => magnitude,
            (false, true) => 1e-3 * width,
            (false, false) => 1.0,
        }
    }

    /// The magnitude of a value that nothing is known of.
    fn natural_magnitude(&self, j: usize) -> f64 {
        let width = self.upper[j] - self.lower[j];
        if width.is_finite() { 1e-3 * width } else { 1.0 }
    }

    /// Fills column `j` by differences that stay inside the bounds and, if possible, where the model is finite and
    /// does not jump.
    pub(crate) fn difference<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point, j: usize) {
        let magnitude = self.magnitude(point.values[j], j);
        let step = self.scheme.relative_step() * magnitude;
        match self.step(problem, point, j, step) {
            None => {
                for column in self.structure.columns_of(j) {
                    self.jacobian[column.elements].fill(f64::NAN);
                }
            }
            Some(slope) if self.is_hidden(point, j, &slope) => self.lengthen(problem, point, j, magnitude),
            Some(slope) if slope.may_have_jumped(point) => self.look_elsewhere(problem, point, j, &slope, step),
            Some(_) => {}
        }
        self.probe[j] = point.values[j];
    }

    /// A difference over `step`, to both sides or to one; `None` if the model is finite on neither.
    fn step<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point, j: usize, step: f64) -> Option<Slope> {
        let value = point.values[j];
        let (below, above) = (value - self.lower[j], self.upper[j] - value);
        let is_central = self.scheme != Scheme::Forward;
        let reach = if is_central { 2.0 * step } else { step };
        let mut found = None;
        if is_central && step <= below.min(above) {
            found = self.slope(problem, point, j, [value + step, value - step]);
        }
        if found.is_none() && above >= below.min(reach) {
            found = self.one_sided(problem, point, j, reach.min(above));
        }
        if found.is_none() && below > 0.0 {
            found = self.one_sided(problem, point, j, -reach.min(below));
        }
        if found.is_none() && above > 0.0 {
            found = self.one_sided(problem, point, j, reach.min(above));
        }
        found
    }

    fn one_sided<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point, j: usize, reach: f64) -> Option<Slope> {
        let value = point.values[j];
        let near = if self.scheme == Scheme::Forward { value } else { value + 0.5 * reach };
        self.slope(problem, point, j, [value + reach, near])
    }

    /// Takes the derivative from the other side if the model is that much flatter there: what was seen is a jump.
    fn look_elsewhere<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point, j: usize, seen: &Slope, step: f64) {
        let value = point.values[j];
        let reach = if self.scheme == Scheme::Forward { step } else { 2.0 * step };
        let side = seen.other_side();
        let room = if side > 0.0 { self.upper[j] - value } else { value - self.lower[j] };
        if room <= 0.0 {
            return;
        }
        self.keep(j);
        let other = self.one_sided(problem, point, j, side * reach.min(room));
        if other.is_none_or(|other| other.steepest() >= STRAIGHT * seen.steepest()) {
            self.put_back(j);
        }
    }

    /// Lengthens a step that the residuals do not show until they do, at most to what suits a value of which nothing is
    /// known. Without any change there the parameter counts as without influence.
    fn lengthen<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point, j: usize, magnitude: f64) {
        let relative = self.scheme.relative_step();
        let (mut hidden, mut seen) = (magnitude, self.natural_magnitude(j));
        let longest = if seen > hidden { self.step(problem, point, j, relative * seen) } else { None };
        if longest.is_none_or(|slope| self.is_hidden(point, j, &slope)) {
            for column in self.structure.columns_of(j) {
                self.jacobian[column.elements].fill(0.0);
            }
            return;
        }
        let clear = CLEAR * point.sum_of_squares.sqrt();
        for _ in 0..BISECTIONS {
            let middle = hidden.sqrt() * seen.sqrt();
            self.keep(j);
            match self.step(problem, point, j, relative * middle) {
                None => {
                    self.put_back(j);
                    return;
                }
                Some(slope) if self.is_hidden(point, j, &slope) => {
                    self.put_back(j);
                    hidden = middle;
                }
                Some(slope) if slope.largest_change() > clear => seen = middle,
                Some(_) => return,
            }
        }
    }

    /// True if rounding would change the residuals by as much.
    fn is_hidden(&self, point: &Point, j: usize, slope: &Slope) -> bool {
        let is_empty = point.residuals.is_empty();
        if is_empty || slope.largest_change() > ROUNDING * point.sum_of_squares.sqrt() {
            return false;
        }
        // Few residuals may be so large that they hide what the step does to all others.
        let mut sizes: Vec<f64> = point.residuals.iter().map(|r| r.abs()).collect();
        let middle = sizes.len() / 2;
        let typical = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        let reach = slope.displacements[0].abs().max(slope.displacements[1].abs());
        self.structure.columns_of(j).all(|column| {
            let mut both = self.jacobian[column.elements].iter().zip(&point.residuals[column.rows]);
            both.all(|(derivative, r)| derivative.abs() * reach <= ROUNDING * r.abs().max(typical))
        })
    }

    fn keep(&mut self, j: usize) {
        self.kept.clear();
        for column in self.structure.columns_of(j) {
            self.kept.extend_from_slice(&self.jacobian[column.elements]);
        }
    }

    fn put_back(&mut self, j: usize) {
        let mut first = 0;
        for column in self.structure.columns_of(j) {
            let length = column.elements.len();
            self.jacobian[column.elements].copy_from_slice(&self.kept[first..first + length]);
            first += length;
        }
    }

    /// The derivative at `point` of the parabola through the residuals there and at two other values of parameter
    /// `j`; of the line through two points if one of the values is that of `point`. `None` if the residuals are not
    /// finite at the two values.
    fn slope<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point, j: usize, at: [f64; 2]) -> Option<Slope> {
        let [first, second] = at.map(|target| target.max(self.lower[j]).min(self.upper[j]));
        let value = point.values[j];
        // Differences of the values as they are stored, not as they were wished.
        let (a, b) = (first - value, second - value);
        self.probe[j] = first;
        if a == 0.0 || a == b || self.probe_columns(problem, j).is_err() {
            return None;
        }
        if b != 0.0 {
            self.probe[j] = second;
            if self.probe_scratch(problem, j).is_err() {
                return None;
            }
        }
        let mut square = 0.0;
        let mut changes = [0.0; 2];
        let mut bend = 0.0;
        for column in self.structure.columns_of(j) {
            let elements = &mut self.jacobian[column.elements];
            let residuals = &point.residuals[column.rows.clone()];
            if b == 0.0 {
                for (c, r) in elements.iter_mut().zip(residuals) {
                    *c = (*c - r) / a;
                }
            } else {
                let (weight_a, weight_b) = parabola(a, b);
                for ((c, s), r) in elements.iter_mut().zip(&self.scratch[column.rows]).zip(residuals) {
                    let (by_a, by_b) = (*c - r, s - r);
                    changes[0] += by_a * by_a;
                    changes[1] += by_b * by_b;
                    let difference = by_a / a - by_b / b;
                    bend += difference * difference;
                    *c = weight_a * by_a + weight_b * by_b;
                }
            }
            square += sum_of_squares(elements);
        }
        let changes = if b == 0.0 { [square.sqrt() * a.abs(), 0.0] } else { changes.map(f64::sqrt) };
        let mut slope = Slope { displacements: [a, b], changes, is_straight: false };
        slope.is_straight = b != 0.0 && bend.sqrt() <= STRAIGHT * slope.steepest();
        square.is_finite().then_some(slope)
    }

    /// Writes the residuals at `probe` to the columns of parameter `j`.
    fn probe_columns<P: Residuals + ?Sized>(&mut self, problem: &P, j: usize) -> Result<(), EvaluationError> {
        if self.structure.is_dense() {
            self.residual_evaluations += 1;
            let rows = self.scratch.len();
            return problem.evaluate(&self.probe, &mut self.jacobian[j * rows..(j + 1) * rows], None);
        }
        self.probe_scratch(problem, j)?;
        for column in self.structure.columns_of(j) {
            self.jacobian[column.elements].copy_from_slice(&self.scratch[column.rows]);
        }
        Ok(())
    }

    /// Writes the residuals at `probe` that depend on parameter `j` to their places in `scratch`.
    fn probe_scratch<P: Residuals + ?Sized>(&mut self, problem: &P, j: usize) -> Result<(), EvaluationError> {
        if !self.structure.is_dense() && !self.is_indivisible {
            for column in self.structure.columns_of(j) {
                // Blocks count by their share of the residuals.
                self.evaluated_rows += column.rows.len();
                if !problem.block_residuals(column.block, &self.probe, &mut self.scratch[column.rows])? {
                    self.is_indivisible = true;
                    self.evaluated_rows = 0;
                    break;
                }
            }
            let all = self.scratch.len().max(1);
            self.residual_evaluations += self.evaluated_rows / all;
            self.evaluated_rows %= all;
            if !self.is_indivisible {
                return Ok(());
            }
        }
        self.residual_evaluations += 1;
        problem.evaluate(&self.probe, &mut self.scratch, None)
    }
}

/// The weights of `f_a − f` and `f_b − f` in the derivative of the parabola through `f` and two neighbours.
///
/// ```text
/// f′ = (a² (f_b − f) − b² (f_a − f)) / (a b (a − b)),   distances a, b
/// ```
///
/// For a = −b this is the central difference.
pub(crate) fn parabola(a: f64, b: f64) -> (f64, f64) {
    (-b / (a * (a - b)), a / (b * (a - b)))
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use fmm_model::{Bounds, Parameter};

    use super::*;

    /// r = exp(θ), finite below `edge` only; notes every value asked for.
    struct Exponential {
        parameters: [Parameter; 1],
        edge: f64,
        asked: RefCell<Vec<f64>>,
    }

    impl Residuals for Exponential {
        fn parameters(&self) -> &[Parameter] {
            &self.parameters
        }
        fn len(&self) -> usize {
            1
        }
        fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
            self.asked.borrow_mut().push(p[0]);
            residuals[0] = if p[0] > self.edge { f64::NAN } else { p[0].exp() };
            Ok(())
        }
    }

    fn slope(scheme: Scheme, value: f64, bounds: (f64, f64), edge: f64) -> f64 {
        let parameter = Parameter::new("rate", "b", "1/s").bounded(Bounds::new(bounds.0, bounds.1).unwrap());
        let problem = Exponential { parameters: [parameter], edge, asked: RefCell::default() };
        let mut evaluator = Evaluator::default();
        evaluator.begin(&problem, std::iter::once(bounds), &[value]).unwrap();
        let mut point = Point { values: vec![value], ..Point::default() };
        assert!(evaluator.residuals(&problem, &mut point));
        evaluator.scheme = scheme;
        evaluator.factor(&problem, &mut point);
        for asked in problem.asked.borrow().iter() {
            assert!(bounds.0 <= *asked && *asked <= bounds.1, "evaluated at {asked}, outside the bounds");
        }
        evaluator.jacobian[0]
    }

    #[test]
    fn differences_stay_inside_and_keep_their_order() {
        let (inf, exact) = (f64::INFINITY, 1f64.exp());
        // Truncation h/2 = 7e-9 and h²/6 = 6e-12 or, to one side, (h²/3) 2e-11, plus rounding ε/h of 4e-8 and 1e-10.
        for (scheme, tolerance) in [(Scheme::Forward, 1e-7), (Scheme::Central, 1e-9)] {
            for bounds in [(-inf, inf), (1.0, inf), (-inf, 1.0), (1.0 - 1e-9, 1.0 + 1e-9), (0.0, 1.0 + 1e-7)] {
                let error = slope(scheme, 1.0, bounds, inf) - exact;
                let tolerance = if bounds.1 - bounds.0 < 1e-8 { 1e-5 } else { tolerance };
                assert!(error.abs() < tolerance, "{scheme:?} in {bounds:?}: error {error}");
            }
            let error = slope(scheme, 1.0, (-inf, inf), 1.0) - exact;
            assert!(error.abs() < tolerance, "{scheme:?} at the edge of the model: error {error}");
        }
    }

    #[test]
    fn a_value_of_zero_has_a_step() {
        assert!((slope(Scheme::Forward, 0.0, (0.0, f64::INFINITY), f64::INFINITY) - 1.0).abs() < 1e-7);
        assert!((slope(Scheme::Central, 0.0, (-1.0, 1.0), f64::INFINITY) - 1.0).abs() < 1e-7);
    }
}
