//! Growth of the noise with the signal.

use fmm_fit::{LinearRegression, Weighting, autocorrelation_time};

use crate::residuals::rules::{EVIDENCE_OF_GROWTH, LEAST_FLOOR, SCORING_STEPS};

/// A noise whose variance grows with the signal.
///
/// ```text
/// σ² = σ₀² + (g_i y)² + (g_e A)²,     y the signal, A its amplitude there (√2 times its rms over a period)
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoiseGrowth {
    /// σ₀, in the unit of the signal.
    pub(crate) floor: f64,
    /// g_i, the part that follows the signal at every instant (1).
    pub(crate) instantaneous: f64,
    /// g_e, the part that follows its amplitude (1).
    pub(crate) by_amplitude: f64,
}

impl NoiseGrowth {
    /// The growth that `residuals` beside `signal`, with a `period` in samples, show; `None` if they show none.
    pub(crate) fn of(residuals: &[f64], signal: &[f64], period: f64) -> Option<Self> {
        Self::of_those_that_explain(1.0, residuals, signal, period)
    }

    /// The same, of the kinds of growth that can explain this `share` of the evidence.
    fn of_those_that_explain(share: f64, residuals: &[f64], signal: &[f64], period: f64) -> Option<Self> {
        let squares: Vec<f64> = residuals.iter().map(|r| r * r).collect();
        let constant = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
        if !(constant > 0.0 && constant.is_finite()) {
            return None;
        }
        let instantaneous: Vec<f64> = signal.iter().map(|y| y * y).collect();
        let by_amplitude = squared_amplitudes(signal, period);
        // Neighbours that share their noise count once.
        let evidence = EVIDENCE_OF_GROWTH * autocorrelation_time(residuals).unwrap_or(1.0);
        let none = likelihood(&squares, |_| constant);
        let explained = explained(&squares, &instantaneous, &by_amplitude, constant);
        // Most records show no growth. The logarithm rises by a quarter of what a small growth explains, and one that
        // is not small explains far more.
        let candidates = [[true, false], [false, true], [true, true]].into_iter().zip(explained);
        let candidates = candidates.filter(|(_, explained)| *explained > share * evidence).map(|(active, _)| active);
        let mut best: Option<(f64, Self)> = None;
        for active in candidates {
            let Some(found) = variances(&squares, &instantaneous, &by_amplitude, active, constant) else { continue };
            let variance = |i: usize| found[0] + found[1] * instantaneous[i] + found[2] * by_amplitude[i];
            let gain = likelihood(&squares, variance) - none;
            // The second kind of growth has to earn its place beside the first.
            let better = best.is_none_or(|(least, _)| gain > least + evidence);
            if gain > evidence && better {
                let growth =
                    Self { floor: found[0].sqrt(), instantaneous: found[1].sqrt(), by_amplitude: found[2].sqrt() };
                best = Some((gain, growth));
            }
        }
        best.map(|(_, growth)| growth)
    }

    /// σ at every sample of `signal`.
    pub(crate) fn deviations(&self, signal: &[f64], period: f64) -> Vec<f64> {
        let amplitudes = squared_amplitudes(signal, period);
        let parts = signal.iter().zip(amplitudes);
        parts
            .map(|(y, amplitude)| {
                let grown = (self.instantaneous * y).powi(2) + self.by_amplitude.powi(2) * amplitude;
                (self.floor * self.floor + grown).sqrt()
            })
            .collect()
    }
}

/// A² at every sample, from the samples within half a period to either side.
fn squared_amplitudes(signal: &[f64], period: f64) -> Vec<f64> {
    let reach = (0.5 * period).round().max(1.0) as usize;
    let mut sums = vec![0.0];
    for y in signal {
        sums.push(sums[sums.len() - 1] + y * y);
    }
    let count = signal.len();
    (0..count)
        .map(|i| {
            let (low, high) = (i.saturating_sub(reach), (i + reach + 1).min(count));
            2.0 * (sums[high] - sums[low]) / (high - low) as f64
        })
        .collect()
}

