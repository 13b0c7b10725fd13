//! The beta distribution between two limits.

use rand::Rng;
use rand_distr::Distribution as _;
use statrs::function::beta::{beta_reg, inv_beta_reg, ln_beta};

/// A quantity between two limits whose density is proportional to s^(α−1) (1 − s)^(β−1), s the place between them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Beta {
    shapes: (f64, f64),
    limits: (f64, f64),
    sampler: rand_distr::Beta<f64>,
}

impl Beta {
    /// The caller has seen to positive shapes and a < b; `None` for shapes that cannot be sampled.
    pub(crate) fn new(shapes: (f64, f64), limits: (f64, f64)) -> Option<Self> {
        let sampler = rand_distr::Beta::new(shapes.0, shapes.1).ok()?;
        Some(Self { shapes, limits, sampler })
    }

    pub(crate) const fn shapes(&self) -> (f64, f64) {
        self.shapes
    }

    pub(crate) const fn limits(&self) -> (f64, f64) {
        self.limits
    }

    pub(crate) fn mean(&self) -> f64 {
        let (a, b) = self.shapes;
        self.place(a / (a + b))
    }

    /// (b − a) √(α β/(α + β + 1))/(α + β).
    pub(crate) fn standard_deviation(&self) -> f64 {
        let (a, b) = self.shapes;
        let whole = a + b;
        (self.limits.1 - self.limits.0) * (a / whole * (b / whole) / (whole + 1.0)).sqrt()
    }

    pub(crate) fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.place(self.sampler.sample(rng))
    }

    /// From the nearer limit, where the distance keeps its digits.
    pub(crate) fn quantile(&self, probability: f64) -> f64 {
        let ((a, b), (low, high)) = (self.shapes, self.limits);
        if probability <= beta_reg(a, b, 0.5) {
            low + (high - low) * unit_quantile(a, b, probability)
        } else {
            high - (high - low) * unit_quantile(b, a, 1.0 - probability)
        }
    }

    fn place(&self, share: f64) -> f64 {
        self.limits.0 + (self.limits.1 - self.limits.0) * share
    }
}

/// The quantile in the lower half of (0, 1), by Newton's method between logarithms from its leading term or the inverse
/// function, whichever is good there.
///
/// ```text
/// I_s(α, β) ≈ s^α/(α B(α, β)) for small s,   d ln I/d ln s = s^α (1 − s)^(β−1)/(B I)
/// ```
fn unit_quantile(a: f64, b: f64, probability: f64) -> f64 {
    let ln_beta = ln_beta(a, b);
    let first = ((probability.ln() + a.ln() + ln_beta) / a).exp();
    if first < f64::MIN_POSITIVE {
        return 0.0;
    }
    let mut s = if first < 0.01 { first } else { inv_beta_reg(a, b, probability).clamp(1e-300, 0.5) };
    let mut last = f64::INFINITY;
    for _ in 0..40 {
        let below = beta_reg(a, b, s);
        let slope = (a * s.ln() + (b - 1.0) * (-s).ln_1p() - ln_beta).exp() / below;
        let step = (probability / below).ln() / slope;
        // Steps that no longer shrink are rounding.
        if !(step.abs() < last) || step == 0.0 {
            break;
        }
        last = step.abs();
        s = (s * step.clamp(-1.0, 1.0).exp()).min(0.5);
    }
    s
}
