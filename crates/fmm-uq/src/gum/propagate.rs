//! The law of propagation of uncertainty.

use crate::error::UncertaintyError;
use crate::gum::budget::Budget;
use crate::gum::derivatives::{Derivatives, Differences, Exact};
use crate::gum::propagation::{Propagation, output_count};
use crate::gum::second_order::{Linearisation, second_order};
use crate::inputs::Inputs;
use crate::model::{ModelOutput, Taylor};

/// Propagates the uncertainty of `inputs` through a `model` of one output, with exact derivatives.
///
/// ```text
/// y = f(x₁ … x_n),   c_i = ∂f/∂x_i,   u²(y) = Σᵢ Σⱼ c_i c_j u_i u_j r_ij    (JCGM 100:2008, Eq. 13 and 16)
/// ```
///
/// The model receives the values in the order of the inputs and must be deterministic. It may fail: whatever is an
/// [`ModelOutput`] can be given back. [`Gum`] has more outputs, differences, and a way to save the second order.
///
/// ```
/// use fmm_uq::{Input, Inputs, Linearisation, propagate};
///
/// // Friction coefficient from the half cycle loss: μ = k ΔA / (2 N).
/// let inputs = Inputs::new([
///     Input::new("stiffness", 1982.0, 12.0, "N/m")?,
///     Input::new("amplitude_loss", 1.77e-3, 2.0e-5, "m")?,
///     Input::new("normal_load", 6.67, 0.05, "N")?,
/// ])?;
/// let budget = propagate(&inputs, |x| x[0] * x[1] / (x[2] * 2.0))?;
/// // The relative uncertainties 0.61 %, 1.13 % and 0.75 % add in squares: 1.49 %.
/// assert!((budget.estimate() - 0.262_98).abs() < 5e-6);
/// assert!((budget.standard_uncertainty() / budget.estimate() - 0.0149).abs() < 5e-5);
/// assert_eq!(budget.linearisation(), Linearisation::Adequate);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
///
/// # Errors
/// Those of [`Gum::propagate`]; [`UncertaintyError::Model`] unless there is one output.
///
/// # Panics
/// If the model does.
pub fn propagate<R: ModelOutput<Taylor>>(
    inputs: &Inputs,
    model: impl Fn(&[Taylor]) -> R,
) -> Result<Budget, UncertaintyError> {
    Gum::new(inputs).propagate(model)?.single()
}

/// The propagation of uncertainty after JCGM 100:2008 and JCGM 102:2011, for any number of outputs.
///
/// ```
/// use fmm_uq::{Gum, Input, Inputs, Scalar};
///
/// // Resistance and reactance from voltage, current and phase.
/// fn impedance<D: Scalar>(x: &[D]) -> [D; 2] {
///     let (sin, cos) = x[2].sin_cos();
///     [x[0] / x[1] * cos, x[0] / x[1] * sin]
/// }
/// let inputs = Inputs::from_observations(&[
///     ("V", "V", &[5.007, 4.994, 5.005, 4.990, 4.999]),
///     ("I", "A", &[0.019_663, 0.019_639, 0.019_640, 0.019_685, 0.019_678]),
///     ("φ", "rad", &[1.0456, 1.0438, 1.0468, 1.0428, 1.0433]),
/// ])?;
/// let exact = Gum::new(&inputs).propagate(impedance)?;
/// assert!((exact.outputs()[0].standard_uncertainty() - 0.071_07).abs() < 5e-6);
/// assert!((exact.correlation(0, 1) + 0.588_43).abs() < 5e-6);
/// let stepped = Gum::new(&inputs).propagate_by_differences(impedance::<f64>)?;
/// assert!((stepped.correlation(0, 1) + 0.588_43).abs() < 5e-6);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Gum<'a> {
    inputs: &'a Inputs,
    curvature: bool,
}

impl<'a> Gum<'a> {
    /// The propagation of these inputs, with second-order terms beside the first-order uncertainty.
    pub const fn new(inputs: &'a Inputs) -> Self {
        Self { inputs, curvature: true }
    }

    /// The same without second-order terms: [`Linearisation::Unchecked`], and for n inputs n/2 evaluations of
    /// Taylor numbers instead of about n²/2 + 2n, or 2n differences instead of about 7n²/2.
    #[must_use]
    pub const fn first_order_only(mut self) -> Self {
        self.curvature = false;
        self
    }

    /// Propagates with exact derivatives.
    ///
    /// # Errors
    /// [`UncertaintyError::Model`] if the model fails (with its own error as the source), gives a result or a
    /// sensitivity that is not finite (with the values of the inputs), gives other results for the same inputs, has no
    /// output, or changes their number. [`UncertaintyError::Invalid`] if the sum of finite contributions overflows;
    /// [`UncertaintyError::NoAnswer`] if all contributions vanish by underflow.
    ///
    /// # Panics
    /// If the model does.
    pub fn propagate<R: ModelOutput<Taylor>>(
        &self,
        model: impl Fn(&[Taylor]) -> R,
    ) -> Result<Propagation, UncertaintyError> {
        self.combine(&Exact::new(self.inputs, model))
    }

    /// Propagates with central differences over ± one standard uncertainty (JCGM 100:2008, 5.1.3, note 2), for
    /// models that take plain numbers.
    ///
    /// Such a difference averages the slope over the range that matters, and the noise of a fit or of a fixed-step
    /// simulation is small against it. A constant is stepped by 6e-6 of its value.
    ///
    /// # Errors
    /// Those of [`Gum::propagate`], also at the points one standard uncertainty away.
    ///
    /// # Panics
    /// If the model does.
    pub fn propagate_by_differences<R: ModelOutput<f64>>(
        &self,
        model: impl Fn(&[f64]) -> R,
    ) -> Result<Propagation, UncertaintyError> {
        self.combine(&Differences::new(self.inputs, model))
    }

