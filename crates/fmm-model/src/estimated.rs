//! A number and how well it is known.

use core::fmt;

use crate::Rounded;

/// An estimate with its standard uncertainty, both in the unit that stands beside the field.
///
/// `Display` rounds it to its significant digits.
///
/// ```
/// use fmm_model::Estimated;
///
/// let friction = Estimated::new(0.029_918, 6.1e-4);
/// assert_eq!(friction.to_string(), "0.02992 ± 0.00061");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimated {
    /// The estimate.
    pub value: f64,
    /// u, its standard uncertainty.
    pub uncertainty: f64,
}

impl Estimated {
    /// `value` with its standard `uncertainty`, in the same unit.
    pub const fn new(value: f64, uncertainty: f64) -> Self {
        Self { value, uncertainty }
    }

    /// Both times `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { value: self.value * factor, uncertainty: self.uncertainty * factor.abs() }
    }
}

impl fmt::Display for Estimated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&Rounded::new(self.value, Some(self.uncertainty)), f)
    }
}
