//! The law of propagation of uncertainty, with derivatives that are exact.

use std::convert::Infallible;
use std::error::Error;

use num_dual::Dual64;

use crate::{Budget, Input, Inputs, UncertaintyError};

/// The number in which a model is evaluated: a value together with one derivative.
///
/// It is `Copy` and does arithmetic with itself and with `f64`; import [`DualNum`](crate::DualNum) for its
/// functions (`x.sqrt()`, `x.sin()`, `x.powi(2)`, …). Comparisons look at the value alone.
///
/// One derivative at a time is a choice: a number that carries all of them needs either its count in the type,
/// which is not known where inputs come from a file, or the heap, and then a `clone` at every use of a variable.
/// The price is one evaluation of the model per input, and each is about as cheap as two in plain `f64`.
pub type Dual = Dual64;

/// Propagates the uncertainty of `inputs` through `model` to first order.
///
/// ```text
/// y = f(x₁ … x_n),   c_i = ∂f/∂x_i,   u²(y) = Σᵢ Σⱼ c_i c_j u_i u_j r_ij    (JCGM 100:2008, Eq. 13 and 16)
/// ```
///
/// The model receives the values in the order of the inputs, once for every input. It must be deterministic and
/// differentiable at the estimates; the sensitivities are derivatives, not differences.
///
/// ```
/// use fmm_uq::{Input, Inputs, propagate};
///
/// // Friction coefficient from the amplitude loss per half swing: μ = k ΔA / (2 N).
/// let inputs = Inputs::new([
///     Input::new("stiffness", 1982.0, 12.0, "N/m")?,
///     Input::new("amplitude_loss", 1.77e-3, 2.0e-5, "m")?,
///     Input::new("normal_load", 6.67, 0.05, "N")?,
/// ])?;
/// let budget = propagate(&inputs, |x| x[0] * x[1] / (x[2] * 2.0))?;
/// // The relative uncertainties 0.61 %, 1.13 % and 0.75 % add in squares: 1.49 %.
/// assert!((budget.estimate() - 0.262_98).abs() < 5e-6);
/// assert!((budget.standard_uncertainty() / budget.estimate() - 0.0149).abs() < 5e-5);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
///
/// # Errors
/// [`UncertaintyError::ResultNotFinite`], [`UncertaintyError::SensitivityNotFinite`] or
/// [`UncertaintyError::ModelNotRepeatable`], each with the values of the inputs; and
/// [`UncertaintyError::UncertaintyOutOfRange`] if the contributions are finite but their sum overflows.
pub fn propagate(inputs: &Inputs, model: impl Fn(&[Dual]) -> Dual) -> Result<Budget, UncertaintyError> {
    try_propagate(inputs, |x| Ok::<_, Infallible>(model(x)))
}

/// Propagates like [`propagate`] through a model that may fail.
///
/// ```
/// use fmm_uq::{DualNum, Input, Inputs, UncertaintyError, try_propagate};
///
/// let inputs = Inputs::new([Input::new("stiffness", -1982.0, 12.0, "N/m")?])?;
/// let failure = try_propagate(&inputs, |x| {
///     if x[0] > 0.0 { Ok(x[0].sqrt()) } else { Err("a spring must push back") }
/// });
/// assert_eq!(failure.unwrap_err().to_string(), "the model failed at stiffness = -1982 N/m");
/// # Ok::<(), UncertaintyError>(())
/// ```
///
/// # Errors
/// [`UncertaintyError::ModelFailed`] with the model's own error as its source, and those of [`propagate`].
pub fn try_propagate<E: Into<Box<dyn Error + Send + Sync>>>(
    inputs: &Inputs,
    model: impl Fn(&[Dual]) -> Result<Dual, E>,
) -> Result<Budget, UncertaintyError> {
    let mut x: Vec<Dual> = inputs.as_slice().iter().map(|input| Dual::from_re(input.value())).collect();
    let mut estimate = None;
    let mut sensitivities = Vec::with_capacity(x.len());
    for (i, input) in inputs.as_slice().iter().enumerate() {
        x[i].eps = 1.0;
        let y = model(&x).map_err(|e| UncertaintyError::ModelFailed { at: values(inputs), source: e.into() })?;
        x[i].eps = 0.0;
        if !y.re.is_finite() {
            return Err(UncertaintyError::ResultNotFinite { result: y.re, at: values(inputs) });
        }
        let first = *estimate.get_or_insert(y.re);
        if first != y.re {
            return Err(UncertaintyError::ModelNotRepeatable { first, again: y.re, at: values(inputs) });
        }
        if !(y.eps * input.standard_uncertainty()).is_finite() || !y.eps.is_finite() {
            let (input, sensitivity) = (input.name().to_owned(), y.eps);
            return Err(UncertaintyError::SensitivityNotFinite { input, sensitivity, at: values(inputs) });
        }
        sensitivities.push(y.eps);
    }
    let estimate = estimate.ok_or(UncertaintyError::NoInputs)?;
    Budget::new(inputs.clone(), estimate, sensitivities)
}

/// "V = 4.999 V, I = 0.019661 A": where the model was evaluated.
fn values(inputs: &Inputs) -> String {
    let value = |input: &Input| format!("{} = {} {}", input.name(), input.value(), input.unit());
    inputs.as_slice().iter().map(value).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::DualNum;

    fn one(value: f64, uncertainty: f64) -> Inputs {
        Inputs::new([Input::new("x", value, uncertainty, "m").unwrap()]).unwrap()
    }

    #[test]
    fn results_that_are_no_numbers_name_the_values() {
        let error = propagate(&one(-2.0, 0.1), |x| x[0].ln()).unwrap_err();
        assert_eq!(error.to_string(), "the model gives NaN at x = -2 m");
        let error = propagate(&one(0.0, 0.1), |x| x[0].recip()).unwrap_err();
        assert_eq!(error.to_string(), "the model gives inf at x = 0 m");
    }

    #[test]
    fn a_vertical_tangent_has_no_first_order_uncertainty() {
        let error = propagate(&one(0.0, 0.1), |x| x[0].sqrt()).unwrap_err();
        assert!(matches!(error, UncertaintyError::SensitivityNotFinite { .. }), "{error}");
        // 1e200 · 1e200 overflows although each factor is finite.
        let error = propagate(&one(1.0, 1e200), |x| x[0] * 1e200).unwrap_err();
        assert!(matches!(error, UncertaintyError::SensitivityNotFinite { .. }), "{error}");
    }

    #[test]
    fn a_model_must_repeat_itself() {
        let inputs = Inputs::new(["a", "b"].map(|name| Input::new(name, 1.0, 0.1, "m").unwrap())).unwrap();
        let calls = Cell::new(0.0);
        let error = propagate(&inputs, |x| {
            calls.set(calls.get() + 1.0);
            x[0] + x[1] + calls.get()
        })
        .unwrap_err();
        assert!(matches!(error, UncertaintyError::ModelNotRepeatable { first: 3.0, again: 4.0, .. }), "{error}");
    }

    #[test]
    fn the_cause_of_a_failure_is_kept() {
        let error = try_propagate(&one(1.0, 0.1), |_| Err("no root")).unwrap_err();
        assert_eq!(error.source().unwrap().to_string(), "no root");
    }
}
