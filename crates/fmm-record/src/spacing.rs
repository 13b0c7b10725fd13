//! Records whose samples are unequally spaced, and the same motion at equal intervals.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use crate::error::RecordError;
use crate::examination::noise::noise;
use crate::numerics::{mean, median};
use crate::record::{Record, Span};
use crate::sampling::whole_hertz;
use crate::units::Quantity;

impl Span {
    /// A sentence about `values` that are none (NaN), which leave a gap where any spacing is taken.
    pub(crate) fn lacking(self, values: &[f64]) -> Option<String> {
        let (count, length) = (values.iter().filter(|value| value.is_nan()).count(), values.len());
        let is_some = self.is_any_spacing && count > 0 && count < length;
        is_some.then(|| format!("{count} of {length} rows have no number in the channel and were left out"))
    }

    /// The samples inside, of those at these times after `start` (s), as [`Record::crop`] takes them.
    pub(crate) fn samples_at(self, start: f64, elapsed: &[f64]) -> Result<Range<usize>, RecordError> {
        const ROUNDING: f64 = 1e-6;
        let (span, count) = (elapsed[elapsed.len() - 1], elapsed.len());
        let slack = ROUNDING * span / count as f64;
        let (from, to) = (self.from.map_or(0.0, |from| from - start), self.to.map_or(span, |to| to - start));
        let first = elapsed.partition_point(|time| *time < from - slack);
        let end = elapsed.partition_point(|time| *time <= to + slack);
        if from.is_nan() || to.is_nan() || first >= end {
            let (from, to, end) = (start + from, start + to, start + span);
            return Err(RecordError::options(format!(
                "no sample lies between {from} s and {to} s; the record spans {start} s to {end} s"
            )));
        }
        Ok(first..end)
    }
}

impl Record {
    /// A record of `values` at any ascending `times` (s): uniform as [`Record::from_times`] if they lie on a grid, else
    /// unequally spaced.
    ///
    /// ```
    /// use fmm_record::{Quantity, Record};
    ///
    /// let record = Record::at_times(&[0.0, 0.1, 0.25, 0.3], vec![0.0, 1.0, 2.5, 3.0], Quantity::Velocity, "m/s")?;
    /// assert!(!record.is_equally_spaced() && record.time(2) == 0.25);
    /// let (shortest, longest) = record.steps();
    /// assert!((shortest - 0.05).abs() < 1e-12 && (longest - 0.15).abs() < 1e-12);
    /// assert!((record.equally_spaced().values()[1] - 1.0).abs() < 1e-12);
    /// # Ok::<(), fmm_record::RecordError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Record::from_times`]: times that do not go on, or of which more than a few are the same, are refused.
    pub fn at_times(
        times: &[f64],
        values: Vec<f64>,
        quantity: Quantity,
        unit: impl Into<String>,
    ) -> Result<Self, RecordError> {
        let span = Span { is_any_spacing: true, ..Span::default() };
        Ok(span.timed(times, values)?.with_quantity(quantity).with_unit(unit))
    }

    /// The same without a look for a grid; the `times` ascend, and are as many as the `values`.
    pub(crate) fn unequal(times: &[f64], values: Vec<f64>) -> Result<Self, RecordError> {
        let (start, count) = (times[0], times.len());
        let elapsed: Arc<[f64]> = times.iter().map(|time| time - start).collect();
        let interval = elapsed[count - 1] / (count.max(2) - 1) as f64;
        let mut record = Span::default().record(start, interval, values)?;
        record.elapsed = Some(elapsed);
        Ok(record)
    }

    /// True unless the times of the samples were taken as they are, at unequal intervals.
    pub fn is_equally_spaced(&self) -> bool {
        self.elapsed.is_none()
    }

    /// Times since the first sample (s) of samples that are unequally spaced.
    pub fn elapsed(&self) -> Option<&Arc<[f64]>> {
        self.elapsed.as_ref()
    }

    /// The shortest and the longest time between samples (s).
    pub fn steps(&self) -> (f64, f64) {
        let Some(elapsed) = &self.elapsed else { return (self.interval, self.interval) };
        let steps = elapsed.windows(2).map(|pair| pair[1] - pair[0]);
        steps.fold((f64::INFINITY, 0.0), |(least, most), step| (step.min(least), step.max(most)))
    }

