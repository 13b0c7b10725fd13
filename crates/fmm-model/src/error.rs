//! Errors of the description of a machine.

use core::error::Error;
use core::fmt;

use crate::estimate::Rounded;

/// A machine description that cannot be.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ModelError {
    /// A quantity that must be positive is zero, negative or not finite.
    NotPositive {
        /// Name of the quantity.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// Its SI unit.
        unit: &'static str,
    },
    /// A quantity that must not be negative is negative or not finite.
    Negative {
        /// Name of the quantity.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// Its SI unit.
        unit: &'static str,
    },
    /// A quantity that may have either sign is infinite or not a number.
    NotFinite {
        /// Name of the quantity.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// Its SI unit.
        unit: &'static str,
    },
    /// Bounds that no value can satisfy.
    InvertedBounds {
        /// The lower bound given.
        lower: f64,
        /// The upper bound given.
        upper: f64,
    },
}

impl ModelError {
    /// Passes `value` through if it is positive and finite.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] otherwise.
    pub fn require_positive(quantity: &'static str, value: f64, unit: &'static str) -> Result<f64, Self> {
        if value > 0.0 && value.is_finite() { Ok(value) } else { Err(Self::NotPositive { quantity, value, unit }) }
    }

    /// Passes `value` through if it is zero or positive and finite.
    ///
    /// # Errors
    /// [`ModelError::Negative`] otherwise.
    pub fn require_not_negative(quantity: &'static str, value: f64, unit: &'static str) -> Result<f64, Self> {
        if value >= 0.0 && value.is_finite() { Ok(value) } else { Err(Self::Negative { quantity, value, unit }) }
    }

    /// Passes `value` through if it is finite.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] otherwise.
    pub fn require_finite(quantity: &'static str, value: f64, unit: &'static str) -> Result<f64, Self> {
        if value.is_finite() { Ok(value) } else { Err(Self::NotFinite { quantity, value, unit }) }
    }
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (quantity, value, unit, range) = match self {
            Self::NotPositive { quantity, value, unit } => (quantity, value, unit, "positive and finite"),
            Self::Negative { quantity, value, unit } => (quantity, value, unit, "zero or positive and finite"),
            Self::NotFinite { quantity, value, unit } => (quantity, value, unit, "finite"),
            Self::InvertedBounds { lower, upper } => {
                let [lower, upper] = [lower, upper].map(|bound| Rounded::every_digit(*bound));
                return write!(
                    f,
                    "the lower bound {lower} must not exceed the upper bound {upper}, and neither may be NaN"
                );
            }
        };
        write!(f, "{quantity} must be {range}, but is {} {unit}", Rounded::every_digit(*value))
    }
}

impl Error for ModelError {}
