//! Quantiles of Student's t, which the coverage factors of the GUM are.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Above this many degrees of freedom the expansion about the normal distribution is the more accurate.
pub(crate) const EXPANSION_ABOVE: f64 = 1000.0;

/// The value that Student's t of ν ≥ 1 degrees of freedom exceeds with probability `tail` ≤ 1/2.
///
/// The lower tail keeps its digits where 1 − tail would round to 1.
pub(crate) fn upper_quantile(tail: f64, nu: f64) -> f64 {
    if nu <= EXPANSION_ABOVE
        && let Ok(student) = StudentsT::new(0.0, 1.0, nu)
    {
        return -student.inverse_cdf(tail);
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