    /// Standard deviation of the white noise, in the unit of the record: [`noise`], or by divided differences between
    /// samples that are unequally spaced.
    ///
    /// ```text
    /// d_i = Σ_k w_k x_{i+k}/√(Σ_k w_k²),        w_k = Π_{j≠k} 1/(t_{i+k} − t_{i+j}),        j, k = 0 … 4
    /// ```
    ///
    /// suppresses a motion that is well sampled and has the deviation of the noise, which the median of |d| shows.
    pub fn noise(&self) -> f64 {
        /// Samples of a divided difference.
        const SAMPLES: usize = 5;
        /// The median of |z| for a standard normal z.
        const MEDIAN: f64 = 0.674_489_750_196_081_7;
        let Some(elapsed) = &self.elapsed else { return noise(self.values()) };
        let difference = |(times, values): (&[f64], &[f64])| {
            let weight = |k: usize| -> f64 { (0..SAMPLES).filter(|j| *j != k).map(|j| times[k] - times[j]).product() };
            let weights: Vec<f64> = (0..SAMPLES).map(|k| weight(k).recip()).collect();
            let sum: f64 = weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
            sum.abs() / weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt()
        };
        let windows = elapsed.windows(SAMPLES).zip(self.values().windows(SAMPLES));
        // Those with one time twice have none.
        let mut found: Vec<f64> = windows.map(difference).filter(|size| size.is_finite()).collect();
        if found.is_empty() { 0.0 } else { median(&mut found) / MEDIAN }
    }

    /// These samples alone, of a record that is unequally spaced.
    pub(crate) fn of_samples(&self, kept: impl Iterator<Item = usize> + Clone) -> Result<Self, RecordError> {
        let times: Vec<f64> = kept.clone().map(|index| self.time(index)).collect();
        let values: Vec<f64> = kept.map(|index| self.values()[index]).collect();
        if let [start] = times[..] {
            return Ok(self.derived(start, values));
        }
        let record = Self::unequal(&times, values)?;
        Ok(record.with_quantity(self.quantity()).with_unit(self.unit()))
    }

    /// Every `stride`-th sample, from the first on.
    ///
    /// # Errors
    /// [`RecordError::Options`] if the stride is 0.
    pub fn every(&self, stride: usize) -> Result<Self, RecordError> {
        if stride == 0 {
            return Err(RecordError::options("every 0th sample was asked for; give a stride from 1 on"));
        }
        if !self.is_equally_spaced() {
            return self.of_samples((0..self.len()).step_by(stride));
        }
        let values = self.values().iter().copied().step_by(stride).collect();
        Self::new(self.start, stride as f64 * self.interval, values, self.quantity(), self.unit())
    }

    /// Means of `count` samples in a row each, in the middle of their times. A rest that makes no whole row is left out.
    ///
    /// ```
    /// use fmm_record::{Quantity, Record};
    ///
    /// let record = Record::sampled(1000.0, vec![0.1, 0.3, 0.5, 0.5, 0.7], Quantity::Velocity, "m/s")?;
    /// let means = record.means(2)?;
    /// assert!((means.values()[0] - 0.2).abs() < 1e-12 && means.len() == 2);
    /// assert_eq!((means.start(), means.interval()), (0.5e-3, 2e-3));
    /// # Ok::<(), fmm_record::RecordError>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordError::Options`] for a count of 0 or of more samples than there are, and for samples at unequal
    /// intervals.
    pub fn means(&self, count: usize) -> Result<Self, RecordError> {
        if count == 0 || count > self.len() {
            let samples = self.len();
            return Err(RecordError::options(format!("means of {count} of {samples} samples; give 1 to {samples}")));
        }
        if !self.is_equally_spaced() {
            return Err(RecordError::options(
                "means were asked for of samples at unequal intervals; take the record at equal intervals first",
            ));
        }
        let values = self.values().chunks_exact(count).map(mean).collect();
        let start = self.start + 0.5 * (count - 1) as f64 * self.interval;
        Self::new(start, count as f64 * self.interval, values, self.quantity(), self.unit())
    }

