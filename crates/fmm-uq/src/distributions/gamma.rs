//! Quantiles of the gamma distribution, down to those that are next to nothing.

use statrs::distribution::{Continuous, ContinuousCDF, Gamma};
use statrs::function::gamma::ln_gamma;

/// Below this the series takes few terms, and the quantile is close to its first.
const SERIES_BELOW: f64 = 0.1;

/// The quantile of the gamma distribution of unit scale, to the digits of its distribution function.
pub(crate) fn gamma_quantile(shape: f64, probability: f64) -> f64 {
    let first = ((probability.ln() + ln_gamma(shape + 1.0)) / shape).exp();
    if first < SERIES_BELOW {
        return near_zero(shape, probability, first);
    }
    let Ok(unit) = Gamma::new(shape, 1.0) else { return f64::NAN };
    let near = unit.inverse_cdf(probability);
    // The search ends at a fixed tolerance; two of Newton's steps, in the smaller tail, take it to rounding.
    (0..2).fold(near, |x, _| {
        let error = if probability < 0.5 { unit.cdf(x) - probability } else { (1.0 - probability) - unit.sf(x) };
        let next = x - error / unit.pdf(x);
        if next > 0.0 && next.is_finite() { next } else { x }
    })
}

/// The quantile from its leading term `first`, by Newton's method between logarithms, with no absolute floor.
///
/// ```text
/// F(x) = x^α e^(−x)/Γ(α + 1) S(x),   S = 1 + x/(α + 1) + x²/((α + 1)(α + 2)) + …,   d ln F/d ln x = α/S
/// ```
fn near_zero(shape: f64, probability: f64, first: f64) -> f64 {
    let constant = ln_gamma(shape + 1.0) + probability.ln();
    let mut x = first;
    for _ in 0..20 {
        let (mut sum, mut term) = (1.0, 1.0);
        for k in 1..30 {
            term *= x / (shape + f64::from(k));
            sum += term;
        }
        if x < f64::MIN_POSITIVE {
            break;
        }
        let step = -(shape * x.ln() - x + sum.ln() - constant) * sum / shape;
        x += x * step.exp_m1();
        if step.abs() <= 4.0 * f64::EPSILON {
            break;
        }
    }
    x
}
