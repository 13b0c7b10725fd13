//! Upsampling: samples that repeat others, or lie on straight lines between others.

use crate::examination::Examination;
use crate::record::Record;

/// Increase of the sampling rate of a record above the rate of its measurement, by held or interpolated samples.
///
/// Of held samples all differences, of interpolated ones all second differences, lie at samples of one remainder by the
/// factor. Both make noise look correlated, and delay the motion. Only whole factors up to 64 are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Upsampling {
    /// Number of samples for each measured one.
    pub factor: usize,
    /// The first sample that was measured; every `factor`-th from it on is one.
    pub first: usize,
    /// True if the samples between lie on straight lines; otherwise each repeats the one before.
    pub is_interpolated: bool,
}

/// The largest factor that is looked for.
const MOST: usize = 64;
/// Measured samples that show it at least.
const FEWEST: usize = 40;
/// The share of all changes that rounding may leave between measured samples (1).
const ROUNDING: f64 = 1e-9;

impl Examination<'_> {
    /// Held or interpolated samples; `None` if each sample may have been measured.
    pub fn upsampling(&self) -> Option<Upsampling> {
        let values = self.record().values();
        // Two identical values say nothing about what lies between them.
        let change = |i: usize| (values[i] - values[i - 1]).abs();
        let bend = |i: usize| (values[i + 1] - 2.0 * values[i] + values[i - 1]).abs();
        let held = factor(values.len(), change).map(|found| (found, false));
        let interpolated = || factor(values.len().saturating_sub(1), bend).map(|found| (found, true));
        let ((factor, first), is_interpolated) = held.or_else(interpolated)?;
        Some(Upsampling { factor, first, is_interpolated })
    }
}

impl Upsampling {
    /// The samples of `record` that were measured.
    ///
    /// # Errors
    /// [`RecordError`](crate::RecordError) if the record has too few of them to be another one's.
    pub fn measured(&self, record: &Record) -> Result<Record, crate::error::RecordError> {
        let values = record.values().iter().skip(self.first).step_by(self.factor).copied().collect();
        let interval = self.factor as f64 * record.interval();
        Record::new(record.time(self.first), interval, values, record.quantity(), record.unit())
    }
}

/// The largest factor such that `changes` from sample 1 to `end` lie at samples of one remainder by it, and the first
/// of these.
fn factor(end: usize, changes: impl Fn(usize) -> f64) -> Option<(usize, usize)> {
    let total: f64 = (1..end).map(&changes).sum();
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let rounding = ROUNDING * total;
    // The first change that counts belongs to a measured sample.
    let begin = (1..end).find(|i| changes(*i) > rounding)?;
    let is_elsewhere = |factor: usize| {
        let mut elsewhere = 0.0;
        (begin..end).any(|i| {
            elsewhere += if (i - begin).is_multiple_of(factor) { 0.0 } else { changes(i) };
            elsewhere > rounding
        })
    };
    let factor = (2..=MOST).rev().find(|factor| !is_elsewhere(*factor))?;
    let seen = (begin..end).step_by(factor).filter(|i| changes(*i) > rounding / end as f64).count();
    (seen >= FEWEST).then_some((factor, begin % factor))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::synthetic::Noise;
    use crate::units::Quantity;

    fn record(values: Vec<f64>) -> Record {
        Record::sampled(2000.0, values, Quantity::Displacement, "m").unwrap()
    }

    fn measured(count: usize) -> Vec<f64> {
        let mut noise = Noise::new(5);
        (0..count).map(|i| (0.2 * i as f64).sin() * (-0.005 * i as f64).exp() + 1e-3 * noise.normal()).collect()
    }

    #[test]
    fn held_and_interpolated_samples_are_found_and_undone() {
        let measured = measured(300);
        for factor in [2_usize, 3, 10, 50] {
            for first in [0, 1, factor - 1] {
                let held: Vec<f64> = (0..299 * factor).map(|i| measured[(i + factor - first) / factor]).collect();
                let found = Examination::of(record(held.clone())).upsampling().unwrap();
                assert_eq!((found.factor, found.first, found.is_interpolated), (factor, first, false));
                let undone = found.measured(&record(held)).unwrap();
                assert_eq!(undone.values()[..200], measured[1..201]);

                let between = |i: usize| {
                    let (whole, part) = ((i + factor - first) / factor, (i + factor - first) % factor);
                    measured[whole] + (measured[whole + 1] - measured[whole]) * part as f64 / factor as f64
                };
                let found = Examination::of(record((0..298 * factor).map(between).collect())).upsampling().unwrap();
                assert_eq!((found.factor, found.first, found.is_interpolated), (factor, first, true));
            }
        }
    }

    #[test]
    fn measured_samples_are_none() {
        assert_eq!(Examination::of(record(measured(1000))).upsampling(), None);
        // Steps of a coarse converter repeat values, but not at regular places.
        let coarse: Vec<f64> = measured(4000).iter().map(|value| (value * 20.0).round() / 20.0).collect();
        assert_eq!(Examination::of(record(coarse)).upsampling(), None);
        assert_eq!(Examination::of(record((0..500).map(f64::from).collect())).upsampling(), None);
        assert_eq!(Examination::of(record(vec![1.0; 500])).upsampling(), None);
        // A dozen steps may lie at regular places by chance.
        let few = |i: usize| if i < 48 { (i / 4) as f64 } else { 12.0 };
        assert_eq!(Examination::of(record((0..500).map(few).collect())).upsampling(), None);
        // Rest is no repetition of what moves after it.
        let mut late = vec![0.0; 1000];
        late.extend(measured(1000));
        assert_eq!(Examination::of(record(late)).upsampling(), None);
    }

    #[cfg(feature = "mat")]
    #[test]
    fn fork_was_not_resampled() {
        assert_eq!(Examination::of(crate::tests::synthetic::fork()).upsampling(), None);
    }
}
