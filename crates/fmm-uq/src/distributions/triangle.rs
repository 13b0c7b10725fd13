//! Triangular distribution, symmetric or not.

/// The triangular distribution between two limits with its highest density at a mode anywhere between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Triangle {
    lower: f64,
    mode: f64,
    upper: f64,
}

impl Triangle {
    /// The caller has seen to a < b and a ≤ m ≤ b.
    pub(crate) const fn new(lower: f64, mode: f64, upper: f64) -> Self {
        Self { lower, mode, upper }
    }

    pub(crate) const fn parameters(&self) -> (f64, f64, f64) {
        (self.lower, self.mode, self.upper)
    }

    /// (a + m + b)/3.
    pub(crate) fn mean(&self) -> f64 {
        self.mode + ((self.lower - self.mode) + (self.upper - self.mode)) / 3.0
    }

    /// The root of (p² + p q + q²)/18 with p and q the widths on both sides of the mode.
    pub(crate) fn standard_deviation(&self) -> f64 {
        let (p, q) = (self.mode - self.lower, self.upper - self.mode);
        let whole = p + q;
        whole * ((1.0 - (p / whole) * (q / whole)) / 18.0).sqrt()
    }

    pub(crate) fn quantile(&self, probability: f64) -> f64 {
        let (p, q) = (self.mode - self.lower, self.upper - self.mode);
        if probability * (p + q) < p {
            self.lower + (probability * (p + q) * p).sqrt()
        } else {
            self.upper - ((1.0 - probability) * (p + q) * q).sqrt()
        }
    }
}
