//! Fourier transform and spectrum of real samples.

use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use realfft::num_complex::Complex64;
use realfft::{RealFftPlanner, RealToComplex};

use crate::error::RecordError;

/// The discrete Fourier transform of real samples of one length.
///
/// ```text
/// X_k = Σ_j x_j e^{−2πi jk/n},   0 ≤ k ≤ n/2
/// ```
///
/// Transform of `realfft`, compiled once for all crates that transform: its plans are generic, and each crate that made its
/// own would compile every algorithm of it again, half a minute each. It is planned once for as many records as have
/// that length, and copies share the plan. Any length will do, but primes are slow.
///
/// ```
/// use fmm_record::RealTransform;
///
/// let transform = RealTransform::new(4);
/// let (mut spectrum, mut scratch) = (Vec::new(), Vec::new());
/// transform.run(&mut [1.0, 2.0, 3.0, 2.0], &mut spectrum, &mut scratch)?;
/// let expected = [(8.0, 0.0), (-2.0, 0.0), (0.0, 0.0)];
/// assert!(spectrum.iter().zip(expected).all(|(line, (re, im))| line.re == re && line.im == im));
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Clone)]
pub struct RealTransform {
    plan: Arc<dyn RealToComplex<f64>>,
}

impl RealTransform {
    /// The transform of `length` samples.
    pub fn new(length: usize) -> Self {
        Self { plan: RealFftPlanner::new().plan_fft_forward(length) }
    }

    /// Number of samples.
    pub fn length(&self) -> usize {
        self.plan.len()
    }

    /// Number of lines: those from zero frequency to half the rate.
    pub fn lines(&self) -> usize {
        self.length() / 2 + 1
    }

    /// Memory in which [`run`](Self::run) works, so that its first call takes none.
    pub fn scratch(&self) -> Vec<Complex64> {
        self.plan.make_scratch_vec()
    }

    /// Writes the lines of `samples`, which are lost, to `spectrum`, in the unit of the samples; `scratch` is memory,
    /// and both are used again.
    ///
    /// # Errors
    /// [`RecordError::Options`] for another number of samples.
    pub fn run(
        &self,
        samples: &mut [f64],
        spectrum: &mut Vec<Complex64>,
        scratch: &mut Vec<Complex64>,
    ) -> Result<(), RecordError> {
        let given = samples.len();
        spectrum.resize(self.lines(), Complex64::default());
        scratch.resize(self.plan.get_scratch_len(), Complex64::default());
        // Spectrum and scratch have the right lengths.
        self.plan
            .process_with_scratch(samples, spectrum, scratch)
            .map_err(|_| RecordError::options(format!("a transform of {} samples was given {given}", self.length())))
    }
}

impl fmt::Debug for RealTransform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RealTransform").field("length", &self.length()).finish_non_exhaustive()
    }
}

/// Half of the width of a line in a spectrum of [`blackman_harris`], in units of 1/duration. Beyond it, a line shows
/// less than 3e-5 of its amplitude.
pub(crate) const LOBE: f64 = 4.0;

/// The window of Blackman and Harris with four terms.
///
/// ```text
/// w = a₀ − a₁ cos φ + a₂ cos 2φ − a₃ cos 3φ,        φ = 2π (i + ½)/n
/// ```
///
/// F. J. Harris, On the use of windows for harmonic analysis with the discrete Fourier transform, Proceedings of the
/// IEEE 66 (1978), table 1. Its side lobes lie 92 dB below a line, so that a motion does not hide a hum.
pub(crate) fn blackman_harris(length: usize) -> Vec<f64> {
    const A: [f64; 4] = [0.358_75, 0.488_29, 0.141_28, 0.011_68];
    let at = |i: usize| {
        // cos 2φ = 2 c² − 1 and cos 3φ = 4 c³ − 3 c cost a third of three cosines.
        let c = (TAU * (i as f64 + 0.5) / length as f64).cos();
        A[0] - A[2] + c * (3.0 * A[3] - A[1] + c * (2.0 * A[2] - c * (4.0 * A[3])))
    };
    (0..length).map(at).collect()
}

/// Squared amplitudes of the frequencies from 0 to half the rate in windowed values.
///
/// ```
/// use fmm_record::Spectrum;
/// use std::f64::consts::TAU;
///
/// let values: Vec<f64> = (0..1000).map(|i| 3.0 * (TAU * 0.0503 * f64::from(i)).cos()).collect();
/// let spectrum = Spectrum::of(&values);
/// let squares = &spectrum.squares;
/// let k = (0..squares.len()).max_by(|a, b| squares[*a].total_cmp(&squares[*b])).unwrap();
/// assert!((spectrum.refined(k) - 50.3).abs() < 0.01 && (squares[k].sqrt() - 3.0).abs() < 0.1);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Squared amplitude per frequency, in the squared unit of the values: A² for a steady line of amplitude A.
    pub squares: Vec<f64>,
    /// Distance between neighbouring frequencies, in units of 1/duration of the values (1); at most a half.
    pub spacing: f64,
}