    /// The same motion at equal intervals: this record, or one with a sample at every usual (median) step between the
    /// first and the last, on cubics between the measured ones.
    ///
    /// The cubics have the slopes of parabolas through neighbours on both sides, which for the ends of a gap are as far
    /// away as half of it. A gap is bridged, however long: what is seen there is not the motion.
    pub fn equally_spaced(&self) -> Cow<'_, Self> {
        if self.is_equally_spaced() { Cow::Borrowed(self) } else { Cow::Owned(self.resampled()) }
    }

    /// [`Record::equally_spaced`] of a record that is not.
    pub(crate) fn resampled(&self) -> Self {
        /// Samples for each measured one at most, whatever the usual step is (1). Origin: chosen.
        const MOST: f64 = 8.0;
        let Some(elapsed) = &self.elapsed else { return self.clone() };
        let mut steps: Vec<f64> = elapsed.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let (span, middle) = (elapsed[elapsed.len() - 1], steps.len() / 2);
        let usual = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        let count = (span / usual).round().min(MOST * elapsed.len() as f64);
        let interval = whole_hertz(span / count);
        let slopes = slopes(elapsed, self.values(), interval);
        let mut right = 1;
        let at = |index: usize| {
            let time = (index as f64 * interval).min(span);
            while right + 1 < elapsed.len() && elapsed[right] < time {
                right += 1;
            }
            let ends = [right - 1, right].map(|end| (elapsed[end], self.values()[end], slopes[end]));
            on_cubic(ends, time)
        };
        let values = (0..=count as usize).map(at).collect();
        let mut even = self.derived(self.start, values);
        even.interval = interval;
        even
    }
}

/// The slope of `values` at each of these times (s): of the parabola through it and a neighbour on either side, at
/// least half a `step` and half of the longer step beside it away; of a line at the ends.
fn slopes(times: &[f64], values: &[f64], step: f64) -> Vec<f64> {
    let last = times.len() - 1;
    let at = |index: usize| {
        let beside = [index.saturating_sub(1), index, last.min(index + 1)].map(|near| times[near]);
        let reach = 0.5 * step.max(beside[1] - beside[0]).max(beside[2] - beside[1]) * (1.0 - 1e-9);
        let (time, value) = (times[index], values[index]);
        let before = (0..index).rev().find(|other| time - times[*other] >= reach);
        let after = (index + 1..=last).find(|other| times[*other] - time >= reach);
        let secant = |other: usize| (values[other] - value) / (times[other] - time);
        match (before, after) {
            (Some(before), Some(after)) => {
                let (left, right) = (time - times[before], times[after] - time);
                (right * secant(before) + left * secant(after)) / (left + right)
            }
            (Some(one), None) | (None, Some(one)) => secant(one),
            (None, None) => 0.0,
        }
    };
    (0..=last).map(at).collect()
}

