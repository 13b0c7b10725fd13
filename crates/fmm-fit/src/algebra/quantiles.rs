//! Coverage factor of several estimates at once.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Degrees of freedom above which the expansion about the χ² distribution is the more accurate (1). From 10⁷ on the
/// inverse of statrs is wrong in the first digits, and from 10⁸ on it does not end.
const MANY_FOR_FISHER: f64 = 1e4;

/// The factor for `order` estimates, and all that depends on them linearly, at once (Scheffé).
pub(crate) fn simultaneous_coverage_factor(level: f64, order: usize, degrees_of_freedom: f64) -> Option<f64> {
    if !(is_probability(level) && degrees_of_freedom > 0.0) {
        return None;
    }
    let count = order as f64;
    let square = if degrees_of_freedom <= MANY_FOR_FISHER {
        count * FisherSnedecor::new(count, degrees_of_freedom).ok()?.inverse_cdf(level)
    } else {
        let square = ChiSquared::new(count).ok()?.inverse_cdf(level);
        square * (1.0 + 0.5 * (square - count + 2.0) / degrees_of_freedom)
    };
    Some(square.sqrt())
}

pub(crate) fn is_probability(level: f64) -> bool {
    level > 0.0 && level < 1.0
}

#[cfg(test)]
mod tests {
    use fmm_model::coverage_factor;

    use super::*;

    /// One estimate at once is one estimate: F of (1, ν) is the square of t of ν. Tables: t and χ² of Abramowitz and
    /// Stegun.
    #[test]
    fn factors_are_continuous_to_infinitely_many_degrees_of_freedom() {
        for (freedom, expected) in
            [(1.0, 12.706_205), (10.0, 2.228_139), (120.0, 1.979_930), (f64::INFINITY, 1.959_964)]
        {
            assert!((coverage_factor(0.95, freedom).unwrap() - expected).abs() < 1e-6, "{freedom} degrees of freedom");
        }
        assert!((simultaneous_coverage_factor(0.95, 3, f64::INFINITY).unwrap() - 7.814_728f64.sqrt()).abs() < 1e-6);
        for level in [0.5, 0.95, 0.9973] {
            let mut last = (f64::INFINITY, f64::INFINITY);
            for freedom in [900.0, 1100.0, 9e3, 1.1e4, 1e6, 1e7, 1e9, 1e15, f64::INFINITY] {
                let one = coverage_factor(level, freedom).unwrap();
                let same = simultaneous_coverage_factor(level, 1, freedom).unwrap();
                assert!((same / one - 1.0).abs() < 1e-6, "{one} and {same} at {freedom}");
                let three = simultaneous_coverage_factor(level, 3, freedom).unwrap();
                assert!(one <= last.0 && three <= last.1, "{one}, {three} at {freedom} after {last:?}");
                last = (one, three);
            }
        }
    }

    #[test]
    fn impossible_intervals_have_no_factor() {
        for (level, freedom) in [(0.0, 10.0), (1.0, 10.0), (f64::NAN, 10.0), (0.95, 0.0), (0.95, f64::NAN)] {
            assert_eq!(coverage_factor(level, freedom), None);
            assert_eq!(simultaneous_coverage_factor(level, 2, freedom), None);
        }
    }
}
