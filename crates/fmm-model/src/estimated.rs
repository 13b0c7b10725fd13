//! Estimate: a number with its standard uncertainty, or with an interval that covers it.

use core::fmt;

use crate::{Rounded, math};

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

/// A coverage interval.
///
/// ```
/// use fmm_model::Interval;
///
/// let interval = Interval { low: 1.02, high: 2.98, level: 0.95 };
/// assert_eq!(format!("{interval:.1}"), "[1.0, 3.0] (95 %)");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Interval {
    /// Lower end (unit of the result).
    pub low: f64,
    /// Upper end (unit of the result).
    pub high: f64,
    /// p, coverage probability (1).
    pub level: f64,
}

impl Interval {
    /// Distance of the ends (unit of the result).
    pub const fn width(&self) -> f64 {
        self.high - self.low
    }
}

impl fmt::Display for Interval {
    /// "[1.47, 2.58] (95 %)", with all digits unless a precision is given.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Without the rounding of 100 p, which is 99.72999999999999 for 0.9973.
        let percent = Rounded::every_digit(math::round(1e10 * self.level) / 1e8);
        match f.precision() {
            Some(decimals) => write!(f, "[{:.decimals$}, {:.decimals$}] ({percent} %)", self.low, self.high),
            None => write!(f, "[{}, {}] ({percent} %)", self.low, self.high),
        }
    }
}
