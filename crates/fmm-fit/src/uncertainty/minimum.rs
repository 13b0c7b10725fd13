//! Derivatives of a minimum with respect to fixed values.

use fmm_model::Parameter;

use crate::algebra::definite;
use crate::algebra::spectrum::Spectrum;
use crate::algebra::sums::dot;
use crate::algebra::triangle::Triangle;
use crate::error::FitError;
use crate::problem::residuals::{Derivatives, Residuals};
use crate::result::estimate::{Estimate, EstimateStatus};
use crate::result::fit::Fit;
use crate::solver::differences::parabola;
use crate::solver::evaluation::{Evaluator, Point, Scheme};
use crate::uncertainty::sensitivity::Sensitivity;

/// A minimum with its derivatives, from which the response follows.
pub(crate) struct Minimum<'a, P: ?Sized> {
    problem: &'a P,
    fit: &'a Fit,
    evaluator: Evaluator,
    point: Point,
    /// Parameters neither fixed nor at a bound.
    inside: Vec<usize>,
    inputs: Vec<usize>,
    /// Jᵀ r over the parameters inside.
    gradient: Vec<f64>,
}

/// Below this share of the influence of the most influential value, a value is zero to rounding and tells nothing of
/// the size of a step.
const ZERO: f64 = 1e-8;

impl<'a, P: Residuals + ?Sized> Minimum<'a, P> {
    /// The minimum that `fit` found.
    ///
    /// # Errors
    /// [`FitError`] if it is none of `problem`, or has no derivatives.
    pub(crate) fn new(problem: &'a P, fit: &'a Fit) -> Result<Self, FitError> {
        let own = problem.parameters().iter().map(Parameter::name);
        if !own.eq(fit.estimates().iter().map(Estimate::name)) || problem.len() != fit.residuals().len() {
            return Err(FitError::OtherFit {
                what: "the fit is not one of this problem: their parameters or numbers of residuals differ".to_owned(),
            });
        }
        if !fit.outcome().is_success() {
            return Err(FitError::no_minimum("the fit has not converged, and only a minimum has a sensitivity"));
        }
        let select = |wanted: fn(EstimateStatus) -> bool| -> Vec<usize> {
            let statuses = fit.estimates().iter().map(Estimate::status).enumerate();
            statuses.filter(|(_, status)| wanted(*status)).map(|(j, _)| j).collect()
        };
        let inputs = select(|status| status == EstimateStatus::Fixed);
        let inside = select(|status| status != EstimateStatus::Fixed && !status.is_at_bound());
        let bounds = problem.parameters().iter().map(|parameter| match parameter.bounds() {
            bounds if bounds.is_fixed() => (f64::NEG_INFINITY, f64::INFINITY),
            bounds => (bounds.lower(), bounds.upper()),
        });
        let mut evaluator = Evaluator::default();
        evaluator.begin(problem, bounds, fit.values())?;
        evaluator.free = select(|status| !status.is_at_bound());
        if !fit.has_exact_jacobian() {
            evaluator.scheme = Scheme::Central;
        } else if problem.derivatives() != Derivatives::All {
            evaluator.unfilled.clone_from(&inputs);
        }
        let point = Point {
            values: fit.values().to_vec(),
            residuals: fit.residuals().to_vec(),
            sum_of_squares: fit.sum_of_squares(),
            triangle: Triangle::default(),
        };
        let mut minimum = Self { problem, fit, evaluator, point, inside, inputs, gradient: Vec::new() };
        minimum.differentiate()?;
        let is_stepped = minimum.evaluator.scheme != Scheme::Exact || !minimum.evaluator.unfilled.is_empty();
        if minimum.remember_scales() && is_stepped {
            minimum.differentiate()?;
        }
        let product = |&j: &usize| minimum.evaluator.product(j, fit.residuals());
        minimum.gradient = minimum.inside.iter().map(product).collect();
        Ok(minimum)
    }

    fn differentiate(&mut self) -> Result<(), FitError> {
        if self.evaluator.factor(self.problem, &mut self.point) {
            return Ok(());
        }
        let column = self.evaluator.first_bad_column().unwrap_or(0);
        Err(self.no_derivative(column))
    }

