//! Growth of the noise with the signal.

use fmm_fit::{LinearRegression, Weighting, autocorrelation_time};

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

/// How much a growth must raise the logarithm of the likelihood: chance does so by 6 for one record in a thousand.
const EVIDENCE: f64 = 6.0;
/// Steps of the search for the variances.
const STEPS: usize = 4;

impl NoiseGrowth {
    /// The growth that `residuals` beside `signal`, with a `period` in samples, show; `None` if they show none.
    pub(crate) fn of(residuals: &[f64], signal: &[f64], period: f64) -> Option<Self> {
        let squares: Vec<f64> = residuals.iter().map(|r| r * r).collect();
        let constant = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
        if !(constant > 0.0 && constant.is_finite()) {
            return None;
        }
        let instantaneous: Vec<f64> = signal.iter().map(|y| y * y).collect();
        let by_amplitude = squared_amplitudes(signal, period);
        // Neighbours that share their noise are no witnesses of their own.
        let evidence = EVIDENCE * autocorrelation_time(residuals).unwrap_or(1.0);
        let none = likelihood(&squares, |_| constant);
        let candidates = [[true, false], [false, true], [true, true]];
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

/// Logarithm of the likelihood of normal residuals with these squares and variances, but for a constant.
fn likelihood(squares: &[f64], variance: impl Fn(usize) -> f64) -> f64 {
    let terms = squares.iter().enumerate().map(|(i, square)| {
        let variance = variance(i);
        variance.ln() + square / variance
    });
    -0.5 * terms.sum::<f64>()
}

/// The variances of the constant part and of the `active` ones of two growing parts, by Fisher's scoring from a `constant`
/// variance; `None` if a part comes out at zero.
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
    for _ in 0..STEPS {
        let line = LinearRegression::fit(&columns, squares, Weighting::Absolute(&deviations)).ok()?;
        let mut coefficients = line.coefficients().iter();
        // A floor of a ten-thousandth of the scatter keeps variances positive.
        found[0] = coefficients.next()?.max(1e-4 * constant);
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
