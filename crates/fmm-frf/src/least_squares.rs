//! Least squares of a few unknowns, by the solver and the regression of `fmm-fit`.

use std::array;

use fmm_fit::{Derivatives, EvaluationError, LinearRegression, Options, Residuals, Weighting, solve};
use fmm_model::Parameter;

/// Equations `row` · x = right side, one for each observation.
#[derive(Debug, Clone)]
pub(crate) struct Equations<const P: usize> {
    columns: [Vec<f64>; P],
    right: Vec<f64>,
}

/// The unknowns for which the sum of squares is least.
#[derive(Debug, Clone)]
pub(crate) struct Solution<const P: usize> {
    pub(crate) values: [f64; P],
    /// Covariance by the variance of the residuals; `None` without a degree of freedom.
    pub(crate) covariance: Option<[[f64; P]; P]>,
    pub(crate) sum_of_squares: f64,
}

impl<const P: usize> Equations<P> {
    pub(crate) fn new() -> Self {
        Self { columns: array::from_fn(|_| Vec::new()), right: Vec::new() }
    }

    /// Adds the equation `row` · x = `right`.
    pub(crate) fn add(&mut self, row: [f64; P], right: f64) {
        self.columns.iter_mut().zip(row).for_each(|(column, entry)| column.push(entry));
        self.right.push(right);
    }

    /// Their solution; `None` if they do not determine all unknowns.
    pub(crate) fn solve(&self) -> Option<Solution<P>> {
        let columns: Vec<(&str, &[f64])> = self.columns.iter().map(|column| ("unknown", column.as_slice())).collect();
        let found = LinearRegression::fit(&columns, &self.right, Weighting::Equal).ok()?;
        found.null_directions().is_empty().then(|| Solution {
            values: array::from_fn(|j| found.coefficients()[j]),
            covariance: matrix(|i, j| found.covariance(i, j)),
            sum_of_squares: found.sum_of_squares(),
        })
    }
}

/// The matrix of these elements; `None` if one is not there.
fn matrix<const P: usize>(element: impl Fn(usize, usize) -> Option<f64>) -> Option<[[f64; P]; P]> {
    let mut matrix = [[0.0; P]; P];
    for (i, row) in matrix.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = element(i, j)?;
        }
    }
    Some(matrix)
}

/// Minimises the sum of squares of `count` residuals from `start` on; `None` if that does not settle or leaves unknowns
/// undetermined.
///
/// `linearise` gives, for unknowns that it finds possible, the rows J of derivatives of a model with data minus model
/// as right sides, so that their solution is the step of Gauss and Newton.
pub(crate) fn minimise<const P: usize>(
    start: [f64; P],
    count: usize,
    linearise: impl Fn(&[f64; P]) -> Option<Equations<P>>,
) -> Option<Solution<P>> {
    let parameters = array::from_fn(|j| Parameter::named(format!("unknown_{j}"), "x", "1"));
    let problem = Linearised { parameters, count, linearise };
    let fit = solve(&problem, &start, &Options::default().with_jacobian_check(false)).ok()?;
    (fit.outcome().is_success() && fit.null_directions().is_empty()).then(|| Solution {
        values: array::from_fn(|j| fit.values()[j]),
        covariance: matrix(|i, j| fit.covariance(i, j)),
        sum_of_squares: fit.sum_of_squares(),
    })
}

/// The residuals model minus data of a model that is given by its linear equations.
struct Linearised<F, const P: usize> {
    parameters: [Parameter; P],
    count: usize,
    linearise: F,
}

impl<F: Fn(&[f64; P]) -> Option<Equations<P>>, const P: usize> Linearised<F, P> {
    fn at(&self, p: &[f64]) -> Result<Equations<P>, EvaluationError> {
        (self.linearise)(&array::from_fn(|j| p[j])).ok_or_else(|| EvaluationError::message("no such model"))
    }
}

impl<F: Fn(&[f64; P]) -> Option<Equations<P>>, const P: usize> Residuals for Linearised<F, P> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.count
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let equations = self.at(p)?;
        residuals.iter_mut().zip(&equations.right).for_each(|(out, right)| *out = -right);
        if let Some(jacobian) = jacobian {
            jacobian
                .chunks_exact_mut(self.count)
                .zip(&equations.columns)
                .for_each(|(to, from)| to.copy_from_slice(from));
        }
        Ok(())
    }

    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

/// gᵀ C g, the variance of a function with `gradient` g of unknowns with `covariance` C.
pub(crate) fn variance_of<const P: usize>(gradient: [f64; P], covariance: &[[f64; P]; P]) -> f64 {
    let rows = covariance.iter().zip(gradient);
    rows.map(|(row, g)| g * row.iter().zip(gradient).map(|(c, h)| c * h).sum::<f64>()).sum::<f64>().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through (0, 1), (1, 3), (2, 4), (3, 4): slope 1, intercept 3/2, residual sum of squares 1.
    #[test]
    fn a_straight_line() {
        let mut equations = Equations::new();
        for (x, y) in [(0.0, 1.0), (1.0, 3.0), (2.0, 4.0), (3.0, 4.0)] {
            equations.add([1.0, x], y);
        }
        let Solution { values: [intercept, slope], covariance, sum_of_squares } = equations.solve().unwrap();
        assert!((intercept - 1.5).abs() < 1e-14 && (slope - 1.0).abs() < 1e-14, "{intercept} + {slope} x");
        assert!((sum_of_squares - 1.0).abs() < 1e-14);
        // s² = 1/2, Σ(x − x̄)² = 5: var(slope) = 1/10, var(intercept) = s² Σx²/(n 5) = 7/20, covariance −s² x̄/5.
        let covariance = covariance.unwrap();
        for (found, expected) in covariance.iter().flatten().zip([0.35, -0.15, -0.15, 0.1]) {
            assert!((found - expected).abs() < 1e-14, "{covariance:?}");
        }
        assert!((variance_of([1.0, 1.5], &covariance) - 0.125).abs() < 1e-14);
    }

    #[test]
    fn what_is_not_determined_has_no_solution() {
        let mut equations = Equations::new();
        for x in 1..5 {
            equations.add([f64::from(x), 3.0 * f64::from(x)], 1.0);
        }
        assert!(equations.solve().is_none());
        let mut exact = Equations::new();
        exact.add([2.0], 3.0);
        let solution = exact.solve().unwrap();
        assert_eq!((solution.values, solution.covariance), ([1.5], None));
    }

    /// y = a e^{−b x} through exact points.
    #[test]
    fn an_exponential() {
        let linearise = |&[a, b]: &[f64; 2]| {
            let mut equations = Equations::new();
            for i in 0..8 {
                let x = 0.25 * f64::from(i);
                let model = (-b * x).exp();
                equations.add([model, -a * x * model], 3.0 * (-1.7 * x).exp() - a * model);
            }
            Some(equations)
        };
        let [a, b] = minimise([1.0, 0.2], 8, linearise).unwrap().values;
        assert!((a - 3.0).abs() < 1e-12 && (b - 1.7).abs() < 1e-12, "{a} e^(-{b} x)");
    }

    #[test]
    fn a_model_that_does_not_exist_at_the_start_has_no_minimum() {
        assert!(minimise([1.0], 3, |_| None).is_none());
    }
}
