//! Resampling of values at times that are not uniform, or at another rate, to a uniform rate.

use std::f64::consts::PI;

use crate::{Quantity, Record, RecordError};

/// Brings samples to a uniform rate, for a motion of which nothing lies above a band.
///
/// Every new value is the sum of the nearest samples times weights that reproduce all frequencies of the band best, and
/// suppress those that the new rate would fold into it:
///
/// ```text
/// y(t) = Σ w_j x_j,        H(f) = Σ w_j e^(2πi f (t_j − t))
/// ∫₀ᴮ |1 − H|² df + 10⁻⁶ ∫ᴮₛ |D − H|² df + ∫ₛᵇ |H|² df + 10⁻¹⁰ B Σ w_j² = min
/// D = ½ (1 + cos π(f − B)/(s − B)),        s = rate − B or b, whichever is less,  b = half the rate of the samples
/// ```
///
/// The second term lets what lies beside the band pass in the same way everywhere, as it would be modulated into it
/// otherwise.
///
/// This is the linear estimate of least mean square for a flat spectrum (J. L. Yen, On nonuniform sampling of
/// bandwidth-limited signals, IRE Transactions on Circuit Theory 3 (1956) 251); the last term keeps noise from growing.
/// A rate below a quarter of that of the samples is reached in steps.
///
/// ```
/// use fmm_record::{Quantity, Resampling};
///
/// // 2 Hz, sampled at 100 Hz by a clock that jitters by a fifth of the interval.
/// let times: Vec<f64> = (0..500).map(|i| (f64::from(i) + 0.2 * (f64::from(i) * 1.7).sin()) / 100.0).collect();
/// let wave = |t: f64| (4.0 * std::f64::consts::PI * t).sin();
/// let values: Vec<f64> = times.iter().map(|t| wave(*t)).collect();
///
/// let resampled = Resampling::new(100.0, 20.0)?.of(&times, &values)?;
/// assert!(resampled.error < 1e-3);
/// let record = resampled.record(Quantity::Velocity, "m/s")?;
/// assert_eq!(record.rate(), 100.0);
/// assert!(record.times().zip(record.values()).all(|(t, value)| (value - wave(t)).abs() < 1e-3));
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resampling {
    rate: f64,
    band: f64,
}

/// Uniform samples, and how well they are known.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Resampled {
    /// Time of the first sample (s).
    pub start: f64,
    /// Sampling rate (Hz).
    pub rate: f64,
    /// The samples, in the unit of the values given.
    pub values: Vec<f64>,
    /// Root mean square error, relative to that of a motion with as much of every frequency of the band (1). What lies
    /// above the band adds to it.
    pub error: f64,
    /// The same error of the least known sample (1): larger at the ends, where samples lie on one side only.
    pub worst: f64,
    /// Time of that sample (s).
    pub worst_at: f64,
}

/// The largest band, in units of either rate (1).
const WIDEST: f64 = 0.45;

/// The largest error of a sample that counts as known (1).
const MOST: f64 = 0.1;

/// Cost of noise, relative to an error of the same power (1).
const NOISE: f64 = 1e-10;

/// Cost of an error beside the band, relative to one within it (1).
const BESIDE: f64 = 1e-6;

/// Largest reduction of the rate in one step (1).
const STEP: f64 = 4.0;

impl Resampling {
    /// To `rate` (Hz), for a motion of which nothing lies above `band` (Hz).
    ///
    /// # Errors
    /// [`RecordError::Options`] if the rate is not positive, or the band not positive or above 0.45 of the rate.
    pub fn new(rate: f64, band: f64) -> Result<Self, RecordError> {
        if !(rate > 0.0 && rate.is_finite() && rate.recip().is_finite()) {
            return Err(RecordError::rate(rate));
        }
        if !(band > 0.0 && band <= WIDEST * rate) {
            return Err(band_too_wide(band, rate));
        }
        Ok(Self { rate, band })
    }

    /// The rate to which samples are brought (Hz).
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// The frequency above which nothing of the motion lies (Hz).
    pub fn band(&self) -> f64 {
        self.band
    }

