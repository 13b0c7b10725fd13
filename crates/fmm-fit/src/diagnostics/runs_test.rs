//! Runs test: number of changes of sign of residuals beside that of noise.

use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::factorial::ln_binomial;

/// Numbers of residuals up to which the distribution of the runs is summed exactly.
const EXACT: usize = 2000;

/// Wald and Wolfowitz' test of the runs of equal sign.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RunsTest {
    /// Number of runs.
    pub runs: usize,
    /// Number of positive residuals.
    pub positive: usize,
    /// Number of negative residuals.
    pub negative: usize,
    /// Number of runs to be expected of independent residuals, 1 + 2 n₊ n₋/(n₊ + n₋).
    pub expected: f64,
    /// Probability of runs at least as unusual, in either direction, if the residuals are independent (1).
    pub p_value: f64,
    /// Whether the probability is exact; otherwise it is that of the normal approximation.
    pub is_exact: bool,
}

/// Counts the runs of equal sign among residuals in their order; zeros are left out. `None` unless both signs occur.
///
/// ```text
/// P(R = 2k)     = 2 C(n₊−1, k−1) C(n₋−1, k−1)/C(n₊+n₋, n₊)
/// P(R = 2k + 1) = (C(n₊−1, k) C(n₋−1, k−1) + C(n₊−1, k−1) C(n₋−1, k))/C(n₊+n₋, n₊)
/// p             = min(1, 2 P(R ≤ runs), 2 P(R ≥ runs))
/// ```
///
/// A model that misses something leaves too few runs. The test sees only signs, so outliers do not disturb it. Beyond
/// 2000 residuals the normal approximation is used.
///
/// ```
/// let test = fmm_fit::runs_test(&[1.0, 2.0, 0.5, -1.0, -0.2, -3.0]).unwrap();
/// assert_eq!((test.runs, test.expected), (2, 4.0));
/// // Two of the twenty orders of three and three have two runs.
/// assert!((test.p_value - 0.2).abs() < 1e-12);
/// ```
///
/// # References
/// A. Wald, J. Wolfowitz, "On a test whether two samples are from the same population", Ann. Math. Stat. 11 (1940) 147,
/// <https://doi.org/10.1214/aoms/1177731909>.
pub fn runs_test(residuals: &[f64]) -> Option<RunsTest> {
    if !residuals.iter().all(|r| r.is_finite()) {
        return None;
    }
    let signs: Vec<bool> = residuals.iter().filter(|r| **r != 0.0).map(|r| *r > 0.0).collect();
    let positive = signs.iter().filter(|sign| **sign).count();
    let negative = signs.len() - positive;
    if positive == 0 || negative == 0 {
        return None;
    }
    let runs = 1 + signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let (n, product) = (signs.len() as f64, positive as f64 * negative as f64);
    let expected = 1.0 + 2.0 * product / n;
    let is_exact = signs.len() <= EXACT;
    let p_value = if is_exact {
        exact_p(runs, positive as u64, negative as u64)
    } else {
        let variance = 2.0 * product * (2.0 * product - n) / (n * n * (n - 1.0));
        let z = (runs as f64 - expected).abs() / variance.sqrt();
        2.0 * Normal::new(0.0, 1.0).ok()?.sf(z)
    };
    Some(RunsTest { runs, positive, negative, expected, p_value, is_exact })
}

fn exact_p(runs: usize, positive: u64, negative: u64) -> f64 {
    let all = ln_binomial(positive + negative, positive);
    let choose = |n: u64, k: u64| if k > n { f64::NEG_INFINITY } else { ln_binomial(n, k) };
    let probability = |r: usize| {
        let k = (r / 2) as u64;
        let term = |i: u64, j: u64| (choose(positive - 1, i) + choose(negative - 1, j) - all).exp();
        if r.is_multiple_of(2) { 2.0 * term(k - 1, k - 1) } else { term(k, k - 1) + term(k - 1, k) }
    };
    let most = (positive + negative) as usize;
    let few: f64 = (2..=runs).map(probability).sum();
    let many: f64 = (runs..=most).map(probability).sum();
    (2.0 * few.min(many)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// p by enumerating all orders of the signs in Python (`itertools.combinations`).
    #[test]
    fn probabilities_are_those_of_all_orders() {
        for (series, runs, p) in [
            ("++++----", 2, 2.0 / 35.0),
            ("+-+-+-+-", 8, 2.0 / 35.0),
            ("++-+--++-+", 7, 13.0 / 21.0),
            ("+++++++-++--------", 4, 73.0 / 12155.0),
            ("+++-++++++++", 3, 1.0 / 1.0),
        ] {
            let values: Vec<f64> = series.chars().map(|sign| if sign == '+' { 0.5 } else { -2.0 }).collect();
            let test = runs_test(&values).unwrap();
            assert_eq!(test.runs, runs, "{series}");
            // Logarithms of binomials keep about 13 digits.
            assert!((test.p_value - p).abs() < 1e-11, "{series}: p = {} instead of {p}", test.p_value);
        }
    }

    #[test]
    fn approximation_joins_the_exact_values() {
        let series = |n: u32| -> Vec<f64> { (0..n).map(|i| if (i * i / 7) % 2 == 0 { 1.0 } else { -1.0 }).collect() };
        let (exact, approximate) = (runs_test(&series(2000)).unwrap(), runs_test(&series(2001)).unwrap());
        assert!(exact.is_exact && !approximate.is_exact);
        // Without a continuity correction the approximation is off by half a step, 1/√n of a standard deviation.
        assert!((exact.p_value - approximate.p_value).abs() < 0.04, "{exact:?} against {approximate:?}");
    }

    #[test]
    fn one_sign_has_no_runs_to_count() {
        assert_eq!(runs_test(&[1.0, 2.0, 0.0]), None);
        assert_eq!(runs_test(&[]), None);
        assert_eq!(runs_test(&[1.0, f64::NAN, -1.0]), None);
    }
}
