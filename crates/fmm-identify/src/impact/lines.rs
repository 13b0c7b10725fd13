//! The lines of a discrete transform that lie in a band.

use std::f64::consts::TAU;
use std::ops::Range;

use fmm_fit::EvaluationError;
use fmm_frf::{Complex64, RealTransform};

use crate::error::IdentifyError;

/// The lines in a band of the transform of records of one length, scaled so that white noise keeps its variance.
///
/// ```text
/// R_k = √(2/n) Σ_j r_j e^{−2πi jk/n},   0 < k < n/2:    var Re R_k = var Im R_k = var r
/// ```
#[derive(Debug, Clone)]
pub(crate) struct Lines {
    plan: RealTransform,
    rate: f64,
    range: Range<usize>,
}

/// Memory for a transform.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    samples: Vec<f64>,
    spectrum: Vec<Complex64>,
    working: Vec<Complex64>,
}

impl Lines {
    /// The lines of records that `plan` is for, sampled at `rate` (Hz), within `band` (Hz). The line of zero frequency
    /// and that of half the rate, which have no imaginary part, are left out.
    pub(crate) fn new(plan: RealTransform, rate: f64, band: (f64, f64)) -> Result<Self, IdentifyError> {
        let length = plan.length();
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
        Ok(Self { plan, rate, range: lines })
    }

    /// How many residuals the lines make: real and imaginary part of each.
    pub(crate) fn rows(&self) -> usize {
        2 * self.range.len()
    }

    /// Frequencies (Hz).
    pub(crate) fn frequencies(&self) -> impl Iterator<Item = f64> + '_ {
        self.range.clone().map(|line| line as f64 * self.rate / self.plan.length() as f64)
    }

    fn scale(&self) -> f64 {
        (2.0 / self.plan.length() as f64).sqrt()
    }

    /// Writes real and imaginary part of each line of `series`, which begins with sample `begin` of a record that is
    /// zero elsewhere.
    pub(crate) fn transform(
        &self,
        begin: usize,
        series: &[f64],
        memory: &mut Scratch,
        rows: &mut [f64],
    ) -> Result<(), EvaluationError> {
        let Scratch { samples, spectrum, working } = memory;
        samples.clear();
        samples.resize(self.plan.length(), 0.0);
        samples[begin..begin + series.len()].copy_from_slice(series);
        self.plan.run(samples, spectrum, working)?;
        let scale = self.scale();
        for (pair, line) in rows.chunks_exact_mut(2).zip(&spectrum[self.range.clone()]) {
            pair.copy_from_slice(&[line.re * scale, line.im * scale]);
        }
        Ok(())
    }

    /// Writes what the central differences of a series have at each line, of what the series has there:
    ///
    /// ```text
    /// (v_{j+1} − v_{j−1})/2h   has   i sin(2πk/n)/h V_k
    /// ```
    ///
    /// Lines are those of a series that is zero at both ends of the record.
    pub(crate) fn write_rates(&self, rows: &[f64], rates: &mut [f64]) {
        let pairs = rates.chunks_exact_mut(2).zip(rows.chunks_exact(2));
        for (line, (rate, row)) in self.range.clone().zip(pairs) {
            let factor = self.rate * (TAU * line as f64 / self.plan.length() as f64).sin();
            rate.copy_from_slice(&[-factor * row[1], factor * row[0]]);
        }
    }

    /// Lines of a series of few samples, one by one.
    pub(crate) fn transform_short(&self, begin: usize, series: &[f64]) -> Vec<f64> {
        let (length, scale) = (self.plan.length(), self.scale());
        let value = |line: usize| {
            // The product is reduced by the length first, so that large indices lose nothing.
            let angle = |index: usize| -TAU * ((line * (begin + index)) % length) as f64 / length as f64;
            let terms = series.iter().enumerate();
            terms.fold(Complex64::default(), |sum, (i, value)| sum + Complex64::from_polar(*value, angle(i))) * scale
        };
        self.range.clone().map(value).flat_map(|line| [line.re, line.im]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_transforms_agree_and_keep_the_energy() {
        // A length with an odd prime factor, and all its lines but those without an imaginary part.
        let length = 2 * 3 * 7 * 11;
        let lines = Lines::new(RealTransform::new(length), 1.0, (0.0, 1.0)).unwrap();
        assert_eq!(lines.rows(), length - 2);
        let series: Vec<f64> = (0..40).map(|i| f64::from((i * 7919) % 101) / 101.0 - 0.5).collect();
        let mut fast = vec![0.0; lines.rows()];
        lines.transform(17, &series, &mut Scratch::default(), &mut fast).unwrap();
        for (fast, slow) in fast.iter().zip(lines.transform_short(17, &series)) {
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
    fn rates_are_those_of_central_differences() {
        let length = 60;
        let lines = Lines::new(RealTransform::new(length), 50.0, (0.0, 25.0)).unwrap();
        // Zero at both ends.
        let series: Vec<f64> = (0..length).map(|i| (i * (length - 1 - i)) as f64 * (0.3 * i as f64).cos()).collect();
        let at = |i: usize| series.get(i).copied().unwrap_or(0.0);
        let differences: Vec<f64> = (0..length).map(|i| 25.0 * (at(i + 1) - at(i.wrapping_sub(1)))).collect();
        let [mut rows, mut rates, mut expected] = [0; 3].map(|_| vec![0.0; lines.rows()]);
        lines.transform(0, &series, &mut Scratch::default(), &mut rows).unwrap();
        lines.transform(0, &differences, &mut Scratch::default(), &mut expected).unwrap();
        lines.write_rates(&rows, &mut rates);
        for (rate, expected) in rates.iter().zip(&expected) {
            assert!((rate - expected).abs() < 1e-12 * 25.0 * 900.0 * 60.0, "{rate}, not {expected}");
        }
    }

    #[test]
    fn a_band_without_lines_is_refused() {
        let plan = RealTransform::new(330_000);
        let lines = |low, high| Lines::new(plan.clone(), 10_000.0, (low, high));
        assert_eq!(lines(1.0, 4.0).unwrap().rows(), 2 * 100);
        assert!((lines(1.0, 4.0).unwrap().frequencies().next().unwrap() - 1.0).abs() < 1e-12);
        for (low, high) in [(0.001, 0.02), (6000.0, 7000.0), (1.001, 1.01)] {
            let refused = lines(low, high);
            assert!(matches!(refused, Err(IdentifyError::NotSeen { .. })), "{low} Hz to {high} Hz: {refused:?}");
        }
    }
}