    /// Brings `values` at `times` (s), which increase, to the rate. The first sample is at the first of the times.
    ///
    /// # Errors
    /// * [`RecordError::TimeAxis`] for times whose number is not that of the values, fewer than two times, times that
    ///   are not finite or not increasing, or that are so far apart that the error exceeds a tenth of a motion of this
    ///   band;
    /// * [`RecordError::Values`] for values that are not finite;
    /// * [`RecordError::Options`] if the band is above 0.45 of the mean rate of the samples, or for more samples than a
    ///   memory holds.
    pub fn of(&self, times: &[f64], values: &[f64]) -> Result<Resampled, RecordError> {
        let mean_rate = checked(times, values)?;
        if self.band > WIDEST * mean_rate {
            return Err(band_too_wide(self.band, mean_rate));
        }
        let next = (mean_rate / STEP).max(self.rate);
        let first = self.step(times, values, mean_rate, if next > 1.01 * self.rate { next } else { self.rate })?;
        if first.rate == self.rate {
            return Ok(first);
        }
        let between: Vec<f64> = (0..first.values.len()).map(|i| first.start + i as f64 / first.rate).collect();
        let second = self.of(&between, &first.values)?;
        let worst_at = if second.worst > first.worst { second.worst_at } else { first.worst_at };
        let (error, worst) = (first.error + second.error, first.worst + second.worst);
        Ok(Resampled { error, worst, worst_at, ..second })
    }

    /// The samples of a record at the rate.
    ///
    /// # Errors
    /// As [`Resampling::of`].
    pub fn of_record(&self, record: &Record) -> Result<Resampled, RecordError> {
        self.of(&record.times().collect::<Vec<_>>(), record.values())
    }

    /// Brings samples of a mean rate to `rate` (Hz) in one step.
    fn step(&self, times: &[f64], values: &[f64], mean_rate: f64, rate: f64) -> Result<Resampled, RecordError> {
        const MOST_SAMPLES: f64 = (1 << 27) as f64;
        let (start, end) = (times[0], times[times.len() - 1]);
        // Rounding must not drop a sample at the end.
        let count = ((end - start) * rate + 1e-6).floor() + 1.0;
        if count > MOST_SAMPLES {
            // As many as can be counted.
            let length = count as usize;
            return Err(RecordError::times_alike(start, rate.recip(), length));
        }
        // Sharper edges of the band need longer filters.
        let edge = rate.min(mean_rate) - 2.0 * self.band;
        let taps = ((12.0 * mean_rate / edge).ceil() as usize).max(16).min(times.len());
        let spectrum =
            Spectrum { band: self.band, stop: (rate - self.band).min(0.5 * mean_rate), top: 0.5 * mean_rate };
        let mut solver = Solver::new(taps);
        let mut resampled = Resampled { start, rate, values: Vec::new(), error: 0.0, worst: 0.0, worst_at: start };
        let mut squares = 0.0;
        let mut from = 0;
        for index in 0..count as usize {
            let time = start + index as f64 / rate;
            // The samples nearest to the time.
            while from + taps < times.len() && times[from + taps] - time < time - times[from] {
                from += 1;
            }
            let (times, values) = (&times[from..from + taps], &values[from..from + taps]);
            let error = solver.solve(&spectrum, time, times);
            squares += error * error;
            if error > resampled.worst {
                (resampled.worst, resampled.worst_at) = (error, time);
            }
            resampled.values.push(solver.weights.iter().zip(values).map(|(weight, value)| weight * value).sum());
        }
        resampled.error = (squares / count).sqrt();
        if resampled.worst > MOST {
            let Resampled { worst, worst_at, .. } = resampled;
            let (index, band) = (times.partition_point(|time| *time < worst_at), self.band);
            let what = format!(
                "at {worst_at} s, the time stamps are too far apart: a motion of up to {band} Hz is known there with a relative \
                 error of {worst} only; give a narrower band, or crop the record"
            );
            return Err(RecordError::time(Some(index), what));
        }
        Ok(resampled)
    }
}

