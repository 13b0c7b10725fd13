//! Asking the problem for residuals and derivatives, by differences where it has none.

use crate::Residuals;
use crate::triangle::{Triangle, dot};

/// Where the derivatives come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Scheme {
    /// The problem gives them.
    #[default]
    Exact,
    /// Differences to one side, error about 1e-8.
    Forward,
    /// Differences to both sides, error about 1e-10.
    Central,
}

impl Scheme {
    /// The ratio of singular values below which a direction is not distinguishable from none.
    pub(crate) fn rank_threshold(self, residuals: usize) -> f64 {
        let rounding = residuals as f64 * f64::EPSILON;
        rounding.max(match self {
            Self::Exact => 0.0,
            Self::Forward => 1e-6,
            Self::Central => 1e-9,
        })
    }

    /// The relative step that balances truncation against rounding.
    fn relative_step(self) -> f64 {
        if self == Self::Central { f64::EPSILON.cbrt() } else { f64::EPSILON.sqrt() }
    }
}

/// Everything known at some values of the parameters.
#[derive(Debug, Clone, Default)]
pub(crate) struct Point {
    pub(crate) values: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
    pub(crate) sum_of_squares: f64,
    /// Factor of the columns of the free parameters.
    pub(crate) triangle: Triangle,
}

/// Counts, buffers and the choice of derivatives during a fit.
#[derive(Debug, Clone, Default)]
pub(crate) struct Evaluator {
    pub(crate) scheme: Scheme,
    /// Indices of the parameters that are not fixed.
    pub(crate) free: Vec<usize>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    pub(crate) residual_evaluations: usize,
    pub(crate) jacobian_evaluations: usize,
    /// What the model said when it last failed at a trial point.
    pub(crate) model_error: Option<String>,
    /// The magnitude below which a value counts as zero in the choice of a difference step.
    floor: Vec<f64>,
    jacobian: Vec<f64>,
    is_jacobian_current: bool,
    probe: Vec<f64>,
    scratch: Vec<f64>,
    block: Vec<f64>,
}

impl Evaluator {
    /// Prepares for `residuals` residuals of parameters within `bounds`, beginning at `start`.
    pub(crate) fn begin(&mut self, residuals: usize, bounds: impl Iterator<Item = (f64, f64)>, start: &[f64]) {
        (self.lower, self.upper) = bounds.unzip();
        self.free.clear();
        self.free.extend((0..start.len()).filter(|&j| self.lower[j] < self.upper[j]));
        self.scheme = Scheme::Exact;
        (self.residual_evaluations, self.jacobian_evaluations) = (0, 0);
        self.model_error = None;
        self.is_jacobian_current = false;
        self.jacobian.resize(if self.free.is_empty() { 0 } else { residuals * start.len() }, 0.0);
        self.floor.clear();
        self.floor.resize(start.len(), 0.0);
        self.remember_magnitudes(start);
    }

    /// Keeps the largest magnitude of each value in mind, so that a value passing through zero has a sensible
    /// difference step.
    pub(crate) fn remember_magnitudes(&mut self, values: &[f64]) {
        for (floor, value) in self.floor.iter_mut().zip(values) {
            *floor = floor.max(1e-3 * value.abs());
        }
    }

    /// Evaluates the residuals at `point.values`; false if the model has no finite value there.
    pub(crate) fn residuals<P: Residuals + ?Sized>(&mut self, problem: &P, point: &mut Point) -> bool {
        self.residual_evaluations += 1;
        self.is_jacobian_current = false;
        point.residuals.resize(problem.len(), 0.0);
        let combined = self.scheme == Scheme::Exact && !self.free.is_empty() && problem.is_cheaper_combined();
        let result = if combined {
            self.jacobian_evaluations += 1;
            problem.residuals_and_jacobian(&point.values, &mut point.residuals, &mut self.jacobian)
        } else {
            problem.residuals(&point.values, &mut point.residuals).map(|()| false)
        };
        match result {
            Ok(is_jacobian_current) => self.is_jacobian_current = is_jacobian_current,
            Err(error) => {
                self.model_error = Some(error.to_string());
                point.sum_of_squares = f64::NAN;
                return false;
            }
        }
        point.sum_of_squares = dot(&point.residuals, &point.residuals);
        point.sum_of_squares.is_finite()
    }

