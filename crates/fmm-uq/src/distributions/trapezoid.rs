//! The symmetric trapezoid, and the triangle as its limit.

/// The trapezoidal distribution Trap(a, b, β): a sum of two rectangular ones (JCGM 101:2008, 6.4.4); β, the ratio
/// of its top to its base, is 0 for the triangle (6.4.5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Trapezoid {
    centre: f64,
    base: f64,
    top: f64,
}

impl Trapezoid {
    /// The caller has seen to a < b and 0 ≤ β < 1.
    pub(crate) fn new(lower: f64, upper: f64, ratio: f64) -> Self {
        let base = 0.5 * (upper - lower);
        Self { centre: 0.5 * lower + 0.5 * upper, base, top: ratio * base }
    }

    pub(crate) fn mean(&self) -> f64 {
        self.centre
    }

    /// The root of (b − a)² (1 + β²)/24.
    pub(crate) fn standard_deviation(&self) -> f64 {
        self.base.hypot(self.top) / 6f64.sqrt()
    }

    /// Whether there is no top.
    pub(crate) const fn is_triangle(&self) -> bool {
        self.top == 0.0
    }

    /// β.
    pub(crate) fn ratio(&self) -> f64 {
        self.top / self.base
    }

    /// The smallest and the largest value.
    pub(crate) fn limits(&self) -> (f64, f64) {
        (self.centre - self.base, self.centre + self.base)
    }

    /// The value of two uniform numbers.
    #[inline]
    pub(crate) fn of(&self, [first, second]: [f64; 2]) -> f64 {
        self.centre + (self.base + self.top) * (first - 0.5) + (self.base - self.top) * (second - 0.5)
    }

    pub(crate) fn quantile(&self, probability: f64) -> f64 {
        let tail = probability.min(1.0 - probability);
        let (slope_width, plateau) = (self.base - self.top, self.base + self.top);
        let in_slope = 0.5 * slope_width / plateau;
        let distance = if tail < in_slope {
            self.base - (2.0 * tail * slope_width * plateau).sqrt()
        } else {
            (0.5 - tail) * plateau
        };
        if probability < 0.5 { self.centre - distance } else { self.centre + distance }
    }
}