impl Resampled {
    /// The samples as a record.
    ///
    /// # Errors
    /// As [`Record::new`].
    pub fn record(self, quantity: Quantity, unit: impl Into<String>) -> Result<Record, RecordError> {
        Record::sampled(self.rate, self.values, quantity, unit)?.starting_at(self.start)
    }
}

/// The mean rate (Hz) of samples that can be resampled.
fn checked(times: &[f64], values: &[f64]) -> Result<f64, RecordError> {
    if times.len() != values.len() {
        return Err(RecordError::length_mismatch(times.len(), values.len()));
    }
    let (Some(&start), Some(&end), 2..) = (times.first(), times.last(), times.len()) else {
        return Err(RecordError::too_few_times(times.len()));
    };
    if let Some((index, &time)) = times.iter().enumerate().find(|(_, time)| !time.is_finite()) {
        return Err(RecordError::time_not_finite(index, time));
    }
    if let Some(i) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(RecordError::not_increasing(i + 1, times[i + 1], times[i]));
    }
    if let Some(index) = values.iter().position(|value| !value.is_finite()) {
        let count = values.iter().filter(|value| !value.is_finite()).count();
        return Err(RecordError::not_finite(index, times[index], count, values.len()));
    }
    let rate = (times.len() - 1) as f64 / (end - start);
    if rate > 0.0 && rate.is_finite() { Ok(rate) } else { Err(RecordError::rate(rate)) }
}

/// The frequencies to be kept, up to the band, and to be suppressed, from the stop to the top (Hz).
struct Spectrum {
    band: f64,
    stop: f64,
    top: f64,
}

impl Spectrum {
    /// Covariance of two samples at a distance (s): ∫ cos 2πfτ df with the weights of the terms, over B.
    fn common(&self, distance: f64) -> f64 {
        let [band, stop, top] = [self.band, self.stop, self.top].map(|frequency| integral(frequency, distance));
        (band + BESIDE * (stop - band) + top - stop) / self.band
    }

    /// Covariance of a sample and the wanted value at a distance (s): ∫ D cos 2πfτ df with the weights of the terms,
    /// over B.
    fn wanted(&self, distance: f64) -> f64 {
        let [band, stop] = [self.band, self.stop].map(|frequency| integral(frequency, distance));
        // ∫ᴮₛ cos(π(f − B)/(s − B)) cos 2πfτ df, with the middle m of the edge and half its width h: by the sum and the
        // difference of both phases.
        let (middle, half) = (0.5 * (self.stop + self.band), 0.5 * (self.stop - self.band));
        let phase = 2.0 * PI * half * distance;
        let side = |phase: f64| if phase.abs() < 1e-6 { 1.0 } else { phase.sin() / phase };
        let falls = half * (side(phase - 0.5 * PI) - side(phase + 0.5 * PI)) * (2.0 * PI * middle * distance).sin();
        (band + 0.5 * BESIDE * (stop - band + falls)) / self.band
    }

    /// Variance of the wanted value, with the weights of the terms, over B.
    fn all(&self) -> f64 {
        1.0 + BESIDE * 0.375 * (self.stop - self.band) / self.band
    }
}

/// ∫₀ᶠ cos 2πfτ df.
fn integral(frequency: f64, distance: f64) -> f64 {
    let phase = 2.0 * PI * frequency * distance;
    if phase.abs() < 1e-4 { frequency * (1.0 - phase * phase / 6.0) } else { frequency * phase.sin() / phase }
}

/// Solves for the weights of one sample; keeps its memory.
struct Solver {
    /// The lower half of a symmetric matrix, row after row, and its factor in the same place.
    matrix: Vec<f64>,
    /// What is kept of each sample.
    right: Vec<f64>,
    weights: Vec<f64>,
}

impl Solver {
    fn new(taps: usize) -> Self {
        Self { matrix: vec![0.0; taps * taps], right: vec![0.0; taps], weights: vec![0.0; taps] }
    }

