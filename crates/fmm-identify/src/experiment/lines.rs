//! Lines of a discrete transform that lie in a band.

use std::ops::Range;

use fmm_fit::EvaluationError;
use fmm_record::{Complex64, RealTransform};

use crate::error::IdentifyError;
use crate::threads::Pool;

/// The lines in a band of the transform of records of one length, scaled so that white noise keeps its variance.
///
/// ```text
/// R_k = √(2/n) Σ_j r_j e^{−2πi jk/n},   0 < k < n/2:    var Re R_k = var Im R_k = var r
/// ```
#[derive(Debug)]
pub(crate) struct Lines {
    plan: RealTransform,
    rate: f64,
    range: Range<usize>,
    idle: Pool<Scratch>,
}

/// Memory for a transform.
#[derive(Debug, Default)]
struct Scratch {
    samples: Vec<f64>,
    spectrum: Vec<Complex64>,
    working: Vec<Complex64>,
}

impl PartialEq for Lines {
    fn eq(&self, other: &Self) -> bool {
        (self.plan.length(), self.rate, &self.range) == (other.plan.length(), other.rate, &other.range)
    }
}

impl Lines {
    /// The lines of records of `length` samples at `rate` (Hz) within `band` (Hz). The line of zero frequency and that
    /// of half the rate, which have no imaginary part, are left out.
    pub(crate) fn new(length: usize, rate: f64, band: (f64, f64)) -> Result<Self, IdentifyError> {
        let position = |frequency: f64| frequency * length as f64 / rate;
        // Rounding must not drop a line that is asked for by name.
        let first = (position(band.0) * (1.0 - 1e-9)).ceil().max(1.0) as usize;
        let end = (position(band.1) * (1.0 + 1e-9)).floor() as usize + 1;
        let lines = first..end.min(length.div_ceil(2));
        if lines.is_empty() {
            let ((low, high), spacing) = (band, rate / length as f64);
            return Err(IdentifyError::not_seen(format!(
                "no line of the spectrum lies between {low} Hz and {high} Hz; lines are {spacing} Hz apart"
            )));
        }
        Ok(Self { plan: RealTransform::new(length), rate, range: lines, idle: Pool::default() })
    }

    /// Number of residuals: real and imaginary part of each line.
    pub(crate) fn rows(&self) -> usize {
        2 * self.range.len()
    }

    fn scale(&self) -> f64 {
        (2.0 / self.plan.length() as f64).sqrt()
    }

    /// Writes real and imaginary part of each line of `series`, which is zero after its end.
    pub(crate) fn transform(&self, series: &[f64], rows: &mut [f64]) -> Result<(), EvaluationError> {
        self.idle.lend(|Scratch { samples, spectrum, working }| {
            samples.clear();
            samples.extend_from_slice(series);
            samples.resize(self.plan.length(), 0.0);
            self.plan.run(samples, spectrum, working)?;
            let scale = self.scale();
            for (pair, line) in rows.chunks_exact_mut(2).zip(&spectrum[self.range.clone()]) {
                pair.copy_from_slice(&[line.re * scale, line.im * scale]);
            }
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Lines of a series of few samples, one by one.
    fn one_by_one(lines: &Lines, series: &[f64]) -> Vec<f64> {
        let (length, scale) = (lines.plan.length(), lines.scale());
        let value = |line: usize| {
            // The product is reduced by the length first, so that large indices lose nothing.
            let angle = |index: usize| -TAU * ((line * index) % length) as f64 / length as f64;
            let terms = series.iter().enumerate();
            terms.fold(Complex64::default(), |sum, (i, value)| sum + Complex64::from_polar(*value, angle(i))) * scale
        };
        lines.range.clone().map(value).flat_map(|line| [line.re, line.im]).collect()
    }

    #[test]
    fn both_transforms_agree_and_keep_the_energy() {
        // A length with an odd prime factor, and all its lines but those without an imaginary part.
        let length = 2 * 3 * 7 * 11;
        let lines = Lines::new(length, 1.0, (0.0, 1.0)).unwrap();
        assert_eq!(lines.rows(), length - 2);
        let series: Vec<f64> = (0..40).map(|i| f64::from((i * 7919) % 101) / 101.0 - 0.5).collect();
        let mut fast = vec![0.0; lines.rows()];
        lines.transform(&series, &mut fast).unwrap();
        for (fast, slow) in fast.iter().zip(one_by_one(&lines, &series)) {
            assert!((fast - slow).abs() < 1e-15 * 40.0, "{fast} and {slow}");
        }
        // Parseval, with what the two lines left out hold.
        let energy: f64 = series.iter().map(|v| v * v).sum();
        let sum: f64 = series.iter().sum();
        let alternating: f64 = series.iter().enumerate().map(|(i, v)| if i % 2 == 0 { *v } else { -*v }).sum();
        let found: f64 = fast.iter().map(|r| r * r).sum();
        let expected = energy - (sum * sum + alternating * alternating) / length as f64;
        assert!((found - expected).abs() < 1e-13 * energy, "{found}, not {expected}");
    }

    #[test]
    fn a_band_without_lines_is_refused() {
        let lines = |low, high| Lines::new(330_000, 10_000.0, (low, high));
        assert_eq!(lines(1.0, 4.0).unwrap().rows(), 2 * 100);
        assert_eq!(lines(1.0, 4.0).unwrap().range.start, 33);
        for (low, high) in [(0.001, 0.02), (6000.0, 7000.0), (1.001, 1.01)] {
            let refused = lines(low, high);
            assert!(matches!(refused, Err(IdentifyError::NotSeen { .. })), "{low} Hz to {high} Hz: {refused:?}");
        }
    }
}
