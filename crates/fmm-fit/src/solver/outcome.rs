//! Outcome of a fit.

use std::fmt;

use fmm_model::Rounded;

/// End of a fit. All of them leave the best point found; `Display` gives a sentence of advice.
///
/// ```
/// use fmm_fit::Outcome;
///
/// assert!(Outcome::CostConverged.is_success());
/// assert!(!Outcome::Stalled.is_success());
/// assert!(Outcome::MaxIterations.to_string().contains("raise the limit"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Outcome {
    /// The residual is orthogonal to every direction in which the free parameters can move it.
    GradientSmall,
    /// A step would no longer lower the sum of squares by a relevant amount.
    CostConverged,
    /// The parameters no longer change by a relevant amount.
    StepConverged,
    /// The residuals are as small as rounding allows: the model reproduces the data exactly.
    AtNoiseFloor,
    /// Every parameter is fixed; the residuals are those of the start.
    NoFreeParameters,
    /// Steps became tiny although the gradient says that smaller residuals are near.
    Stalled,
    /// The model has no finite value on the way to smaller residuals.
    NonFinite,
    /// The limit on iterations was reached.
    MaxIterations,
    /// The limit on evaluations of the residuals was reached.
    MaxEvaluations,
    /// The time limit was reached.
    TimedOut,
    /// The fit was cancelled from outside.
    Cancelled,
}

impl Outcome {
    /// True if the point found is a local minimum, as far as the solver can tell.
    pub const fn is_success(self) -> bool {
        matches!(
            self,
            Self::GradientSmall
                | Self::CostConverged
                | Self::StepConverged
                | Self::AtNoiseFloor
                | Self::NoFreeParameters
        )
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::GradientSmall => "converged: the gradient vanishes",
            Self::CostConverged => "converged: the sum of squares no longer falls",
            Self::StepConverged => "converged: the parameters no longer change",
            Self::AtNoiseFloor => "converged: the residuals are at the rounding noise of the model",
            Self::NoFreeParameters => "nothing to fit: every parameter is fixed",
            Self::Stalled => {
                "stalled away from a minimum: residuals or derivatives are discontinuous or wrong near this point; \
                 check them, or start elsewhere"
            }
            Self::NonFinite => {
                "stopped: the model has no finite value beyond this point; tighten the bounds or start elsewhere"
            }
            Self::MaxIterations => "stopped at the limit on iterations: start from here again or raise the limit",
            Self::MaxEvaluations => "stopped at the limit on evaluations: start from here again or raise the limit",
            Self::TimedOut => "stopped at the time limit: start from here again or allow more time",
            Self::Cancelled => "stopped by its observer: the values are the best so far",
        })
    }
}

/// Number that was not finite when a fit last gave a trial point up.
///
/// `Display` gives it in words.
///
/// ```
/// use fmm_fit::NonFinite;
///
/// let overflow = NonFinite::Residual { index: 3, value: f64::INFINITY };
/// assert_eq!(overflow.to_string(), "residual 3 is inf");
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum NonFinite {
    /// A residual is NaN, infinite, or so large that the sum of squares overflows.
    Residual {
        /// Index of the residual, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A derivative is NaN, infinite, or so large that its square overflows.
    Derivative {
        /// Name of the parameter.
        parameter: String,
    },
    /// The model failed, and said this.
    Model(String),
}

impl fmt::Display for NonFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Residual { index, value } => write!(f, "residual {index} is {}", Rounded::every_digit(*value)),
            Self::Derivative { parameter } => write!(f, "the derivative of the residuals by {parameter} is not finite"),
            Self::Model(text) => write!(f, "the model said: {text}"),
        }
    }
}

/// The residual that is NaN or largest, by index and value; that is why a sum of squares is not finite.
pub(crate) fn worst(residuals: &[f64]) -> (usize, f64) {
    let size = |value: f64| if value.is_nan() { f64::INFINITY } else { value.abs() };
    let numbered = residuals.iter().copied().enumerate();
    numbered.fold((0, 0.0), |worst, next| if size(next.1) > size(worst.1) { next } else { worst })
}