    /// Finds the weights of the value at `time` (s), and returns its relative error.
    fn solve(&mut self, spectrum: &Spectrum, time: f64, times: &[f64]) -> f64 {
        let taps = times.len();
        for (row, at) in times.iter().enumerate() {
            for (column, other) in times[..=row].iter().enumerate() {
                let distance = at - other;
                self.matrix[row * taps + column] = spectrum.common(distance);
            }
            self.matrix[row * taps + row] += NOISE;
            self.right[row] = spectrum.wanted(at - time);
        }
        self.factorise(taps);
        self.weights.copy_from_slice(&self.right);
        for row in 0..taps {
            let known: f64 = (0..row).map(|column| self.matrix[row * taps + column] * self.weights[column]).sum();
            self.weights[row] = (self.weights[row] - known) / self.matrix[row * taps + row];
        }
        for row in (0..taps).rev() {
            let known: f64 = (row + 1..taps).map(|below| self.matrix[below * taps + row] * self.weights[below]).sum();
            self.weights[row] = (self.weights[row] - known) / self.matrix[row * taps + row];
        }
        // What the weights leave of the sum that they make least.
        let reached: f64 = self.weights.iter().zip(&self.right).map(|(weight, right)| weight * right).sum();
        (spectrum.all() - reached).max(0.0).sqrt()
    }

    /// The factor of Cholesky. What remains of a diagonal is at least the noise, whatever rounding does.
    fn factorise(&mut self, taps: usize) {
        for row in 0..taps {
            for column in 0..=row {
                let known: f64 =
                    (0..column).map(|k| self.matrix[row * taps + k] * self.matrix[column * taps + k]).sum();
                let rest = self.matrix[row * taps + column] - known;
                self.matrix[row * taps + column] = if row == column {
                    rest.max(0.5 * NOISE).sqrt()
                } else {
                    rest / self.matrix[column * taps + column]
                };
            }
        }
    }
}

