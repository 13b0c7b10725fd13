//! Convergence of chains: rank-normalised R̂ and effective sample sizes.
//!
//! # References
//! A. Vehtari, A. Gelman, D. Simpson, B. Carpenter, P.-C. Bürkner, "Rank-normalization, folding, and localization: an
//! improved R̂ for assessing convergence of MCMC", Bayesian Analysis 16 (2021) 667,
//! <https://doi.org/10.1214/20-BA1221>.

use statrs::distribution::{ContinuousCDF, Normal};

/// Chains of equal length, each one cut in two halves, so that a drift within a chain shows as a difference between
/// halves.
#[derive(Debug, Clone)]
struct Halves {
    values: Vec<f64>,
    length: usize,
}

impl Halves {
    /// `values` of `chains` chains, one after the other. Of an odd length the value in the middle is left out.
    fn of(values: &[f64], chains: usize) -> Self {
        let whole = values.len() / chains.max(1);
        let length = whole / 2;
        let halves = values.chunks_exact(whole.max(1)).flat_map(|chain| [&chain[..length], &chain[whole - length..]]);
        Self { values: halves.flatten().copied().collect(), length }
    }

    fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Self { values: self.values.iter().map(|value| f(*value)).collect(), length: self.length }
    }

    /// Normal scores of the ranks, (rank − 3/8)/(S + 1/4); equal values share the mean of theirs.
    fn normal_scores(&self) -> Self {
        let mut order: Vec<usize> = (0..self.values.len()).collect();
        order.sort_by(|a, b| self.values[*a].total_cmp(&self.values[*b]));
        let mut scores = vec![0.0; order.len()];
        let mut first = 0;
        while first < order.len() {
            let ties = order[first..].iter().take_while(|i| self.values[**i] == self.values[order[first]]).count();
            let ties = ties.max(1);
            let rank = first as f64 + 0.5 * (ties as f64 + 1.0);
            let score = Normal::standard().inverse_cdf((rank - 0.375) / (order.len() as f64 + 0.25));
            order[first..first + ties].iter().for_each(|&i| scores[i] = score);
            first += ties;
        }
        Self { values: scores, length: self.length }
    }

    fn chains(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.values.chunks_exact(self.length.max(1))
    }

    /// R̂ = √((N − 1)/N + B/(N W)), with B/N the variance of the means and W the mean of the variances.
    fn r_hat(&self) -> f64 {
        let (between, within) = self.variances();
        let n = self.length as f64;
        ((n - 1.0) / n + between / within).sqrt()
    }

    /// Variance of the means, and mean of the variances.
    fn variances(&self) -> (f64, f64) {
        let moments: Vec<(f64, f64)> = self.chains().map(mean_and_variance).collect();
        let means: Vec<f64> = moments.iter().map(|(mean, _)| *mean).collect();
        let within = moments.iter().map(|(_, variance)| variance).sum::<f64>() / moments.len() as f64;
        (mean_and_variance(&means).1, within)
    }

    /// S/τ, with τ by Geyer's initial monotone sequence over the autocorrelation of all chains together.
    fn effective_size(&self) -> f64 {
        let count = self.values.len() as f64;
        if self.length < 4 {
            return f64::NAN;
        }
        let first = self.values[0];
        if self.values.iter().all(|value| *value == first) {
            return count;
        }
        let centred: Vec<Vec<f64>> = self
            .chains()
            .map(|chain| {
                let (mean, _) = mean_and_variance(chain);
                chain.iter().map(|value| value - mean).collect()
            })
            .collect();
        let n = self.length as f64;
        let (between, within) = self.variances();
        let total = within * (n - 1.0) / n + between;
        let rho = |lag: usize| {
            let products = centred.iter().map(|chain| {
                let (early, late) = (&chain[..chain.len() - lag], &chain[lag..]);
                early.iter().zip(late).map(|(a, b)| a * b).sum::<f64>() / n
            });
            1.0 - (within - products.sum::<f64>() / centred.len() as f64) / total
        };
        // Pairs of neighbouring lags, as long as their sums are positive, and then as far as these fall.
        let mut pairs = vec![(1.0, rho(1))];
        let mut last = None;
        let mut lag = 1;
        while lag + 3 < self.length {
            let pair = (rho(lag + 1), rho(lag + 2));
            if pair.0 + pair.1 <= 0.0 {
                last = Some(pair.0).filter(|even| *even > 0.0);
                break;
            }
            pairs.push(pair);
            lag += 2;
        }
        let mut sum = 0.0;
        let mut least = f64::INFINITY;
        for (even, odd) in pairs {
            least = least.min(even + odd);
            sum += least;
        }
        let time = -1.0 + 2.0 * sum + last.unwrap_or(0.0);
        count / time.max(1.0 / count.log10())
    }
}

fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (mean, values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0))
}

/// Agreement of chains about one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Convergence {
    pub(super) r_hat: f64,
    pub(super) bulk: f64,
    pub(super) tail: f64,
    /// Standard error of the mean.
    pub(super) error_of_mean: f64,
    /// Standard error of the standard deviation.
    pub(super) error_of_deviation: f64,
}

impl Convergence {
    /// Convergence of `values` of `chains` chains of equal length, one after the other; `sorted` are the same in ascending order.
    pub(super) fn of(values: &[f64], chains: usize, sorted: &[f64]) -> Self {
        let halves = Halves::of(values, chains);
        let scores = halves.normal_scores();
        let median = quantile(sorted, 0.5);
        let folded = halves.map(|value| (value - median).abs()).normal_scores();
        let below = |level: f64| {
            let limit = quantile(sorted, level);
            halves.map(|value| f64::from(value <= limit)).effective_size()
        };
        let (mean, variance) = mean_and_variance(values);
        let squares = halves.map(|value| (value - mean).powi(2));
        let count = squares.values.len() as f64;
        let second = squares.values.iter().sum::<f64>() / count;
        let fourth = squares.values.iter().map(|square| square * square).sum::<f64>() / count;
        let of_square = (fourth - second * second).max(0.0) / squares.effective_size();
        Self {
            r_hat: scores.r_hat().max(folded.r_hat()),
            bulk: scores.effective_size(),
            tail: below(0.05).min(below(0.95)),
            error_of_mean: (variance / halves.effective_size()).sqrt(),
            error_of_deviation: (of_square / (4.0 * second)).sqrt(),
        }
    }
}

/// The quantile of `sorted` values at `level`, linear between them.
pub(super) fn quantile(sorted: &[f64], level: f64) -> f64 {
    let place = level * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four chains of 250 autocorrelated values, the last one shifted, by a congruential generator whose numbers are
    /// exact.
    fn chains(step: Option<f64>) -> Vec<f64> {
        let mut state = 12_345_u64;
        let mut values = Vec::new();
        for chain in 0..4 {
            let mut value = 0.0;
            for _ in 0..250 {
                state = (1_664_525 * state + 1_013_904_223) % (1 << 32);
                value = 0.6 * value + (state as f64 / 4_294_967_296.0 - 0.5);
                let shifted = value + if chain == 3 { 0.15 } else { 0.0 };
                values.push(step.map_or(shifted, |step| (step * shifted).floor() / step));
            }
        }
        values
    }

    /// ArviZ 0.23.4: rhat(method="rank"), ess(method="bulk" and "tail"), mcse(method="mean" and "sd"), of the same
    /// numbers.
    #[test]
    fn the_figures_are_those_of_arviz() {
        let cases = [
            (
                None,
                [
                    1.018_884_116_130_076,
                    177.526_709_579_217_3,
                    351.790_352_165_256_5,
                    0.026_001_951_515_303_434,
                    0.010_100_876_885_241_743,
                ],
            ),
            (
                Some(20.0),
                [
                    1.018_712_954_463_871_1,
                    175.996_349_832_301_4,
                    318.334_708_875_942_8,
                    0.026_197_611_700_868_827,
                    0.010_186_609_107_178_182,
                ],
            ),
        ];
        for (step, expected) in cases {
            let values = chains(step);
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let found = Convergence::of(&values, 4, &sorted);
            let found = [found.r_hat, found.bulk, found.tail, found.error_of_mean, found.error_of_deviation];
            for (found, expected) in found.into_iter().zip(expected) {
                // ArviZ finds autocovariances by a Fourier transform, and normal quantiles to 15 digits.
                assert!((found / expected - 1.0).abs() < 1e-10, "{found} for {expected}");
            }
        }
    }

    #[test]
    fn a_constant_is_known_at_once() {
        let halves = Halves::of(&[2.0; 400], 4);
        assert_eq!(halves.effective_size(), 400.0);
    }
}