    /// Evaluates the Jacobian at a point that has its residuals, and factors it; false if it is not finite.
    pub(crate) fn factor<P: Residuals + ?Sized>(&mut self, problem: &P, point: &mut Point) -> bool {
        if !self.is_jacobian_current && self.scheme == Scheme::Exact {
            self.jacobian_evaluations += 1;
            match problem.jacobian(&point.values, &mut self.jacobian) {
                Ok(true) => {}
                Ok(false) => {
                    self.jacobian_evaluations = 0;
                    self.scheme = Scheme::Forward;
                }
                Err(error) => {
                    self.model_error = Some(error.to_string());
                    return false;
                }
            }
        }
        self.is_jacobian_current = false;
        if self.scheme != Scheme::Exact {
            self.scratch.resize(point.residuals.len(), 0.0);
            self.probe.clone_from(&point.values);
            for index in 0..self.free.len() {
                self.difference(problem, point, self.free[index]);
            }
        }
        point.triangle.factor(&self.jacobian, &self.free, &point.residuals, &mut self.block);
        point.triangle.is_finite()
    }

    /// The first free parameter whose column of the Jacobian is not finite.
    pub(crate) fn first_bad_column(&self, residuals: usize) -> Option<usize> {
        let norm = |j: usize| {
            let column = &self.jacobian[j * residuals..(j + 1) * residuals];
            dot(column, column)
        };
        self.free.iter().copied().find(|&j| !norm(j).is_finite())
    }

    /// Fills column `j` by differences that stay inside the bounds and, if possible, where the model is finite.
    fn difference<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point, j: usize) {
        let value = point.values[j];
        let (below, above) = (value - self.lower[j], self.upper[j] - value);
        let width = below + above;
        let magnitude = value.abs().max(self.floor[j]);
        let magnitude = match (magnitude > 0.0, width.is_finite()) {
            (true, _) => magnitude,
            (false, true) => 1e-3 * width,
            (false, false) => 1.0,
        };
        let step = self.scheme.relative_step() * magnitude;
        let reach = if self.scheme == Scheme::Central { 2.0 * step } else { step };
        let found = (self.scheme == Scheme::Central
            && step <= below.min(above)
            && self.slope(problem, point, j, [value + step, value - step]))
            || (above >= below.min(reach) && self.one_sided(problem, point, j, reach.min(above)))
            || (below > 0.0 && self.one_sided(problem, point, j, -reach.min(below)))
            || (above > 0.0 && self.one_sided(problem, point, j, reach.min(above)));
        if !found {
            self.jacobian[j * point.residuals.len()..][..point.residuals.len()].fill(f64::NAN);
        }
        self.probe[j] = value;
    }

    fn one_sided<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point, j: usize, reach: f64) -> bool {
        let value = point.values[j];
        let near = if self.scheme == Scheme::Central { value + 0.5 * reach } else { value };
        self.slope(problem, point, j, [value + reach, near])
    }

    /// The derivative at `point` of the parabola through the residuals there and at two other values of parameter
    /// `j`; of the line through two points if one of the values is that of `point`.
    ///
    /// ```text
    /// r′ = (a² (r_b − r) − b² (r_a − r)) / (a b (a − b)),   distances a, b
    /// ```
    ///
    /// For a = −b this is the central difference. False if the residuals are not finite at the two values.
    fn slope<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point, j: usize, at: [f64; 2]) -> bool {
        let n = point.residuals.len();
        let [first, second] = at.map(|target| target.max(self.lower[j]).min(self.upper[j]));
        let value = point.values[j];
        // Differences of the values as they are stored, not as they were wished.
        let (a, b) = (first - value, second - value);
        self.probe[j] = first;
        let column = &mut self.jacobian[j * n..(j + 1) * n];
        self.residual_evaluations += 1;
        if a == 0.0 || a == b || problem.residuals(&self.probe, column).is_err() {
            return false;
        }
        if b == 0.0 {
            for (c, r) in column.iter_mut().zip(&point.residuals) {
                *c = (*c - r) / a;
            }
        } else {
            self.probe[j] = second;
            self.residual_evaluations += 1;
            if problem.residuals(&self.probe, &mut self.scratch).is_err() {
                return false;
            }
            let (weight_a, weight_b) = (-b / (a * (a - b)), a / (b * (a - b)));
            for ((c, s), r) in column.iter_mut().zip(&self.scratch).zip(&point.residuals) {
                *c = weight_a * (*c - r) + weight_b * (s - r);
            }
        }
        dot(column, column).is_finite()
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use fmm_model::{Bounds, Parameter};

    use super::*;
    use crate::EvaluationError;

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
        fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
            self.asked.borrow_mut().push(p[0]);
            residuals[0] = if p[0] > self.edge { f64::NAN } else { p[0].exp() };
            Ok(())
        }
    }

    fn slope(scheme: Scheme, value: f64, bounds: (f64, f64), edge: f64) -> f64 {
        let parameter = Parameter::new("rate", "b", "1/s").bounded(Bounds::new(bounds.0, bounds.1).unwrap());
        let problem = Exponential { parameters: [parameter], edge, asked: RefCell::default() };
        let mut evaluator = Evaluator::default();
        evaluator.begin(1, std::iter::once(bounds), &[value]);
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
