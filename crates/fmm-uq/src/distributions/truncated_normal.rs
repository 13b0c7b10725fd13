//! A normal distribution between limits.

use rand::{Rng, RngExt};
use statrs::distribution::{ContinuousCDF, Normal};

/// Nodes and weights of Gauss's rule of five points on [−1, 1].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];
/// Panels of the rule, which then leaves nothing but rounding.
const PANELS: u32 = 200;
/// Exponent at which the density is cut off: e^(−40) of its highest value is left there.
const EXPONENT: f64 = 40.0;

/// A normal quantity of which it is known that it lies between two limits, one of which may be infinite.
///
/// ```text
/// g(x) ∝ exp(−(x − μ)²/2σ²),   a ≤ x ≤ b
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TruncatedNormal {
    centre: f64,
    scale: f64,
    limits: (f64, f64),
    /// Probabilities of an untruncated value below the lower and above the upper limit.
    cut: (f64, f64),
    mean: f64,
    standard_deviation: f64,
}

impl TruncatedNormal {
    /// The caller has seen to a finite μ, σ > 0 and a < b. `None` if the limits leave so little of the distribution
    /// that its probability is no number.
    pub(crate) fn new(centre: f64, scale: f64, limits: (f64, f64)) -> Option<Self> {
        let (low, high) = ((limits.0 - centre) / scale, (limits.1 - centre) / scale);
        let normal = Normal::standard();
        let cut = (normal.cdf(low), normal.sf(high));
        let inside = if low > 0.0 { normal.sf(low) - cut.1 } else { 1.0 - cut.0 - cut.1 };
        let inside = if high < 0.0 { normal.cdf(high) - cut.0 } else { inside };
        if !(inside > f64::MIN_POSITIVE / f64::EPSILON) {
            return None;
        }
        let (mean, deviation) = moments(low, high);
        let (mean, standard_deviation) = (centre + scale * mean, scale * deviation);
        Some(Self { centre, scale, limits, cut, mean, standard_deviation })
    }

    pub(crate) const fn parameters(&self) -> (f64, f64) {
        (self.centre, self.scale)
    }

    pub(crate) const fn limits(&self) -> (f64, f64) {
        self.limits
    }

    pub(crate) const fn mean(&self) -> f64 {
        self.mean
    }

    pub(crate) const fn standard_deviation(&self) -> f64 {
        self.standard_deviation
    }

    pub(crate) fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        // 1 − u is never zero, which has no quantile.
        self.quantile(1.0 - rng.random::<f64>())
    }

    /// In the tail that the limits lie in, where probabilities keep their digits.
    pub(crate) fn quantile(&self, probability: f64) -> f64 {
        let (low, high) = ((self.limits.0 - self.centre) / self.scale, (self.limits.1 - self.centre) / self.scale);
        let normal = Normal::standard();
        let z = if low > 0.0 {
            let beyond = normal.sf(low);
            -normal.inverse_cdf(beyond - probability * (beyond - self.cut.1))
        } else {
            let below = if high < 0.0 { normal.cdf(high) } else { 1.0 - self.cut.1 };
            normal.inverse_cdf(self.cut.0 + probability * (below - self.cut.0))
        };
        (self.centre + self.scale * z).clamp(self.limits.0, self.limits.1)
    }
}

/// Mean and standard deviation in units of σ about μ, by quadrature: the closed form cancels where limits are close
/// together or far out.
fn moments(low: f64, high: f64) -> (f64, f64) {
    let mode = 0.0_f64.clamp(low, high);
    // (z² − mode²)/2 = 40 on both sides of the mode.
    let reach = (mode * mode + 2.0 * EXPONENT).sqrt();
    let (start, end) = (low.max(-reach), high.min(reach));
    let width = (end - start) / f64::from(PANELS);
    let sums = |about: f64| {
        let mut sums = [0.0; 3];
        for panel in 0..PANELS {
            let centre = start + width * (f64::from(panel) + 0.5);
            for (node, weight) in GAUSS {
                let z = centre + 0.5 * width * node;
                // (mode − z)(mode + z) keeps the digits of a difference of squares.
                let density = weight * (0.5 * (mode - z) * (mode + z)).exp();
                for (sum, power) in sums.iter_mut().zip([1.0, z - about, (z - about) * (z - about)]) {
                    *sum += density * power;
                }
            }
        }
        sums
    };
    let [all, first, _] = sums(mode);
    let mean = mode + first / all;
    let [all, _, second] = sums(mean);
    (mean, (second / all).sqrt())
}
