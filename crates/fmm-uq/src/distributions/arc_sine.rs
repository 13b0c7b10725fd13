//! The distribution of a sine of unknown phase.

use std::f64::consts::{PI, SQRT_2};

/// The arc sine (U-shaped) distribution U(a, b) of a quantity that cycles between two limits (JCGM 101:2008, 6.4.6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ArcSine {
    centre: f64,
    amplitude: f64,
}

impl ArcSine {
    /// The caller has seen to a < b.
    pub(crate) fn new(lower: f64, upper: f64) -> Self {
        Self { centre: 0.5 * lower + 0.5 * upper, amplitude: 0.5 * (upper - lower) }
    }

    pub(crate) fn mean(&self) -> f64 {
        self.centre
    }

    pub(crate) fn standard_deviation(&self) -> f64 {
        self.amplitude / SQRT_2
    }

    /// The smallest and the largest value.
    pub(crate) fn limits(&self) -> (f64, f64) {
        (self.centre - self.amplitude, self.centre + self.amplitude)
    }

    /// The value of a point of the unit square, and whether that lies in the unit disc: such a point has a random
    /// phase, and the cosine of twice that needs no cosine.
    #[inline]
    pub(crate) fn of(&self, [x, y]: [f64; 2]) -> (f64, bool) {
        let (xx, yy) = (x * x, y * y);
        let square = xx + yy;
        (self.centre + self.amplitude * ((xx - yy) / square), square <= 1.0 && square > 0.0)
    }

    pub(crate) fn quantile(&self, probability: f64) -> f64 {
        // The sine keeps the centre exact, where the cosine of π/2 would not be zero.
        self.centre + self.amplitude * (PI * (probability - 0.5)).sin()
    }
}