    fn no_derivative(&self, parameter: usize) -> FitError {
        let parameter = self.problem.parameters()[parameter].name();
        let reason = self.evaluator.non_finite.as_ref().map_or_else(String::new, |reason| format!(": {reason}"));
        FitError::no_model(format!("there is no derivative by {parameter} at or near its value{reason}"))
    }

    /// Gives values that are zero the magnitude at which they would matter; whether there is one.
    fn remember_scales(&mut self) -> bool {
        let norms: Vec<f64> = (0..self.evaluator.free.len()).map(|c| self.point.triangle.column_norm(c)).collect();
        let influence = |(norm, &j): (&f64, &usize)| norm * self.point.values[j].abs();
        let largest = norms.iter().zip(&self.evaluator.free).map(influence).fold(0.0, f64::max);
        let mut scales = vec![0.0; self.point.values.len()];
        for (norm, &j) in norms.iter().zip(&self.evaluator.free) {
            if norm * self.point.values[j].abs() <= ZERO * largest && *norm > 0.0 {
                scales[j] = largest / norm;
            }
        }
        self.evaluator.remember_magnitudes(&scales);
        scales.iter().any(|scale| *scale > 0.0)
    }

    /// Solves for the response in coordinates in which Jᵀ J is the unit matrix.
    ///
    /// ```text
    /// J S⁻¹ = U Σ Vᵀ,   W = S⁻¹ V Σ⁻¹:     ∂θ/∂α = −W (1 + Wᵀ H W)⁻¹ (Uᵀ ∂r/∂α + Wᵀ G)
    /// ```
    ///
    /// with H and G the sums over second derivatives, and only the directions that the residuals determine.
    pub(crate) fn respond(mut self, is_exact: bool) -> Result<Sensitivity, FitError> {
        let place = |j: &usize| self.evaluator.free.binary_search(j).unwrap_or(0);
        let columns: Vec<usize> = self.inside.iter().map(place).collect();
        let places: Vec<usize> = self.inputs.iter().map(place).collect();
        let spectrum = self.spectrum(&columns, |_| 0.0);
        let rank = spectrum.rank(self.evaluator.scheme.rank_threshold(self.point.residuals.len()));
        let along = |&place: &usize| {
            let column = |row: usize| if row > place { 0.0 } else { self.point.triangle.r(row, place) };
            self.spectrum(&columns, column).along[..rank].to_vec()
        };
        let mut right: Vec<Vec<f64>> = places.iter().map(along).collect();
        let whiten = |direction: usize| -> Vec<f64> {
            let scaled = spectrum.right[direction].iter().zip(&spectrum.scales);
            scaled.map(|(v, scale)| v / scale / spectrum.singular[direction]).collect()
        };
        let basis: Vec<Vec<f64>> = (0..rank).map(whiten).collect();

        let mut matrix: Vec<Vec<f64>> = (0..rank).map(|i| (0..rank).map(|j| f64::from(i == j)).collect()).collect();
        if is_exact && !self.inputs.is_empty() {
            self.evaluator.free.clone_from(&self.inside);
            self.evaluator.unfilled.clear();
            let hessian = self.second_derivatives(&self.inside.clone())?;
            for (i, row) in matrix.iter_mut().enumerate() {
                for (j, element) in row.iter_mut().enumerate() {
                    // The matrix is symmetric up to the error of the differences.
                    let both = bilinear(&hessian, &basis[i], &basis[j]) + bilinear(&hessian, &basis[j], &basis[i]);
                    *element += 0.5 * both;
                }
            }
            let mixed = self.second_derivatives(&self.inputs.clone())?;
            for (side, by_input) in right.iter_mut().zip(&mixed) {
                for (element, direction) in side.iter_mut().zip(&basis) {
                    *element += dot(direction, by_input);
                }
            }
        }
        let mut factored = matrix.concat();
        if !definite::factor(&mut factored, matrix.len(), |_| 0.0) {
            return Err(FitError::no_minimum(
                "the second derivatives at the fitted values are not those of a minimum, so that these do not follow \
                 the inputs",
            ));
        }
        for side in &mut right {
            definite::solve(&factored, side);
        }
        Ok(self.assemble(&basis, &right))
    }

