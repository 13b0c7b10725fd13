//! Local regression: vibrations of slowly changing amplitude and phase around a sample.

use std::f64::consts::TAU;

use fmm_fit::{LinearRegression, Weighting};
use fmm_record::Complex64;

/// A vibration that is looked for around a sample, Re[(a₀ + a₁ u + …) e^(iωτ)] with u the time in half widths.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carrier {
    /// Cycles per sample; zero for an offset, of which only the real part counts.
    pub(crate) frequency: f64,
    /// The highest power of u.
    pub(crate) order: i32,
}

/// The regression on several carriers under a window of raised cosine, the same around every sample.
///
/// The window leaves the samples at its ends without weight, so that a vibration that is not looked for disturbs only
/// where it is nearer than about two cycles per window.
pub(crate) struct LocalRegression {
    half: usize,
    /// For each unknown the numbers that, with the samples, sum up to it.
    filters: Vec<Vec<f64>>,
    /// For each unknown its share of each sample.
    shapes: Vec<Vec<f64>>,
    /// Of the unknowns, for white noise of variance 1.
    covariance: Vec<Vec<f64>>,
    weights: Vec<f64>,
    /// Share of a third power of the envelope that its first power takes, Σ w u⁴/Σ w u².
    pub(crate) third_in_first: f64,
}

/// Rounds until the third power of an envelope is that of its own first two.
const ROUNDS: usize = 4;

/// The first carrier around a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalVibration {
    /// a₀, in the unit of the samples.
    pub(crate) amplitude: Complex64,
    /// a₁ (per half width), of an envelope whose logarithm is a parabola.
    pub(crate) slope: Complex64,
    /// Standard deviation of the residuals.
    pub(crate) noise: f64,
}

impl LocalRegression {
    /// The regression over `half` samples on either side; `None` if they do not separate the `carriers`.
    pub(crate) fn new(half: usize, carriers: &[Carrier]) -> Option<Self> {
        let count = 2 * half + 1;
        let times: Vec<f64> = (0..count).map(|i| i as f64 - half as f64).collect();
        let share = |time: f64| time / half as f64;
        let weights: Vec<f64> =
            times.iter().map(|time| 0.5 * (1.0 + (0.5 * TAU * time / (half as f64 + 1.0)).cos())).collect();
        let mut shapes: Vec<Vec<f64>> = Vec::new();
        for carrier in carriers {
            for power in 0..=carrier.order {
                let grown = |time: &f64| (share(*time).powi(power), (TAU * carrier.frequency * time).sin_cos());
                shapes.push(times.iter().map(grown).map(|(u, (_, cos))| u * cos).collect());
                if carrier.frequency > 0.0 {
                    shapes.push(times.iter().map(grown).map(|(u, (sin, _))| -u * sin).collect());
                }
            }
        }
        let roots: Vec<f64> = weights.iter().map(|weight| weight.sqrt()).collect();
        let weighted: Vec<Vec<f64>> =
            shapes.iter().map(|shape| shape.iter().zip(&roots).map(|(a, b)| a * b).collect()).collect();
        let columns: Vec<(&str, &[f64])> = weighted.iter().map(|column| ("carrier", column.as_slice())).collect();
        let (zeros, ones) = (vec![0.0; count], vec![1.0; count]);
        // With known uncertainties of 1 the covariance is the inverse of the products.
        let inverse = LinearRegression::fit(&columns, &zeros, Weighting::Absolute(&ones)).ok()?;
        let order = shapes.len();
        let filter = |i: usize| -> Option<Vec<f64>> {
            let row = (0..order).map(|j| inverse.covariance(i, j)).collect::<Option<Vec<f64>>>()?;
            let at = |k: usize| weights[k] * row.iter().zip(&shapes).map(|(c, shape)| c * shape[k]).sum::<f64>();
            Some((0..count).map(at).collect())
        };
        let filters = (0..order).map(filter).collect::<Option<Vec<_>>>()?;
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let covariance = filters.iter().map(|a| filters.iter().map(|b| product(a, b)).collect()).collect();
        let moment = |power: i32| -> f64 { times.iter().zip(&weights).map(|(t, w)| w * share(*t).powi(power)).sum() };
        let third_in_first = moment(4) / moment(2);
        Some(Self { half, filters, shapes, covariance, weights, third_in_first })
    }

    /// The first carrier around sample `centre` of `values`, which has as many samples on either side; its phase counts
    /// from there.
    pub(crate) fn at(&self, values: &[f64], centre: usize) -> LocalVibration {
        let values = &values[centre - self.half..=centre + self.half];
        let unknowns: Vec<f64> = self.filters.iter().map(|filter| dot(filter, values)).collect();
        let (mut squares, mut sum) = (0.0, 0.0);
        // Every second sample is enough for the noise.
        for k in (0..values.len()).step_by(2) {
            let fitted: f64 = unknowns.iter().zip(&self.shapes).map(|(unknown, shape)| unknown * shape[k]).sum();
            squares += self.weights[k] * (values[k] - fitted).powi(2);
            sum += self.weights[k];
        }
        // Unknowns take their share of the squares.
        let effective = sum * sum / self.weights.iter().step_by(2).map(|weight| weight * weight).sum::<f64>();
        let taken = (1.0 - unknowns.len() as f64 / (2.0 * effective)).max(0.1);
        let [amplitude, first, second] = [0, 2, 4].map(|place| Complex64::new(unknowns[place], unknowns[place + 1]));
        // The envelope exp(b u + (d − b²/2) u²) has a third power, b d − b³/3 of it, that the first takes in.
        let mut slope = first;
        for _ in 0..ROUNDS {
            let (b, d) = (slope / amplitude, second / amplitude);
            slope = first - amplitude * (b * d - b * b * b / 3.0) * self.third_in_first;
        }
        LocalVibration { amplitude, slope, noise: (squares / (sum * taken)).sqrt() }
    }

    /// Re a₀ around every sample of `values` that has as many samples on either side: the first vibration without the
    /// others.
    pub(crate) fn filtered(&self, values: &[f64]) -> Vec<f64> {
        values.windows(2 * self.half + 1).map(|around| dot(&self.filters[0], around)).collect()
    }

    /// Variance of Σ gᵢ over a₀ and a₁, real and imaginary in turn, for white noise of variance 1.
    pub(crate) fn variance(&self, gradient: [f64; 4]) -> f64 {
        let row = |i: usize| (0..4).map(|j| self.covariance[i][j] * gradient[j]).sum::<f64>();
        (0..4).map(|i| gradient[i] * row(i)).sum()
    }
}

/// Σ aᵢ bᵢ, in four sums that do not wait for each other.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours, rest) = (a.chunks_exact(4), a.chunks_exact(4).remainder());
    for (a, b) in fours.zip(b.chunks_exact(4)) {
        for i in 0..4 {
            sums[i] += a[i] * b[i];
        }
    }
    let tail: f64 = rest.iter().zip(&b[b.len() - rest.len()..]).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + tail
}
