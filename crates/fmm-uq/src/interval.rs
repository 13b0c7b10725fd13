//! A range of values and the probability that it covers the quantity.

/// A coverage interval.
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

impl Interval {
    /// Distance of the ends (unit of the result).
    pub const fn width(&self) -> f64 {
        self.high - self.low
    }
}