    /// The decomposition of these columns, with `right` in the place of the residuals.
    fn spectrum(&self, columns: &[usize], right: impl Fn(usize) -> f64) -> Spectrum {
        let mut triangle = Triangle::default();
        triangle.select(&self.point.triangle, columns, right, &mut Vec::new());
        Spectrum::of(&triangle)
    }

    fn assemble(&self, basis: &[Vec<f64>], solutions: &[Vec<f64>]) -> Sensitivity {
        let coefficient = |j: usize, solution: &[f64]| match self.fit.estimates()[j].status() {
            EstimateStatus::AtLowerBound | EstimateStatus::AtUpperBound => Some(0.0),
            EstimateStatus::Determined => {
                let row = self.inside.binary_search(&j).ok()?;
                Some(-basis.iter().zip(solution).map(|(direction, along)| direction[row] * along).sum::<f64>())
            }
            _ => None,
        };
        let all = 0..self.problem.parameters().len();
        let coefficients = all.flat_map(|j| solutions.iter().map(move |solution| coefficient(j, solution))).collect();
        Sensitivity { parameters: self.problem.parameters().to_vec(), inputs: self.inputs.clone(), coefficients }
    }

    /// Σᵢ rᵢ ∂²rᵢ/∂θⱼ∂θₖ for each k of `parameters`, over the parameters j inside.
    fn second_derivatives(&mut self, parameters: &[usize]) -> Result<Vec<Vec<f64>>, FitError> {
        parameters.iter().map(|&k| self.second_derivative(k).ok_or_else(|| self.no_derivative(k))).collect()
    }

    fn second_derivative(&mut self, k: usize) -> Option<Vec<f64>> {
        let value = self.point.values[k];
        let step = self.evaluator.scheme.relative_step_of_derivatives() * self.evaluator.magnitude(value, k);
        let (below, above) = (value - self.evaluator.lower[k], self.evaluator.upper[k] - value);
        let (down, up) = ((2.0 * step).min(below), (2.0 * step).min(above));
        let central = [step, -step];
        let inwards = if above >= below {
            [[up, 0.5 * up], [-down, -0.5 * down]]
        } else {
            [[-down, -0.5 * down], [up, 0.5 * up]]
        };
        let stencils = std::iter::once(central).filter(|_| step <= below.min(above)).chain(inwards);
        for stencil in stencils {
            let [first, second] = stencil.map(|distance| value + distance);
            let (a, b) = (first - value, second - value);
            if a == 0.0 || b == 0.0 || a == b {
                continue;
            }
            let (Some(at_first), Some(at_second)) = (self.gradient_at(k, first), self.gradient_at(k, second)) else {
                continue;
            };
            let (weight_a, weight_b) = parabola(a, b);
            let difference = |((a, b), g): ((&f64, &f64), &f64)| weight_a * (a - g) + weight_b * (b - g);
            return Some(at_first.iter().zip(&at_second).zip(&self.gradient).map(difference).collect());
        }
        None
    }

    /// Jᵀ r with the Jacobian where parameter `k` has another value, and the residuals of the minimum.
    fn gradient_at(&mut self, k: usize, value: f64) -> Option<Vec<f64>> {
        let mut moved = Point { values: self.point.values.clone(), ..Point::default() };
        moved.values[k] = value;
        let needs_residuals = self.evaluator.scheme != Scheme::Exact;
        if needs_residuals && !self.evaluator.residuals(self.problem, &mut moved) {
            return None;
        }
        if !self.evaluator.differentiate(self.problem, &moved) {
            return None;
        }
        let gradient: Vec<f64> =
            self.inside.iter().map(|&j| self.evaluator.product(j, &self.point.residuals)).collect();
        gradient.iter().all(|g| g.is_finite()).then_some(gradient)
    }
}

/// `aᵀ M b`, with `M` column by column.
fn bilinear(columns: &[Vec<f64>], a: &[f64], b: &[f64]) -> f64 {
    columns.iter().zip(b).map(|(column, b)| dot(column, a) * b).sum()
}
