//! Sensitivity of the estimates of a fit to fixed values.

use std::fmt;

use fmm_model::{Parameter, Rounded};

use crate::error::FitError;
use crate::problem::residuals::Residuals;
use crate::result::fit::Fit;
use crate::uncertainty::minimum::Minimum;

/// Derivatives of the estimates of a fit by its fixed values, the inputs, without fitting again.
///
/// At a minimum the gradient Jᵀ r vanishes; that it does so for neighbouring inputs α too gives, by the implicit
/// function theorem,
///
/// ```text
/// ∂θ/∂α = −(Jᵀ J + Σᵢ rᵢ ∂²rᵢ/∂θ²)⁻¹ (Jᵀ ∂r/∂α + Σᵢ rᵢ ∂²rᵢ/∂θ∂α)
/// ```
///
/// | form | method | second derivatives | evaluations of the Jacobian |
/// |---|---|---|---|
/// | exact | [`of`](Self::of) | by central differences of Jᵀ r at constant r | two per parameter, fixed or not |
/// | first order | [`first_order`](Self::first_order) | left out: right if the residuals are zero | one |
///
/// These are the sensitivity coefficients of JCGM 100:2008, 5.1.3;
/// [`propagated_uncertainty`](Self::propagated_uncertainty) applies them. Estimates at a bound stay there: their
/// derivatives are zero, and the others are those at the bound. Estimates that the residuals do not determine have
/// none.
///
/// The fixed values are moved a little, out of their bounds, so the problem has to have values beside them.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Automatic, Model, Options, Sensitivity, solve};
/// use fmm_model::{Bounds, Parameter, Scalar};
///
/// /// Weights F = m g over masses, g to be found and the offset of the scale fixed.
/// struct Weighing {
///     parameters: [Parameter; 2],
/// }
/// # impl Model for Weighing {
/// #     fn parameters(&self) -> &[Parameter] { &self.parameters }
/// #     fn len(&self) -> usize { 3 }
/// #     fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
/// #         for (r, (m, f)) in residuals.iter_mut().zip([(1.0, 9.83), (2.0, 19.65), (3.0, 29.41)]) {
/// #             *r = p[0] * m + p[1] - f;
/// #         }
/// #         Ok(())
/// #     }
/// # }
/// let gravity = Parameter::new("gravity", "g", "m/s²");
/// let offset = Parameter::new("offset", "b", "N").bounded(Bounds::new(0.02, 0.02)?);
/// let problem = Automatic::<_, 2>::new(Weighing { parameters: [gravity, offset] });
/// let fit = solve(&problem, &[9.0, 0.02], &Options::default())?;
///
/// let sensitivity = Sensitivity::of(&problem, &fit)?;
/// // g = Σ m (F − b) / Σ m²
/// let coefficient = sensitivity.coefficient_of("gravity", "offset").unwrap();
/// assert!((coefficient + 6.0 / 14.0).abs() < 1e-9);
/// // An offset known to 0.01 N.
/// assert!((sensitivity.propagated_uncertainty(0, &[0.01]).unwrap() - 0.01 * 6.0 / 14.0).abs() < 1e-11);
/// assert_eq!(sensitivity.to_string(), "[[sensitivity]]\n  gravity by offset: -0.428571 (m/s²)/N\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) inputs: Vec<usize>,
    /// For each parameter and input, row by row; `None` for inputs themselves and for what is not determined.
    pub(crate) coefficients: Vec<Option<f64>>,
}

impl Sensitivity {
    /// The exact derivatives of the estimates of `fit`, which must be one of `problem`.
    ///
    /// If the problem gives its derivatives they are good to about eight digits, otherwise, being differences of
    /// differences, to about four.
    ///
    /// # Errors
    /// [`FitError`] if the fit has not converged or is not one of this problem, if the model has no derivatives
    /// at or near its values, and if these are not those of a minimum.
    pub fn of<P: Residuals + ?Sized>(problem: &P, fit: &Fit) -> Result<Self, FitError> {
        Minimum::new(problem, fit)?.respond(true)
    }

    /// The derivatives without the terms in the residuals.
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn first_order<P: Residuals + ?Sized>(problem: &P, fit: &Fit) -> Result<Self, FitError> {
        Minimum::new(problem, fit)?.respond(false)
    }

    /// All parameters of the problem.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Indices of the inputs, the parameters that were fixed, among the parameters.
    pub fn inputs(&self) -> &[usize] {
        &self.inputs
    }

    /// Derivative of the estimate of parameter `estimate` by the fixed value of parameter `input`, in the quotient of
    /// their units; `None` if the one is fixed or not determined, or if the other is not fixed.
    pub fn coefficient(&self, estimate: usize, input: usize) -> Option<f64> {
        let column = self.inputs.iter().position(|&index| index == input)?;
        self.coefficients.get(estimate * self.inputs.len() + column).copied().flatten()
    }

    /// [`coefficient`](Self::coefficient) for parameters by name.
    pub fn coefficient_of(&self, estimate: &str, input: &str) -> Option<f64> {
        let index = |name: &str| self.parameters.iter().position(|parameter| parameter.name() == name);
        self.coefficient(index(estimate)?, index(input)?)
    }

    /// Standard uncertainty that independent standard `uncertainties` of the inputs, in the order of
    /// [`inputs`](Self::inputs), bring about in the estimate of parameter `estimate`: √Σ (c u)², in its unit.
    ///
    /// It comes on top of that of the fit. `None` for an estimate without coefficients, and for another number of
    /// uncertainties than inputs.
    pub fn propagated_uncertainty(&self, estimate: usize, uncertainties: &[f64]) -> Option<f64> {
        if uncertainties.len() != self.inputs.len() || uncertainties.is_empty() {
            return None;
        }
        let parts = self.inputs.iter().zip(uncertainties);
        let squares = parts.map(|(&input, u)| self.coefficient(estimate, input).map(|c| (c * u).powi(2)));
        squares.sum::<Option<f64>>().map(f64::sqrt)
    }
}

impl fmt::Display for Sensitivity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[[sensitivity]]")?;
        for (j, parameter) in self.parameters.iter().enumerate() {
            for &input in &self.inputs {
                let by = &self.parameters[input];
                if let Some(coefficient) = self.coefficient(j, input) {
                    let value = Rounded::new(coefficient, None);
                    writeln!(f, "  {} by {}: {value} {}", parameter.name(), by.name(), quotient(parameter, by))?;
                }
            }
        }
        Ok(())
    }
}

/// The unit of a derivative.
fn quotient(of: &Parameter, by: &Parameter) -> String {
    let enclosed = |unit: &str| {
        if unit.contains([' ', '/']) { format!("({unit})") } else { unit.to_owned() }
    };
    match by.unit() {
        "1" => of.unit().to_owned(),
        unit => format!("{}/{}", enclosed(of.unit()), enclosed(unit)),
    }
}
