//! Number of a problem that is not finite at a trial point.

use std::fmt;

use fmm_model::Rounded;

/// What had no finite value when a fit last gave a trial point up.
///
/// `Display` gives it in words.
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
