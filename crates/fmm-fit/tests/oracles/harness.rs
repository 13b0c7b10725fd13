//! Reading oracle files, residuals from formulas, and the measure of agreement.

use fmm_fit::{Derivatives, EvaluationError, Residuals};
use fmm_model::{Bounds, Dual, Parameter, Scalar};
use serde_json::Value;

/// Enough derivative directions for every problem of the files.
pub(crate) type Gradient = Dual<11>;

/// A formula for residual `i`, generic in its number type.
pub(crate) trait Formula {
    fn residual<D: Scalar>(&self, i: usize, p: &[D]) -> D;
}

/// A problem from a formula, with its exact Jacobian or without.
pub(crate) struct FormulaProblem<F> {
    pub(crate) formula: F,
    pub(crate) count: usize,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) is_exact: bool,
}

impl<F: Formula> Residuals for FormulaProblem<F> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.count
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (value, parameter) in p.iter().zip(&self.parameters) {
            // Fixed ones are moved when a test asks for the sensitivity to them.
            let is_inside = parameter.bounds().is_fixed() || parameter.bounds().contains(*value);
            assert!(is_inside, "{} = {value} is outside its bounds", parameter.name());
        }
        for (i, r) in residuals.iter_mut().enumerate() {
            *r = self.formula.residual(i, p);
        }
        if let Some(jacobian) = jacobian {
            let p: Vec<Gradient> = p.iter().enumerate().map(|(j, value)| Gradient::variable(*value, j)).collect();
            for i in 0..self.count {
                let r = self.formula.residual(i, &p);
                for j in 0..p.len() {
                    jacobian[j * self.count + i] = r.partial(j);
                }
            }
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        if self.is_exact { Derivatives::All } else { Derivatives::None }
    }
}

/// Parameters b1, b2, … with the bounds of the file, `null` meaning none.
pub(crate) fn parameters(count: usize, lower: &Value, upper: &Value) -> Vec<Parameter> {
    (0..count)
        .map(|j| {
            let lower = lower[j].as_f64().unwrap_or(f64::NEG_INFINITY);
            let upper = upper[j].as_f64().unwrap_or(f64::INFINITY);
            let name = format!("b{}", j + 1);
            Parameter::named(name.clone(), name, "1").bounded(Bounds::new(lower, upper).unwrap())
        })
        .collect()
}

/// Numbers of a file, given as numbers or as texts.
pub(crate) fn numbers(values: &Value) -> Vec<f64> {
    values.as_array().unwrap().iter().map(number).collect()
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap())
}

/// Decimal digits in which `values` agree with `reference`, of the worst of them, at most 15.
pub(crate) fn digits(values: &[f64], reference: &[f64]) -> f64 {
    let agreement = |(value, reference): (&f64, &f64)| {
        let error = if *reference == 0.0 { value.abs() } else { ((value - reference) / reference).abs() };
        if error.is_nan() { 0.0 } else { (-error.log10()).clamp(0.0, 15.0) }
    };
    values.iter().zip(reference).map(agreement).fold(15.0, f64::min)
}

/// How many of the runs agree in at least so many digits.
pub(crate) fn at_least(digits: &[f64], wanted: f64) -> usize {
    digits.iter().filter(|&&digits| digits >= wanted).count()
}
