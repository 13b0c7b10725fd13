//! Comparison of the derivatives of a problem with differences of its residuals.

use std::fmt;

use fmm_model::Rounded;

use crate::error::FitError;
use crate::problem::residuals::Residuals;
use crate::solver::evaluation::{Evaluator, Point, Scheme};
use crate::solver::minimizer::{check_parameters, check_start};

/// The relative difference between a column of derivatives and differences that is no error of the latter.
const DIFFERENT: f64 = 1e-3;
/// Differences over steps a thousandfold apart that disagree by more, in units of the mismatch, are no evidence: the
/// model is not smooth there.
const SMOOTH: f64 = 0.1;
/// Rounding of a residual, in its last digits.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Derivatives by one parameter that are not those of the residuals.
///
/// `Display` gives it in words.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct JacobianMismatch {
    /// Name of the parameter.
    pub parameter: String,
    /// Index of the residual whose derivative is most wrong, from 0.
    pub residual: usize,
    /// Its derivative by the parameter as the problem gives it, in the unit of the residual over that of the parameter.
    pub derivative: f64,
    /// The same by central differences.
    pub difference: f64,
}

impl fmt::Display for JacobianMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [derivative, difference] = [self.derivative, self.difference].map(|value| Rounded::new(value, None));
        write!(
            f,
            "the derivative of residual {} by {} is {derivative} as the problem gives it and {difference} by \
             differences",
            self.residual, self.parameter
        )
    }
}

/// Compares the derivatives that `problem` gives with differences at `values`, one per parameter within its bounds;
/// what disagrees, at most once for each free parameter.
///
/// At a kink or a jump of the model differences over two steps do not agree with each other, and nothing is reported.
/// It costs two evaluations of the residuals for each free parameter, and three for each in doubt. A problem
/// without derivatives has none to doubt.
///
/// ```
/// use fmm_fit::{Derivatives, EvaluationError, JacobianMismatch, Residuals, check_jacobian};
/// use fmm_model::Parameter;
///
/// struct Square([Parameter; 2]);
/// impl Residuals for Square {
///     fn parameters(&self) -> &[Parameter] { &self.0 }
///     fn len(&self) -> usize { 2 }
///     fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
///         residuals.copy_from_slice(&[p[0] * p[0] - 2.0, p[0] - p[1]]);
///         if let Some(jacobian) = jacobian {
///             // The factor of two is forgotten.
///             jacobian.copy_from_slice(&[p[0], 1.0, 0.0, -1.0]);
///         }
///         Ok(())
///     }
///     fn derivatives(&self) -> Derivatives {
///         Derivatives::Free
///     }
/// }
/// let problem = Square(["x", "y"].map(|name| Parameter::new(name, name, "1")));
/// let mismatches: Vec<JacobianMismatch> = check_jacobian(&problem, &[3.0, 1.0])?;
/// assert_eq!(mismatches.len(), 1);
/// assert_eq!(
///     mismatches[0].to_string(),
///     "the derivative of residual 0 by x is 3 as the problem gives it and 6 by differences"
/// );
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// # Errors
/// [`FitError`] if a fit could not begin at `values`.
pub fn check_jacobian<P: Residuals + ?Sized>(problem: &P, values: &[f64]) -> Result<Vec<JacobianMismatch>, FitError> {
    let parameters = problem.parameters();
    check_parameters(parameters)?;
    check_start(parameters, values)?;
    let mut evaluator = Evaluator::of(problem, values)?;
    let mut point = Point { values: values.to_vec(), ..Point::default() };
    let is_known = evaluator.residuals(problem, &mut point) && evaluator.differentiate(problem, &point);
    if !is_known || evaluator.scheme != Scheme::Exact {
        return Ok(Vec::new());
    }
    let column = |evaluator: &Evaluator, j: usize| -> Vec<f64> {
        let columns = evaluator.structure.columns_of(j);
        columns.flat_map(|column| evaluator.jacobian[column.elements].iter().copied()).collect()
    };
    let mut mismatches = Vec::new();
    for j in evaluator.free.clone() {
        // Differences overwrite the derivatives in their place; no parameter needs those of another.
        let own = column(&evaluator, j);
        evaluator.scratch.resize(point.residuals.len(), 0.0);
        evaluator.probe.clone_from(&point.values);
        evaluator.scheme = Scheme::Central;
        evaluator.difference(problem, &point, j);
        let step = evaluator.scheme.relative_step() * evaluator.magnitude(point.values[j], j);
        let central = column(&evaluator, j);
        let rounding = ROUNDING * point.sum_of_squares.sqrt() / step;
        let doubt = distance(&own, &central);
        if doubt <= DIFFERENT * norm(&own).max(norm(&central)) + rounding || doubt.is_nan() {
            continue;
        }
        evaluator.scheme = Scheme::Forward;
        evaluator.difference(problem, &point, j);
        let forward = column(&evaluator, j);
        if distance(&forward, &central) <= SMOOTH * doubt {
            let error = |k: usize| (own[k] - central[k]).abs();
            let worst = (0..own.len()).fold(0, |worst, k| if error(k) > error(worst) { k } else { worst });
            let residual = evaluator.structure.columns_of(j).flat_map(|column| column.rows).nth(worst);
            mismatches.push(JacobianMismatch {
                parameter: parameters[j].name().to_owned(),
                residual: residual.unwrap_or(worst),
                derivative: own[worst],
                difference: central[worst],
            });
        }
    }
    Ok(mismatches)
}

fn norm(column: &[f64]) -> f64 {
    column.iter().map(|element| element * element).sum::<f64>().sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}