impl Spectrum {
    /// The spectrum of `values` less their mean, under the window of Blackman and Harris with four terms: side lobes
    /// lie
    /// 92 dB below a line.
    pub fn of(values: &[f64]) -> Self {
        Self::under(&blackman_harris(values.len()), values)
    }

    /// The spectrum of `values` less their mean, times `window`, which has their length.
    pub(crate) fn under(window: &[f64], values: &[f64]) -> Self {
        let length = (2 * values.len().max(1)).next_power_of_two().max(4);
        let sum: f64 = window.iter().sum();
        let weighted: f64 = values.iter().zip(window).map(|(y, w)| y * w).sum();
        let mean = weighted / sum;
        let mut real: Vec<f64> = values.iter().zip(window).map(|(y, w)| (y - mean) * w).collect();
        real.resize(length, 0.0);
        let mut lines = Vec::new();
        // The values have the length of the transform.
        let _ = RealTransform::new(length).run(&mut real, &mut lines, &mut Vec::new());
        let scale = 4.0 / (sum * sum);
        let squares = lines.iter().map(|line| scale * line.norm_sqr()).collect();
        Self { squares, spacing: values.len() as f64 / length as f64 }
    }

    /// The place of the peak near line `k`, in units of 1/duration: the vertex of the parabola through the logarithms of
    /// three lines. In this window the logarithm of a peak is nearly a parabola.
    pub fn refined(&self, k: usize) -> f64 {
        let log = |k: usize| self.squares.get(k).copied().unwrap_or(0.0).max(f64::MIN_POSITIVE).ln();
        let (before, at, after) = (log(k.saturating_sub(1)), log(k), log(k + 1));
        let bend = before - 2.0 * at + after;
        let shift = if bend < 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 };
        (k as f64 + shift) * self.spacing
    }
}

/// Twice the sums of `values` with the cosine and minus the sine of a `frequency` (cycles per sample): A cos φ and
/// A sin φ of a line A cos(ωi + φ) in values whose window has the sum 1.
pub(crate) fn component(values: &[f64], frequency: f64) -> (f64, f64) {
    let (turn_sin, turn_cos) = (TAU * frequency).sin_cos();
    let (mut sin, mut cos) = (0.0, 1.0);
    let (mut with_cos, mut with_sin) = (0.0, 0.0);
    for value in values {
        with_cos += value * cos;
        with_sin += value * sin;
        (sin, cos) = (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin);
    }
    (2.0 * with_cos, -2.0 * with_sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_its_amplitude_and_frequency_and_nothing_beside_it() {
        for length in [500, 3000] {
            let at = 40.3;
            let values: Vec<f64> =
                (0..length).map(|i| 1e3 + 2.0 * (TAU * at * f64::from(i) / f64::from(length) + 1.0).cos()).collect();
            let spectrum = Spectrum::of(&values);
            let k = (0..spectrum.squares.len())
                .max_by(|a, b| spectrum.squares[*a].total_cmp(&spectrum.squares[*b]))
                .unwrap();
            // Half of the spacing away from a frequency, the lobe has fallen by a percent or two.
            assert!((spectrum.squares[k].sqrt() - 2.0).abs() < 0.06, "{}", spectrum.squares[k].sqrt());
            assert!((spectrum.refined(k) - at).abs() < 5e-3, "{}", spectrum.refined(k));
            for (k, square) in spectrum.squares.iter().enumerate() {
                let far = (k as f64 * spectrum.spacing - at).abs() > LOBE + 0.1;
                assert!(!far || square.sqrt() < 2.0 * 3e-5, "{} at {k}", square.sqrt());
            }
        }
    }

    #[test]
    fn white_noise_has_the_power_of_its_window() {
        let mut random = crate::tests::synthetic::Noise::new(3);
        let values: Vec<f64> = (0..4000).map(|_| random.normal()).collect();
        let window = blackman_harris(values.len());
        let spectrum = Spectrum::under(&window, &values);
        let mean = spectrum.squares.iter().sum::<f64>() / spectrum.squares.len() as f64;
        let (sum, squares): (f64, f64) = window.iter().fold((0.0, 0.0), |sum, w| (sum.0 + w, sum.1 + w * w));
        // Of 2000 independent squares the mean is good to 1/√2000.
        assert!((mean / (4.0 * squares / (sum * sum)) - 1.0).abs() < 0.1, "{mean}");
    }
}
