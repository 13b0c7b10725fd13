//! Correlation of residuals from one to the next.

use crate::algebra::sums::dot;

/// Lags looked at before the series is halved.
const LAGS: usize = 32;

/// ρ_k, the autocorrelation of the residuals at this `lag` (samples), about zero; of white noise within ±1.96/√n in 95
/// of 100 cases. `None` for a lag that leaves no pair, or if the residuals are all zero or not finite.
///
/// ```text
/// ρ_k = Σ rᵢ rᵢ₊ₖ / Σ rᵢ²
/// ```
///
/// ```
/// assert_eq!(fmm_fit::autocorrelation(&[1.0, -1.0, 1.0, -1.0], 1), Some(-0.75));
/// ```
pub fn autocorrelation(residuals: &[f64], lag: usize) -> Option<f64> {
    let variance = mean_product(residuals, 0);
    (lag < residuals.len() && variance > 0.0 && variance.is_finite()).then(|| mean_product(residuals, lag) / variance)
}

/// Integrated autocorrelation time of the residuals, in samples: how many neighbours tell no more than one.
///
/// ```text
/// τ = 1 + 2 Σ ρ_k = −1 + 2 Σ (ρ_{2m} + ρ_{2m+1})          up to the first pair that is not positive
/// ```
///
/// The autocorrelations ρ are about zero, where residuals belong, not about their mean. If the pairs stay positive
/// for 32 lags, neighbours are averaged in twos and the sum taken on the averages, whose long-run variance is the
/// same; the cost is thus linear in the number of residuals however long they are correlated. The result is at
/// least 1: residuals that alternate are not counted as more than there are. `None` for fewer than two residuals, or
/// if they are all zero or not finite.
///
/// # References
/// C. J. Geyer, "Practical Markov chain Monte Carlo", Stat. Sci. 7 (1992) 473,
/// <https://doi.org/10.1214/ss/1177011137> (initial positive sequence).
pub fn autocorrelation_time(residuals: &[f64]) -> Option<f64> {
    let variance = mean_product(residuals, 0);
    if residuals.len() < 2 || !(variance > 0.0 && variance.is_finite()) {
        return None;
    }
    let mut averages: Vec<f64>;
    let mut series = residuals;
    let mut block = 1.0;
    loop {
        let (time, is_complete) = initial_positive_sum(series);
        if is_complete || series.len() < 4 * LAGS {
            let longest = residuals.len() as f64;
            return Some((time * block * mean_product(series, 0) / variance).clamp(1.0, longest));
        }
        averages = series.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        series = &averages;
        block *= 2.0;
    }
}

/// Number of independent residuals with the same information, n/τ with τ the [`autocorrelation_time`].
///
/// Standard uncertainties of parameters whose influence changes slowly from sample to sample grow by about √τ.
///
/// ```
/// let smooth: Vec<f64> = (0..1000).map(|i| (0.01 * f64::from(i)).sin()).collect();
/// assert!(fmm_fit::effective_count(&smooth).unwrap() < 20.0);
/// ```
pub fn effective_count(residuals: &[f64]) -> Option<f64> {
    autocorrelation_time(residuals).map(|time| residuals.len() as f64 / time)
}

/// The sum of the formula above within `LAGS`, and whether a pair ended it.
fn initial_positive_sum(series: &[f64]) -> (f64, bool) {
    let variance = mean_product(series, 0);
    let mut time = -1.0;
    for lag in (0..LAGS.min(series.len())).step_by(2) {
        let pair = (mean_product(series, lag) + mean_product(series, lag + 1)) / variance;
        if pair.is_nan() || pair <= 0.0 {
            return (time, true);
        }
        time += 2.0 * pair;
    }
    (time, false)
}

/// `Σ rᵢ rᵢ₊ₗ / n`.
fn mean_product(series: &[f64], lag: usize) -> f64 {
    let late = series.get(lag..).unwrap_or(&[]);
    dot(&series[..late.len()], late) / series.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform noise about zero from a linear congruential generator (Knuth's MMIX constants), upper bits.
    fn noise(count: usize) -> Vec<f64> {
        let mut state = 1u64;
        (0..count)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
            })
            .collect()
    }

    #[test]
    fn white_noise_counts_in_full() {
        let white = noise(100_000);
        // Standard error of a few autocorrelations: 2·√(4/n) = 0.013.
        let time = autocorrelation_time(&white).unwrap();
        assert!((time - 1.0).abs() < 0.04, "autocorrelation time {time} samples");
        assert!(autocorrelation(&white, 1).unwrap().abs() < 0.01);
    }

    #[test]
    fn autoregressive_noise_has_its_known_time() {
        // AR(1): ρ_k = φᵏ, τ = (1 + φ)/(1 − φ): 19 for 0.9 and 199 for 0.99, which needs averaging.
        for (phi, expected) in [(0.9, 19.0), (0.99, 199.0)] {
            let mut last = 0.0;
            let series: Vec<f64> = noise(400_000)
                .into_iter()
                .map(|e| {
                    last = phi * last + e;
                    last
                })
                .collect();
            let time = autocorrelation_time(&series).unwrap();
            // Standard error about τ √(2 · 2M/n) with a window M of a few τ: 10 % for the longer.
            assert!((time / expected - 1.0).abs() < 0.2, "φ = {phi}: {time} instead of {expected} samples");
            let neighbours = autocorrelation(&series, 1).unwrap();
            assert!((neighbours - phi).abs() < 0.01, "ρ₁ = {neighbours}");
        }
    }

    #[test]
    fn what_has_no_scatter_has_no_time() {
        assert_eq!(autocorrelation_time(&[]), None);
        assert_eq!(autocorrelation_time(&[0.0; 10]), None);
        assert_eq!(autocorrelation_time(&[1.0, f64::NAN]), None);
        assert_eq!(autocorrelation(&[0.0; 3], 1), None);
    }

    #[test]
    fn a_constant_offset_counts_as_next_to_nothing() {
        // All lags count, less the ends that the sums lose: a few values of a thousand.
        assert!(effective_count(&[1.0; 1000]).unwrap() < 5.0);
    }
}