/// The cubic at `time` (s) between two points of time (s), value and slope; their mean if they have one time.
fn on_cubic([(begin, first, rise), (end, last, fall)]: [(f64, f64, f64); 2], time: f64) -> f64 {
    let step = end - begin;
    if !(step > 0.0) {
        return 0.5 * (first + last);
    }
    let part = ((time - begin) / step).clamp(0.0, 1.0);
    let rest = 1.0 - part;
    let of_values = first * rest * rest * (1.0 + 2.0 * part) + last * part * part * (1.0 + 2.0 * rest);
    of_values + step * part * rest * (rise * rest - fall * part)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::error::says;

    fn motion(time: f64) -> f64 {
        (TAU * time).sin()
    }

    /// The motion at 100 Hz, where `late` puts each stamp off its place (steps) and `is_there` leaves some out.
    fn record(late: impl Fn(u32) -> f64, is_there: impl Fn(&u32) -> bool) -> Record {
        let times: Vec<f64> = (0..400).filter(is_there).map(|i| 5.0 + 0.01 * (f64::from(i) + late(i))).collect();
        let values = times.iter().map(|time| motion(*time)).collect();
        Record::at_times(&times, values, Quantity::Velocity, "m/s").unwrap()
    }

    fn jitter(index: u32) -> f64 {
        0.3 * (f64::from(index) * 77.7).sin()
    }

    /// Largest distance of the record at equal intervals from the motion.
    fn deviation(record: &Record) -> f64 {
        let even = record.equally_spaced();
        let deviations = even.times().zip(even.values()).map(|(time, value)| (value - motion(time)).abs());
        deviations.fold(0.0, f64::max)
    }

    #[test]
    fn means_lie_in_the_middle_of_their_times() {
        let line = Record::new(3.0, 0.5, (0..8).map(f64::from).collect(), Quantity::Velocity, "m/s").unwrap();
        let means = line.means(3).unwrap();
        assert_eq!((means.values(), means.start(), means.interval()), ([1.0, 4.0].as_slice(), 3.5, 1.5));
        assert_eq!(line.means(1).unwrap(), line);
        assert!(says(&line.means(0), "means of 0 of 8 samples; give 1 to 8"));
        assert!(says(&line.means(9), "means of 9 of 8 samples; give 1 to 8"));
        assert!(says(&record(jitter, |_| true).means(2), "unequal intervals"));
    }

    #[test]
    fn a_motion_at_any_times_is_the_same_at_equal_ones() {
        let gap = |i: &u32| !(100..110).contains(i);
        let half = |i: &u32| *i < 200 || i.is_multiple_of(2);
        for (what, record, allowed) in [
            ("jitter", record(jitter, |_| true), 2e-4),
            ("a lost sample", record(|_| 0.0, |i| *i != 57), 2e-4),
            ("two rates", record(|_| 0.0, half), 2e-4),
            ("a gap of a tenth of a period", record(jitter, gap), 0.02),
        ] {
            let even = record.equally_spaced();
            assert!(!record.is_equally_spaced() && even.is_equally_spaced(), "{what}");
            assert!(deviation(&record) < allowed, "{what}: {}", deviation(&record));
            assert!((even.end() - record.end()).abs() < 0.01 && even.start() == record.start(), "{what}");
        }
        assert!(record(|_| 0.0, |_| true).is_equally_spaced());
    }

    /// Two samples that are nearly at one time do not steepen what is between others.
    #[test]
    fn close_samples_do_not_multiply_noise() {
        let close = |i: u32| if i.is_multiple_of(5) { 0.99 } else { 0.0 };
        let quiet = record(close, |_| true);
        let values = quiet.values().iter().enumerate().map(|(i, value)| value + 0.01 * (i as f64 * 91.3).sin());
        let noisy = quiet.with_values(values.collect()).unwrap();
        assert!(deviation(&noisy) < 0.02, "{}", deviation(&noisy));
    }

    #[test]
    fn noise_is_that_between_neighbours() {
        for (what, clean) in
            [("jitter", record(jitter, |_| true)), ("two rates", record(|_| 0.0, |i| *i < 100 || i.is_multiple_of(2)))]
        {
            // Normal, of the deviation 0.01, by the rule of Box and Muller.
            let draw = |i: usize| (4e4 * (13.0 * (i + 1) as f64).sin()).rem_euclid(1.0);
            let noise = |i: usize| 0.01 * (-2.0 * draw(2 * i).ln()).sqrt() * (TAU * draw(2 * i + 1)).cos();
            let values = clean.values().iter().enumerate().map(|(i, value)| value + noise(i)).collect();
            let found = clean.with_values(values).unwrap().noise();
            assert!((found / 0.01 - 1.0).abs() < 0.15, "{what}: {found}");
            // Two hundredths of a period between samples leave (2π/50)⁴/√70 of the motion.
            assert!(clean.noise() < 3e-5, "{what}: {}", clean.noise());
        }
    }

    #[test]
    fn parts_keep_their_times() {
        let record = record(jitter, |_| true);
        let part = record.crop(6.0, 7.0).unwrap();
        assert!(part.times().zip(part.values()).all(|(time, value)| (motion(time) - value).abs() < 1e-12));
        assert!(part.start() >= 6.0 && part.end() <= 7.0 && part.len() > 95, "{}", part.len());
        let few = record.every(7).unwrap().scaled(2.0, "m/s").unwrap();
        assert!(few.times().zip(few.values()).all(|(time, value)| (2.0 * motion(time) - value).abs() < 1e-12));
        assert!(says(&record.crop(9.0, 10.0), "no sample lies between 9 s and 10 s"));
        assert!(record.differentiate().unwrap().is_equally_spaced());
    }

    #[test]
    fn times_that_are_no_clock_are_refused() {
        let refused = |times: &[f64]| Record::at_times(times, vec![0.0; times.len()], Quantity::Velocity, "m/s");
        assert!(says(&refused(&[0.0, 1.0, 0.5, 3.0]), "time must increase"));
        let coarse: Vec<f64> = (0..100).map(|i| f64::from(i / 10)).collect();
        assert!(says(&refused(&coarse), "give the rate"), "{:?}", refused(&coarse));
    }
}
