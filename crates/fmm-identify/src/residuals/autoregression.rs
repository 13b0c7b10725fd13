//! Autoregression of a series on its past values.

use fmm_frf::Complex64;

use crate::residuals::rules::{HIGHEST_ORDER, PENALTY_OF_COEFFICIENT, RESIDUALS_PER_COEFFICIENT};

/// An autoregressive process that a series looks like.
///
/// ```text
/// z_i = Σ_j a_j z_{i−j} + e_i,     j = 1 … p:        S(f) = σ_e²/|1 − Σ a_j e^{−2πi f j}|²
/// ```
///
/// The coefficients are those of Yule and Walker by Levinson's recursion. The order makes n ln σ_e² + 4 p smallest,
/// with twice the penalty of Akaike's criterion, so that white noise seldom has a coefficient.
///
/// # References
/// H. Akaike, "Power spectrum estimation through autoregressive model fitting", Ann. Inst. Stat. Math. 21 (1969) 407,
/// <https://doi.org/10.1007/BF02532269>.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Autoregression {
    coefficients: Vec<f64>,
    /// σ_e², in the unit of the series squared.
    innovation: f64,
}

impl Autoregression {
    /// Autocovariances that an autoregression of a series of `count` values needs.
    pub(crate) fn lags(count: usize) -> usize {
        HIGHEST_ORDER.min(count / RESIDUALS_PER_COEFFICIENT) + 1
    }

    /// The autoregression of a series of `count` values with these autocovariances, from lag 0, the variance, on.
    pub(crate) fn of(autocovariances: &[f64], count: usize) -> Self {
        let variance = autocovariances.first().copied().unwrap_or(0.0);
        let mut best = Self { coefficients: Vec::new(), innovation: variance };
        if !(variance > 0.0 && variance.is_finite()) {
            return best;
        }
        let criterion =
            |innovation: f64, order: usize| count as f64 * innovation.ln() + PENALTY_OF_COEFFICIENT * order as f64;
        let mut least = criterion(variance, 0);
        let (mut coefficients, mut innovation): (Vec<f64>, f64) = (Vec::new(), variance);
        for order in 1..autocovariances.len() {
            let past = coefficients.iter().enumerate();
            let predicted: f64 = past.map(|(j, coefficient)| coefficient * autocovariances[order - 1 - j]).sum();
            let reflection = (autocovariances[order] - predicted) / innovation;
            let reversed: Vec<f64> = coefficients.iter().rev().copied().collect();
            for (coefficient, mirrored) in coefficients.iter_mut().zip(reversed) {
                *coefficient -= reflection * mirrored;
            }
            coefficients.push(reflection);
            innovation *= 1.0 - reflection * reflection;
            if !(innovation > 0.0) {
                break;
            }
            let score = criterion(innovation, order);
            if score < least {
                least = score;
                best = Self { coefficients: coefficients.clone(), innovation };
            }
        }
        best
    }

    /// p.
    pub(crate) fn order(&self) -> usize {
        self.coefficients.len()
    }

    /// S at `frequency`, in cycles a sample; for white noise the variance at every frequency.
    pub(crate) fn density(&self, frequency: f64) -> f64 {
        let turn = Complex64::cis(-std::f64::consts::TAU * frequency);
        let sum = self.coefficients.iter().rev().fold(Complex64::ZERO, |sum, coefficient| (sum + coefficient) * turn);
        self.innovation / (Complex64::ONE - sum).norm_sqr()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ρ_k = 0.9ᵏ is that of one coefficient, whatever the variance.
    #[test]
    fn a_first_order_process_is_found_from_its_autocovariances() {
        let autocovariances: Vec<f64> = (0..10).map(|lag| 4.0 * 0.9f64.powi(lag)).collect();
        let found = Autoregression::of(&autocovariances, 2000);
        assert_eq!(found.order(), 1);
        assert!((found.density(0.0) - 4.0 * 19.0).abs() < 1e-9, "{}", found.density(0.0));
        assert!((found.density(0.5) - 4.0 / 19.0).abs() < 1e-9, "{}", found.density(0.5));
    }

    #[test]
    fn white_noise_has_no_coefficients() {
        let found = Autoregression::of(&[2.0, 0.02, -0.05, 0.03], 1000);
        assert_eq!((found.order(), found.density(0.1)), (0, 2.0));
        assert_eq!(Autoregression::of(&[], 0).density(0.1), 0.0);
    }
}