/// A band (Hz) that is not positive, or too wide for a rate (Hz).
fn band_too_wide(band: f64, rate: f64) -> RecordError {
    RecordError::options(format!(
        "the band of a motion must be positive and at most 0.45 of the rates, but is {band} Hz at a rate of {rate} Hz"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::says;
    use crate::synthetic::Noise;

    /// A sum of sines of random phases at all frequencies up to `band` (Hz), with a root mean square of 1.
    fn motion(band: f64, seed: u64) -> impl Fn(f64) -> f64 {
        const COUNT: usize = 200;
        let mut noise = Noise::new(seed);
        let step = 2.0 * PI * band / COUNT as f64;
        let waves: Vec<(f64, f64)> =
            (0..COUNT).map(|i| (step * (i as f64 + noise.uniform()), 2.0 * PI * noise.uniform())).collect();
        move |t| waves.iter().map(|(w, phase)| (w * t + phase).sin()).sum::<f64>() * (2.0 / COUNT as f64).sqrt()
    }

    /// Root mean square of the differences from a motion.
    fn deviation(resampled: &Resampled, motion: &impl Fn(f64) -> f64) -> f64 {
        let at = |i: usize| resampled.start + i as f64 / resampled.rate;
        let squares = resampled.values.iter().enumerate().map(|(i, value)| (value - motion(at(i))).powi(2));
        (squares.sum::<f64>() / resampled.values.len() as f64).sqrt()
    }

    #[test]
    fn the_error_is_as_stated_for_jitter_gaps_and_other_rates() {
        let mut noise = Noise::new(3);
        let jittered: Vec<f64> = (0..3000).map(|i| (f64::from(i) + 0.6 * noise.uniform()) / 1000.0).collect();
        let gaps: Vec<f64> = (0..3000).filter(|i| i % 250 > 3).map(|i| f64::from(i) / 1000.0).collect();
        let uniform: Vec<f64> = (0..3000).map(|i| f64::from(i) / 1000.0).collect();
        for (times, rate, band) in [
            (&jittered, 1000.0, 200.0),
            (&jittered, 1000.0, 20.0),
            (&gaps, 1000.0, 60.0),
            (&uniform, 1000.0, 400.0),
            (&uniform, 800.0, 100.0),
            (&uniform, 3210.0, 300.0),
            (&jittered, 500.0, 100.0),
            (&jittered, 40.0, 10.0),
        ] {
            let motion = motion(band, 7);
            let values: Vec<f64> = times.iter().map(|time| motion(*time)).collect();
            let resampled = Resampling::new(rate, band).unwrap().of(times, &values).unwrap();
            let (found, stated) = (deviation(&resampled, &motion), resampled.error);
            assert!(stated < 0.01, "{rate} Hz, {band} Hz: {stated} stated");
            // The error is a mean over all motions of the band, of which this is one.
            assert!(found < 1.5 * stated, "{rate} Hz, {band} Hz: {found} for {stated} stated");
            assert!((resampled.values.len() as f64 / (rate * 3.0) - 1.0).abs() < 0.02);
        }
    }

    #[test]
    fn what_a_lower_rate_would_fold_is_suppressed() {
        let uniform: Vec<f64> = (0..8000).map(|i| f64::from(i) / 4000.0).collect();
        // 390 Hz would be seen at 10 Hz in samples of 400 Hz.
        let values: Vec<f64> = uniform.iter().map(|t| (2.0 * PI * 390.0 * t).sin()).collect();
        let resampled = Resampling::new(400.0, 100.0).unwrap().of(&uniform, &values).unwrap();
        let edge = 40;
        let inside = &resampled.values[edge..resampled.values.len() - edge];
        let largest = inside.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        assert!(largest < 1e-3, "{largest} is left");
    }

    #[test]
    fn noise_does_not_grow() {
        let mut noise = Noise::new(5);
        let times: Vec<f64> = (0..4000).map(|i| (f64::from(i) + 0.3 * noise.uniform()) / 1000.0).collect();
        let values: Vec<f64> = times.iter().map(|_| noise.normal()).collect();
        for band in [5.0, 50.0, 300.0] {
            let resampled = Resampling::new(1000.0, band).unwrap().of(&times, &values).unwrap();
            let power = resampled.values.iter().map(|value| value * value).sum::<f64>() / 4000.0;
            assert!(power < 1.5, "{band} Hz: {power}");
        }
    }

    #[test]
    fn what_cannot_be_known_is_refused() {
        for (rate, band) in [(100.0, 0.0), (100.0, 46.0), (100.0, f64::NAN), (100.0, -1.0)] {
            assert!(
                says(&Resampling::new(rate, band), "the band of a motion must be positive"),
                "{rate} Hz, {band} Hz"
            );
        }
        for rate in [0.0, f64::NAN, f64::INFINITY] {
            assert!(says(&Resampling::new(rate, 1.0), "the sampling rate must be positive"));
        }
        let resampling = Resampling::new(100.0, 20.0).unwrap();
        let times: Vec<f64> = (0..400).map(|i| f64::from(i) / 100.0 + if i < 200 { 0.0 } else { 0.2 }).collect();
        let error = resampling.of(&times, &[0.0; 400]).unwrap_err();
        let RecordError::TimeAxis { index: Some(200), what } = error else { panic!("{error}") };
        let time: f64 = what.strip_prefix("at ").and_then(|rest| rest.split_once(" s,")).unwrap().0.parse().unwrap();
        assert!((time - 2.1).abs() < 0.1, "the gap is from 1.99 s to 2.2 s, not at {time} s");
        assert!(says(&resampling.of(&[0.0, 1.0], &[0.0; 2]), "the band of a motion must be positive"));
        assert!(says(&resampling.of(&[0.0], &[0.0]), "do not give a sampling interval"));
        assert!(says(&resampling.of(&[0.0, 0.0], &[0.0; 2]), "time must increase"));
        assert!(says(&resampling.of(&[0.0, 0.01], &[0.0, f64::NAN]), "not finite; the first is sample"));
        let fine = Resampling::new(1e12, 0.4).unwrap();
        assert!(says(&fine.of(&times, &[0.0; 400]), "cannot be told apart"));
        assert_eq!(resampling.of(&[0.0, 0.01], &[0.0; 2]).unwrap().values.len(), 2);
    }
}
