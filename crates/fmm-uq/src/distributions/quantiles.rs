//! Quantiles that have no closed form, or lose digits in it.

use statrs::distribution::{Continuous, ContinuousCDF, Gamma};
use statrs::function::beta::{beta_reg, inv_beta_reg, ln_beta};
use statrs::function::gamma::ln_gamma;

/// Quantiles of the gamma distribution below this are close to the first term of a series of few terms (1).
const SERIES_BELOW: f64 = 0.1;

/// The distance from the centre that a curvilinear trapezoid of half width w and inexactness d exceeds, on one side,
/// with the probability `tail` ≤ 1/2.
///
/// ```text
/// g(s) = ln((w + d)/max(|s|, w − d))/(4 d)                         (JCGM 101:2008, Eq. 4)
/// ```
///
/// It is linear in the middle; in the tail, with y = s/(w + d), it solves
///
/// ```text
/// 1 − y + y ln y = 4 d p/(w + d)
/// ```
pub(super) fn curvilinear_trapezoid(w: f64, d: f64, tail: f64) -> f64 {
    let target = 4.0 * d * tail / (w + d);
    let inner = (w - d) / (w + d);
    if target < shortfall(1.0 - inner) {
        (w + d) * (1.0 - solve_shortfall(target, 1.0 - inner))
    } else {
        (0.5 - tail) * 4.0 * d / ((w + d) / (w - d)).ln()
    }
}

/// e + (1 − e) ln(1 − e), which is e²/2 + e³/6 + … and would lose its digits as a difference where e is small.
fn shortfall(e: f64) -> f64 {
    if e >= 1.0 {
        return 1.0;
    }
    if e > 0.1 {
        return e + (1.0 - e) * (-e).ln_1p();
    }
    (2..=18).rev().fold(0.0, |sum, k| (sum + 1.0 / f64::from(k * (k - 1))) * e) * e
}

/// The e whose shortfall is `target`, at most `largest`. Newton's steps come down from above, since the function
/// is convex and the root of twice the target is never too small.
fn solve_shortfall(target: f64, largest: f64) -> f64 {
    let mut e = (2.0 * target).sqrt().min(largest).min(1.0 - f64::EPSILON);
    for _ in 0..60 {
        let slope = -(-e).ln_1p();
        if slope == 0.0 {
            break;
        }
        let step = (shortfall(e) - target) / slope;
        e -= step;
        if step.abs() <= f64::EPSILON * e {
            break;
        }
    }
    e
}

/// The quantile of the beta distribution if it lies in the lower half of (0, 1), by Newton's method between logarithms
/// from its leading term or the inverse function, whichever is good there.
///
/// ```text
/// I_s(α, β) ≈ s^α/(α B(α, β)) for small s,   d ln I/d ln s = s^α (1 − s)^(β−1)/(B I)
/// ```
pub(super) fn beta(a: f64, b: f64, probability: f64) -> f64 {
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

/// The quantile of the gamma distribution of unit scale, to the digits of its distribution function.
pub(super) fn gamma(shape: f64, probability: f64) -> f64 {
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
