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
/// These are the sensitivity coefficients of JCGM 100:2008, 5.1.3; [`propagate`](Self::propagate) applies them.
/// Estimates at a bound stay there: their derivatives are zero, and the others are those at the bound. Estimates that
/// the residuals do not determine have none.
///
/// The fixed values are moved a little, out of their bounds, so the problem has to have values beside them.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Automatic, Model, Options, PropagatedCovariance, Sensitivity, solve};
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
/// let propagated: PropagatedCovariance = sensitivity.propagate_uncorrelated(&[0.01])?;
/// assert!((propagated.standard_uncertainty(0).unwrap() - 0.01 * 6.0 / 14.0).abs() < 1e-11);
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

    /// Covariance of the estimates that a covariance of the inputs brings about, row by row and in the order of
    /// [`inputs`](Self::inputs): C V Cᵀ. It comes on top of the covariance of the fit.
    ///
    /// # Errors
    /// [`FitError::Problem`] for a wrong number of elements and for what is no covariance.
    pub fn propagate(&self, covariance: &[f64]) -> Result<PropagatedCovariance, FitError> {
        let count = self.inputs.len();
        let refuse = |reason| {
            Err(FitError::problem(format!("the covariance of the inputs {reason}; it needs {count} rows and columns")))
        };
        if covariance.len() != count * count {
            return refuse("has the wrong number of elements");
        }
        for i in 0..count {
            for j in 0..count {
                let (element, mirrored) = (covariance[i * count + j], covariance[j * count + i]);
                let product = covariance[i * count + i] * covariance[j * count + j];
                if !(element.is_finite() && covariance[i * count + i] >= 0.0) {
                    return refuse("has an element that is not finite or a negative variance");
                }
                if element != mirrored {
                    return refuse("is not symmetric");
                }
                // Rounding of a product of two correlation coefficients of one.
                if element * element > product * (1.0 + 1e-12) {
                    return refuse("has a correlation coefficient beyond one");
                }
            }
        }
        let row = |i: usize| &self.coefficients[i * count..(i + 1) * count];
        Ok(PropagatedCovariance::new(self.parameters.len(), |i, j| {
            let mut sum = 0.0;
            for (a, left) in row(i).iter().enumerate() {
                for (b, right) in row(j).iter().enumerate() {
                    sum += (*left)? * covariance[a * count + b] * (*right)?;
                }
            }
            (count > 0).then_some(sum)
        }))
    }

    /// [`propagate`](Self::propagate) for inputs of these standard uncertainties that are not correlated.
    ///
    /// # Errors
    /// Those of [`propagate`](Self::propagate).
    pub fn propagate_uncorrelated(&self, uncertainties: &[f64]) -> Result<PropagatedCovariance, FitError> {
        let count = uncertainties.len();
        let mut covariance = vec![0.0; count * count];
        for (i, uncertainty) in uncertainties.iter().enumerate() {
            covariance[i * count + i] = uncertainty * uncertainty;
        }
        self.propagate(&covariance)
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

/// Covariance of the estimates of a fit that the uncertainty of its inputs brings about (JCGM 100:2008, 5.2.2, and
/// JCGM 102:2011, 6.2.1).
#[derive(Debug, Clone, PartialEq)]
pub struct PropagatedCovariance {
    count: usize,
    elements: Vec<Option<f64>>,
}

impl PropagatedCovariance {
    pub(crate) fn new(count: usize, element: impl Fn(usize, usize) -> Option<f64>) -> Self {
        let elements = (0..count * count).map(|index| element(index / count, index % count)).collect();
        Self { count, elements }
    }

    /// Covariance of the estimates of parameters `i` and `j`, in the product of their units; `None` if either is fixed
    /// or not determined.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        if i < self.count && j < self.count { self.elements[i * self.count + j] } else { None }
    }

    /// Standard uncertainty of the estimate of parameter `i` from the inputs alone, in its unit.
    pub fn standard_uncertainty(&self, i: usize) -> Option<f64> {
        self.covariance(i, i).map(|variance| variance.max(0.0).sqrt())
    }
}