/// Sums of squares of the relative variances r²/σ² explained by a straight line in the first growing part, by one in
/// the second, and by a plane in both. Half of such a sum is the statistic of Breusch and Pagan; a line that falls
/// explains nothing.
///
/// # References
/// T. S. Breusch, A. R. Pagan, "A simple test for heteroscedasticity and random coefficient variation", Econometrica 47
/// (1979) 1287.
fn explained(squares: &[f64], instantaneous: &[f64], by_amplitude: &[f64], constant: f64) -> [f64; 3] {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (mean_a, mean_b) = (mean(instantaneous), mean(by_amplitude));
    let [mut aa, mut bb, mut ab, mut ay, mut by] = [0.0; 5];
    for ((square, a), b) in squares.iter().zip(instantaneous).zip(by_amplitude) {
        let (a, b, y) = (a - mean_a, b - mean_b, square / constant);
        aa += a * a;
        bb += b * b;
        ab += a * b;
        ay += a * y;
        by += b * y;
    }
    let line = |product: f64, square: f64| if product > 0.0 { product * product / square } else { 0.0 };
    let plane = (ay * ay * bb - 2.0 * ay * by * ab + by * by * aa) / (aa * bb - ab * ab);
    // Parts that go together leave the plane to rounding.
    let plane = if plane.is_finite() && plane >= 0.0 { plane } else { f64::INFINITY };
    [line(ay, aa), line(by, bb), plane]
}

/// Logarithm of the likelihood of normal residuals with these squares and variances, but for a constant.
fn likelihood(squares: &[f64], variance: impl Fn(usize) -> f64) -> f64 {
    let terms = squares.iter().enumerate().map(|(i, square)| {
        let variance = variance(i);
        variance.ln() + square / variance
    });
    -0.5 * terms.sum::<f64>()
}

/// The variances of the constant part and of the `active` ones of two growing parts, by Fisher's scoring from a
/// `constant` variance; `None` if a part comes out at zero.
fn variances(
    squares: &[f64],
    instantaneous: &[f64],
    by_amplitude: &[f64],
    active: [bool; 2],
    constant: f64,
) -> Option<[f64; 3]> {
    let ones = vec![1.0; squares.len()];
    let growing = [("instantaneous", instantaneous), ("by amplitude", by_amplitude)];
    let mut columns: Vec<(&str, &[f64])> = vec![("floor", &ones)];
    columns.extend(growing.iter().zip(active).filter(|(_, is_active)| *is_active).map(|(column, _)| *column));
    let mut deviations = vec![constant; squares.len()];
    let mut found = [constant, 0.0, 0.0];
    for _ in 0..SCORING_STEPS {
        let line = LinearRegression::fit(&columns, squares, Weighting::Absolute(&deviations)).ok()?;
        let mut coefficients = line.coefficients().iter();
        found[0] = coefficients.next()?.max(LEAST_FLOOR * constant);
        for (value, is_active) in found[1..].iter_mut().zip(active) {
            *value = if is_active { *coefficients.next()? } else { 0.0 };
        }
        if found[1..].iter().zip(active).any(|(value, is_active)| is_active && !(*value > 0.0)) {
            return None;
        }
        for (i, deviation) in deviations.iter_mut().enumerate() {
            *deviation = found[0] + found[1] * instantaneous[i] + found[2] * by_amplitude[i];
        }
    }
    found.iter().all(|value| value.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn a_look_at_what_could_be_explained_changes_nothing() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut grown = 0;
        for case in 0..600 {
            let count = [40, 200, 1000][case % 3];
            let period = 0.1 * count as f64;
            let wave =
                |i: usize| (std::f64::consts::TAU * i as f64 / period).cos() * (-2.0 * i as f64 / count as f64).exp();
            let signal: Vec<f64> = (0..count).map(wave).collect();
            // From none to ten times the floor, around where it can be seen at all.
            let growth = 10f64.powf(-1.5 + (case % 50) as f64 * 0.05);
            let [own, envelope] = [[growth, 0.0], [0.0, growth], [growth, growth], [0.0, 0.0]][case % 4];
            let amplitudes = squared_amplitudes(&signal, period);
            let mut noise = |i: usize| {
                let draw: f64 = StandardNormal.sample(&mut random);
                draw * (1.0 + (own * signal[i]).powi(2) + envelope * envelope * amplitudes[i]).sqrt()
            };
            let residuals: Vec<f64> = (0..count).map(&mut noise).collect();
            let found = NoiseGrowth::of(&residuals, &signal, period);
            let exhaustive = NoiseGrowth::of_those_that_explain(-1.0, &residuals, &signal, period);
            assert_eq!(found, exhaustive, "case {case}");
            grown += usize::from(found.is_some());
        }
        assert!((100..500).contains(&grown), "{grown} of 600 grow");
    }
}