    fn combine(&self, model: &impl Derivatives) -> Result<Propagation, UncertaintyError> {
        let slopes = model.slopes()?;
        let count = slopes.values.len();
        if count == 0 {
            return Err(output_count(0));
        }
        let mut budgets = Vec::with_capacity(count);
        for (&value, sensitivities) in slopes.values.iter().zip(&slopes.sensitivities) {
            budgets.push(Budget::new(self.inputs.clone(), value, sensitivities.clone())?);
        }
        let expansion = (slopes.values.as_slice(), slopes.sensitivities.as_slice());
        let curvature =
            if self.curvature { Some(second_order(self.inputs, model, &budgets, expansion)?) } else { None };
        let vary = self.inputs.as_slice().iter().any(|input| input.standard_uncertainty() > 0.0);
        for (k, budget) in budgets.iter_mut().enumerate() {
            let curvature = curvature.as_ref().map(|outputs| outputs[k]);
            let verdict = Linearisation::judge(budget.standard_uncertainty(), vary, curvature);
            budget.set_curvature(curvature.and_then(|curvature| curvature.terms), verdict);
        }
        Ok(Propagation::new(budgets))
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::error::Error;

    use fmm_model::Scalar;

    use super::*;
    use crate::inputs::Input;

    fn one(value: f64, uncertainty: f64) -> Inputs {
        Inputs::new([Input::new("x", value, uncertainty, "m").unwrap()]).unwrap()
    }

    #[test]
    fn results_that_are_no_numbers_name_the_values() {
        let error = propagate(&one(-2.0, 0.1), |x| x[0].ln()).unwrap_err();
        assert_eq!(error.to_string(), "the model gives NaN at x = -2 m");
        let error = propagate(&one(0.0, 0.1), |x| Taylor::from(1.0) / x[0]).unwrap_err();
        assert_eq!(error.to_string(), "the model gives inf at x = 0 m");
        let error = Gum::new(&one(0.05, 0.1)).propagate_by_differences(|x| x[0].sqrt()).unwrap_err();
        assert_eq!(error.to_string(), "the model gives NaN at x = -0.05 m");
    }

    #[test]
    fn a_vertical_tangent_has_no_first_order_uncertainty() {
        let error = propagate(&one(0.0, 0.1), |x| x[0].sqrt()).unwrap_err();
        assert!(error.to_string().starts_with("the sensitivity to"), "{error}");
        // 1e200 · 1e200 overflows although each factor is finite.
        let error = propagate(&one(1.0, 1e200), |x| x[0] * 1e200).unwrap_err();
        assert!(error.to_string().starts_with("the sensitivity to"), "{error}");
    }

    #[test]
    fn a_model_must_repeat_itself() {
        let inputs = Inputs::new(["a", "b", "c"].map(|name| Input::new(name, 1.0, 0.1, "m").unwrap())).unwrap();
        let calls = Cell::new(0.0);
        let next = || {
            calls.set(calls.get() + 1.0);
            calls.get()
        };
        let error = propagate(&inputs, |x| x[0] + x[1] + next()).unwrap_err();
        assert!(error.to_string().starts_with("the model gives 3, then 4,"), "{error}");
        let error = Gum::new(&inputs).propagate_by_differences(|x| x[0] + next()).unwrap_err();
        assert!(error.to_string().contains("must be deterministic"), "{error}");
        let error = Gum::new(&inputs).propagate(|_| vec![Taylor::from(1.0); next() as usize]).unwrap_err();
        assert!(error.to_string().contains("must not change"), "{error}");
    }

    #[test]
    fn the_cause_of_a_failure_is_kept() {
        let error = propagate(&one(1.0, 0.1), |_| Err::<Taylor, _>("no root")).unwrap_err();
        assert_eq!(error.source().unwrap().to_string(), "no root");
        assert!(matches!(
            propagate(&one(1.0, 0.1), |x| [x[0], x[0]]),
            Err(UncertaintyError::Model { what, .. }) if what.contains("must give 1 outputs, but gives 2")
        ));
    }

    #[test]
    fn differences_and_exact_derivatives_agree() {
        fn model<D: Scalar>(x: &[D]) -> D {
            x[0] * x[0] * x[1] + (x[1] / x[0]).exp()
        }
        let inputs = Inputs::new([Input::new("a", 2.0, 2e-3, "m").unwrap(), Input::new("b", 3.0, 3e-3, "m").unwrap()]);
        let inputs = inputs.unwrap().with_correlations(&[("a", "b", 0.4)]).unwrap();
        let exact = propagate(&inputs, model).unwrap();
        let stepped = Gum::new(&inputs).propagate_by_differences(model::<f64>).unwrap().single().unwrap();
        // (u/x)² = 1e-6 is what the third derivative leaves in a central difference.
        assert!((stepped.standard_uncertainty() / exact.standard_uncertainty() - 1.0).abs() < 1e-6);
        let [first, second] = [exact, stepped].map(|budget| budget.second_order().unwrap());
        assert!((first.correction / second.correction - 1.0).abs() < 1e-5, "{first:?} {second:?}");
        assert!((first.standard_uncertainty / second.standard_uncertainty - 1.0).abs() < 1e-8, "{first:?} {second:?}");
    }

    #[test]
    fn a_constant_has_a_sensitivity_too() {
        let stepped = Gum::new(&one(3.0, 0.0)).propagate_by_differences(|x| x[0] * x[0]).unwrap();
        let sensitivity = stepped.outputs()[0].contributions().next().unwrap().sensitivity;
        assert!((sensitivity - 6.0).abs() < 1e-9, "{sensitivity}");
    }
}
