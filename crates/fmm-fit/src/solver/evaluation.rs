//! Evaluation of residuals and derivatives, by differences where the problem has none.

use crate::algebra::sums::sum_of_squares;
use crate::algebra::triangle::Triangle;
use crate::error::FitError;
use crate::problem::block::{Scratch, Structure};
use crate::problem::residuals::{Derivatives, Residuals};
use crate::solver::outcome::{NonFinite, worst};

/// Source of the derivatives.
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

    /// [`relative_step`](Self::relative_step) for central differences of derivatives that come by this scheme.
    pub(crate) fn relative_step_of_derivatives(self) -> f64 {
        match self {
            Self::Exact => f64::EPSILON.cbrt(),
            // The error of central differences, 1e-10, in the place of rounding.
            Self::Forward | Self::Central => 1e-10f64.cbrt(),
        }
    }

    /// The relative step that balances truncation against rounding.
    pub(crate) fn relative_step(self) -> f64 {
        if self == Self::Forward { f64::EPSILON.sqrt() } else { f64::EPSILON.cbrt() }
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

/// A problem about some values of its parameters.
#[derive(Debug)]
pub(crate) struct Linearised {
    pub(crate) residuals: Vec<f64>,
    pub(crate) structure: Structure,
    pub(crate) jacobian: Vec<f64>,
    pub(crate) scheme: Scheme,
}

/// Counts, buffers and the choice of derivatives during a fit.
#[derive(Debug, Clone, Default)]
pub(crate) struct Evaluator {
    pub(crate) scheme: Scheme,
    /// Indices of the parameters that are not fixed.
    pub(crate) free: Vec<usize>,
    /// Those of them whose columns a problem with derivatives does not fill.
    pub(crate) unfilled: Vec<usize>,
    /// Places of the elements of the Jacobian.
    pub(crate) structure: Structure,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    pub(crate) residual_evaluations: usize,
    pub(crate) jacobian_evaluations: usize,
    /// The last number that was not finite.
    pub(crate) non_finite: Option<NonFinite>,
    /// The magnitude below which a value counts as zero in the choice of a difference step.
    pub(crate) floor: Vec<f64>,
    pub(crate) jacobian: Vec<f64>,
    is_jacobian_current: bool,
    pub(crate) probe: Vec<f64>,
    pub(crate) scratch: Vec<f64>,
    /// A column while that of another step is tried.
    pub(crate) kept: Vec<f64>,
    factoring: Scratch,
    /// True if the problem gives blocks only all together.
    pub(crate) is_indivisible: bool,
    /// Residuals of blocks evaluated alone, not yet enough for an evaluation of all.
    pub(crate) evaluated_rows: usize,
}

impl Evaluator {
    /// An evaluator of `problem` within its bounds, about `values`.
    pub(crate) fn of<P: Residuals + ?Sized>(problem: &P, values: &[f64]) -> Result<Self, FitError> {
        let mut evaluator = Self::default();
        let bounds = problem.parameters().iter().map(fmm_model::Parameter::bounds);
        evaluator.begin(problem, bounds.map(|bounds| (bounds.lower(), bounds.upper())), values)?;
        Ok(evaluator)
    }

    /// Prepares for `problem` with its parameters within `bounds`, beginning at `start`.
    ///
    /// # Errors
    /// [`FitError`] if the blocks of the problem do not fit it.
    pub(crate) fn begin<P: Residuals + ?Sized>(
        &mut self,
        problem: &P,
        bounds: impl Iterator<Item = (f64, f64)>,
        start: &[f64],
    ) -> Result<(), FitError> {
        self.structure = Structure::of(problem)?;
        (self.lower, self.upper) = bounds.unzip();
        self.free.clear();
        self.free.extend((0..start.len()).filter(|&j| self.lower[j] < self.upper[j]));
        self.unfilled.clear();
        self.scheme = if problem.derivatives() == Derivatives::None { Scheme::Forward } else { Scheme::Exact };
        (self.residual_evaluations, self.jacobian_evaluations, self.evaluated_rows) = (0, 0, 0);
        self.non_finite = None;
        self.is_jacobian_current = false;
        self.is_indivisible = false;
        self.jacobian.resize(if self.free.is_empty() { 0 } else { self.structure.len() }, 0.0);
        self.floor.clear();
        self.floor.resize(start.len(), 0.0);
        self.remember_magnitudes(start);
        Ok(())
    }

    /// Keeps the largest magnitude of each value in mind, so that a value passing through zero has a sensible
    /// difference step.
    pub(crate) fn remember_magnitudes(&mut self, values: &[f64]) {
        for (floor, value) in self.floor.iter_mut().zip(values) {
            *floor = floor.max(1e-3 * value.abs());
        }
    }

    /// Evaluates the residuals at `point.values`, and the derivatives with them where that is cheap; false if the model
    /// has no finite value there.
    pub(crate) fn residuals<P: Residuals + ?Sized>(&mut self, problem: &P, point: &mut Point) -> bool {
        self.evaluate(problem, point, problem.is_cheaper_combined())
    }

    /// Evaluates residuals and derivatives at `point.values`, in one pass if the problem has its own; false if the
    /// model has no finite value there.
    #[cfg(feature = "sampler")]
    pub(crate) fn residuals_and_derivatives<P: Residuals + ?Sized>(&mut self, problem: &P, point: &mut Point) -> bool {
        self.evaluate(problem, point, true) && self.differentiate(problem, point)
    }

    fn evaluate<P: Residuals + ?Sized>(&mut self, problem: &P, point: &mut Point, is_combined: bool) -> bool {
        let has_jacobian = is_combined && self.scheme == Scheme::Exact && !self.free.is_empty();
        self.residual_evaluations += 1;
        self.jacobian_evaluations += usize::from(has_jacobian);
        self.is_jacobian_current = false;
        point.residuals.resize(problem.len(), 0.0);
        let jacobian = has_jacobian.then_some(self.jacobian.as_mut_slice());
        if let Err(error) = problem.evaluate(&point.values, &mut point.residuals, jacobian) {
            self.non_finite = Some(NonFinite::Model(error.to_string()));
            point.sum_of_squares = f64::NAN;
            return false;
        }
        self.is_jacobian_current = has_jacobian;
        point.sum_of_squares = sum_of_squares(&point.residuals);
        let is_finite = point.sum_of_squares.is_finite();
        if !is_finite {
            let (index, value) = worst(&point.residuals);
            self.non_finite = Some(NonFinite::Residual { index, value });
        }
        is_finite
    }

    /// Evaluates the Jacobian at a point that has its residuals, and factors it; false if it is not finite.
    pub(crate) fn factor<P: Residuals + ?Sized>(&mut self, problem: &P, point: &mut Point) -> bool {
        if !self.differentiate(problem, point) {
            return false;
        }
        let Self { structure, jacobian, free, factoring, .. } = self;
        structure.factor(jacobian, free, &point.residuals, &mut point.triangle, factoring);
        let is_finite = point.triangle.is_finite();
        if !is_finite {
            let column = self.first_bad_column().unwrap_or(self.free[0]);
            let parameter = problem.parameters()[column].name().to_owned();
            self.non_finite = Some(NonFinite::Derivative { parameter });
        }
        is_finite
    }

    /// Evaluates the Jacobian at a point that has its residuals; false if the model fails there.
    pub(crate) fn differentiate<P: Residuals + ?Sized>(&mut self, problem: &P, point: &Point) -> bool {
        if !self.is_jacobian_current && self.scheme == Scheme::Exact {
            self.jacobian_evaluations += 1;
            self.scratch.resize(problem.len(), 0.0);
            // The residuals of the point stay: they may come of another pass, with other rounding.
            if let Err(error) = problem.evaluate(&point.values, &mut self.scratch, Some(&mut self.jacobian)) {
                self.non_finite = Some(NonFinite::Model(error.to_string()));
                return false;
            }
        }
        self.is_jacobian_current = false;
        let count = if self.scheme == Scheme::Exact { self.unfilled.len() } else { self.free.len() };
        if count > 0 {
            self.scratch.resize(point.residuals.len(), 0.0);
            self.probe.clone_from(&point.values);
        }
        for index in 0..count {
            let j = if self.scheme == Scheme::Exact { self.unfilled[index] } else { self.free[index] };
            self.difference(problem, point, j);
        }
        true
    }

    /// Residuals and derivatives of `problem` at `values`, by central differences if it has none of its own; `None` if
    /// they are not finite. The columns of fixed parameters are meaningless.
    pub(crate) fn linearise<P: Residuals + ?Sized>(problem: &P, values: &[f64]) -> Option<Linearised> {
        let mut evaluator = Self::of(problem, values).ok()?;
        let mut point = Point { values: values.to_vec(), ..Point::default() };
        if evaluator.scheme == Scheme::Forward {
            evaluator.scheme = Scheme::Central;
        }
        let is_finite = evaluator.residuals(problem, &mut point) && evaluator.factor(problem, &mut point);
        let Self { structure, jacobian, scheme, .. } = evaluator;
        is_finite.then_some(Linearised { residuals: point.residuals, structure, jacobian, scheme })
    }

    /// Σᵢ aᵢ ∂rᵢ/∂θ for one parameter, with the Jacobian last evaluated.
    pub(crate) fn product(&self, parameter: usize, a: &[f64]) -> f64 {
        self.structure.product(&self.jacobian, parameter, a)
    }

    /// Size of the buffers that grow with the problem.
    #[cfg(test)]
    pub(crate) fn buffered(&self) -> usize {
        self.jacobian.capacity() + self.scratch.capacity() + self.factoring.block.capacity()
    }

    /// The first free parameter whose column of the Jacobian is not finite.
    pub(crate) fn first_bad_column(&self) -> Option<usize> {
        self.free.iter().copied().find(|&j| !self.structure.square(&self.jacobian, j).is_finite())
    }
}
