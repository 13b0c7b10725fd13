//! Test of residuals for a normal distribution.

use std::f64::consts::{PI, SQRT_2};

use statrs::function::erf::erfc;

/// Anderson and Darling's test of normality.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NormalityTest {
    /// A², distance of the sample from the normal distribution of its own mean and variance, weighted for the tails
    /// (1).
    pub statistic: f64,
    /// Probability of an A² at least as large if the residuals are independent and normal (1).
    pub p_value: f64,
}

/// Tests whether residuals are normal, with mean and variance taken from them. `None` for fewer than eight residuals,
/// if they are all equal, or not finite.
///
/// ```text
/// A² = −n − 1/n Σᵢ (2 i − 1) (ln Φ(z₍ᵢ₎) + ln(1 − Φ(z₍ₙ₊₁₋ᵢ₎))),     A*² = A² (1 + 0.75/n + 2.25/n²)
/// ```
///
/// The probability is Stephens' fit to simulated percentage points in A*²; below about 1e-4 it extrapolates them. The
/// test asks for independent residuals; correlated ones make it see departures that are none.
///
/// # References
/// T. W. Anderson, D. A. Darling, Ann. Math. Stat. 23 (1952) 193, <https://doi.org/10.1214/aoms/1177729437>;
/// M. A. Stephens in R. B. D'Agostino, M. A. Stephens (eds), Goodness-of-Fit Techniques, Dekker 1986, table 4.9.
pub fn anderson_darling(residuals: &[f64]) -> Option<NormalityTest> {
    let n = residuals.len() as f64;
    if residuals.len() < 8 {
        return None;
    }
    let mean = residuals.iter().sum::<f64>() / n;
    let variance = residuals.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / (n - 1.0);
    if !(variance > 0.0 && variance.is_finite()) {
        return None;
    }
    let deviation = variance.sqrt();
    let mut z: Vec<f64> = residuals.iter().map(|r| (r - mean) / deviation).collect();
    z.sort_by(f64::total_cmp);
    let terms = z.iter().zip(z.iter().rev()).enumerate();
    let sum: f64 = terms.map(|(i, (low, high))| (2 * i + 1) as f64 * (ln_below(*low) + ln_below(-high))).sum();
    let statistic = -n - sum / n;
    Some(NormalityTest { statistic, p_value: p_value(statistic * (1.0 + 0.75 / n + 2.25 / (n * n))) })
}

/// ln Φ(z), in the far tail by the leading terms of its asymptotic series.
fn ln_below(z: f64) -> f64 {
    if z > -30.0 {
        (0.5 * erfc(-z / SQRT_2)).ln()
    } else {
        -0.5 * z * z - (-z * (2.0 * PI).sqrt()).ln() - 1.0 / (z * z)
    }
}

fn p_value(a: f64) -> f64 {
    let square = a * a;
    if a <= 0.2 {
        1.0 - (-13.436 + 101.14 * a - 223.73 * square).exp()
    } else if a <= 0.34 {
        1.0 - (-8.318 + 42.796 * a - 59.938 * square).exp()
    } else if a <= 0.6 {
        (0.9177 - 4.279 * a - 1.38 * square).exp()
    } else if a <= 153.0 {
        (1.2937 - 5.709 * a + 0.0186 * square).exp()
    } else {
        // Where the parabola turns upwards.
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A² and p of `statsmodels.stats.diagnostic.normal_ad` (0.15).
    #[test]
    fn agrees_with_statsmodels() {
        let samples: [(&str, Vec<f64>); 3] = [
            ("waves", (0..40).map(|i| (1.3 * f64::from(i)).sin()).collect()),
            ("sums", (0..30).map(|i| (1.3 * f64::from(i)).sin() + (2.9 * f64::from(i)).cos() * 0.8).collect()),
            ("squares", (0..25).map(|i| f64::from(i * i)).collect()),
        ];
        for ((name, sample), (statistic, p)) in samples.iter().zip([
            (1.184_258_025_19, 0.003_786_337_941_34),
            (0.235_155_300_628, 0.771_631_726_783),
            (0.874_270_921_865, 0.021_279_116_998_6),
        ]) {
            let test = anderson_darling(sample).unwrap();
            assert!((test.statistic - statistic).abs() < 1e-9, "{name}: A² = {}", test.statistic);
            assert!((test.p_value / p - 1.0).abs() < 1e-8, "{name}: p = {}", test.p_value);
        }
    }

    #[test]
    fn an_outlier_beyond_all_tails_is_no_accident() {
        let mut values: Vec<f64> = (0..10_000).map(|i| (1.3 * f64::from(i)).sin()).collect();
        values.push(1e6);
        let test = anderson_darling(&values).unwrap();
        assert!(test.statistic.is_finite() && test.p_value == 0.0, "{test:?}");
    }

    #[test]
    fn the_far_tail_joins() {
        assert!((ln_below(-30.0 + 1e-9) / ln_below(-30.0 - 1e-9) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn too_little_says_nothing() {
        assert_eq!(anderson_darling(&[1.0; 20]), None);
        assert_eq!(anderson_darling(&[1.0, 2.0, 3.0]), None);
        assert_eq!(anderson_darling(&[f64::NAN; 9]), None);
    }
}
