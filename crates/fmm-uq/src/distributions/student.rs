//! Quantiles of Student's t, which the coverage factors of the GUM are.

use statrs::distribution::{Continuous, ContinuousCDF, Normal, StudentsT};

/// Above this many degrees of freedom the expansion about the normal distribution is the more accurate.
pub(crate) const EXPANSION_ABOVE: f64 = 1000.0;

/// The value that Student's t of ν ≥ 1 degrees of freedom exceeds with probability `tail` ≤ 1/2.
///
/// The lower tail keeps its digits where 1 − tail would round to 1.
pub(crate) fn upper_quantile(tail: f64, nu: f64) -> f64 {
    if nu <= EXPANSION_ABOVE
        && let Ok(student) = StudentsT::new(0.0, 1.0, nu)
    {
        return refine(-student.inverse_cdf(tail), tail, &student);
    }
    let z = -Normal::standard().inverse_cdf(tail);
    let s = z * z;
    let terms = [
        z * (s + 1.0) / 4.0,
        z * ((5.0 * s + 16.0) * s + 3.0) / 96.0,
        z * (((3.0 * s + 19.0) * s + 17.0) * s - 15.0) / 384.0,
        z * ((((79.0 * s + 776.0) * s + 1482.0) * s - 1920.0) * s - 945.0) / 92_160.0,
    ];
    z + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / nu)
}

/// Steps of the refinement; two are the rule, ten where the start is wrong by its order of magnitude.
const STEPS: usize = 40;

/// The same from a value near it, by Newton's method between the logarithms of value and tail, which is nearly a
/// straight line where tails are small: there the inverse itself has an absolute floor.
fn refine(near: f64, tail: f64, student: &StudentsT) -> f64 {
    // The line that the tail becomes, whose slope is −ν.
    let nu = student.freedom();
    let far = || ((student.ln_pdf(1e100) + 1e100_f64.ln() * (nu + 1.0) - nu.ln() - tail.ln()) / nu).exp();
    let mut x = if near.is_finite() { near } else { far() };
    let mut last = f64::INFINITY;
    for _ in 0..STEPS {
        let (beyond, density) = (student.sf(x), student.pdf(x));
        // Relative to x where that is large, and never by more than its order of magnitude.
        let step = if x > 1.0 { (beyond / tail).ln() * beyond / (x * density) } else { (beyond - tail) / density };
        // Steps that no longer shrink are rounding.
        if !(step.abs() < last) || step == 0.0 {
            break;
        }
        last = step.abs();
        x += if x > 1.0 { x * step.clamp(-2.0, 2.0).exp_m1() } else { step };
    }
    x
}

/// The quantile of Student's t for a probability in (0, 1).
pub(crate) fn quantile(probability: f64, nu: f64) -> f64 {
    if probability == 0.5 {
        0.0
    } else if probability < 0.5 {
        -upper_quantile(probability, nu)
    } else {
        upper_quantile(1.0 - probability, nu)
    }
}
