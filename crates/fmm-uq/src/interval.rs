//! Coverage interval with its probability.

use std::fmt;

use crate::report::rounding::percent;

/// A coverage interval.
///
/// ```
/// use fmm_uq::{Input, Inputs, propagate};
///
/// let length = propagate(&Inputs::new([Input::new("l", 2.0, 0.5, "m")?])?, |x| x[0])?;
/// assert_eq!(format!("{:.2}", length.expanded(0.95)?.interval()), "[1.02, 2.98] (95 %)");
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Interval {
    /// Lower end (unit of the result).
    pub low: f64,
    /// Upper end (unit of the result).
    pub high: f64,
    /// p, coverage probability (1).
    pub level: f64,
}

impl fmt::Display for Interval {
    /// "[1.47, 2.58] (95 %)", with all digits unless a precision is given.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = percent(self.level);
        match f.precision() {
            Some(decimals) => write!(f, "[{:.decimals$}, {:.decimals$}] ({level})", self.low, self.high),
            None => write!(f, "[{}, {}] ({level})", self.low, self.high),
        }
    }
}

impl Interval {
    /// Distance of the ends (unit of the result).
    pub const fn width(&self) -> f64 {
        self.high - self.low
    }
}
