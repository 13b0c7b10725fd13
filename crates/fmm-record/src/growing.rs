//! Record that grows as its samples come, such as from an instrument.

use fmm_model::ModelError;

use crate::error::RecordError;
use crate::record::Record;
use crate::units::Quantity;

/// Samples that come one by one, at a rate or each with its time, and the record that they make so far.
///
/// A sample that is taken is valid: values are finite, and times ascend. What is refused changes nothing, so that a
/// stream may go on behind it.
///
/// ```
/// use fmm_record::{GrowingRecord, Quantity};
///
/// let mut growing = GrowingRecord::sampled(1000.0, Quantity::Velocity, "m/s")?;
/// for value in [0.0, 0.1, 0.3] {
///     growing.push(value)?;
/// }
/// assert!(growing.push(f64::NAN).is_err());
/// assert_eq!(growing.record()?.values(), [0.0, 0.1, 0.3]);
///
/// let mut stamped = GrowingRecord::stamped(Quantity::Displacement, "mm");
/// stamped.push_at(0.0, 1.0)?;
/// stamped.push_at(0.12, 2.0)?;
/// assert!(stamped.push_at(0.11, 3.0).is_err());
/// assert_eq!(stamped.finish()?.times().collect::<Vec<_>>(), [0.0, 0.12]);
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GrowingRecord {
    /// Sampling rate (Hz); `None` where each sample has its time.
    rate: Option<f64>,
    /// Times (s) of samples that have some.
    times: Vec<f64>,
    values: Vec<f64>,
    quantity: Quantity,
    unit: String,
}

impl GrowingRecord {
    /// A record without samples yet, which come at `rate` (Hz) from time 0 on.
    ///
    /// # Errors
    /// [`RecordError::Options`] if the rate is not positive and finite.
    pub fn sampled(rate: f64, quantity: Quantity, unit: impl Into<String>) -> Result<Self, RecordError> {
        let rate = ModelError::require_positive("sampling rate", rate, "Hz");
        let rate = rate.map_err(|error| RecordError::options(error.to_string()))?;
        Ok(Self { rate: Some(rate), ..Self::stamped(quantity, unit) })
    }

    /// A record without samples yet, each of which comes with its time.
    pub fn stamped(quantity: Quantity, unit: impl Into<String>) -> Self {
        Self { rate: None, times: Vec::new(), values: Vec::new(), quantity, unit: unit.into() }
    }

    /// Takes the next sample of a record with a rate.
    ///
    /// # Errors
    /// [`RecordError::Values`] for a value that is not finite, [`RecordError::Options`] where samples come with their
    /// times.
    pub fn push(&mut self, value: f64) -> Result<(), RecordError> {
        if self.rate.is_none() {
            return Err(RecordError::options("samples of this record come with their times: give each its time"));
        }
        self.take(value)
    }

    /// Takes the sample at `time` (s).
    ///
    /// # Errors
    /// [`RecordError::TimeAxis`] for a time that is not finite or not after the one before, [`RecordError::Values`] for
    /// a value that is not finite, [`RecordError::Options`] for a record with a rate.
    pub fn push_at(&mut self, time: f64, value: f64) -> Result<(), RecordError> {
        if self.rate.is_some() {
            return Err(RecordError::options("samples of this record come at a rate: give their values alone"));
        }
        let index = self.times.len();
        if !time.is_finite() {
            return Err(RecordError::time(Some(index), format!("the time {time} is no number")));
        }
        if let Some(previous) = self.times.last().filter(|previous| **previous >= time) {
            return Err(RecordError::not_increasing(index, time, *previous));
        }
        self.take(value)?;
        self.times.push(time);
        Ok(())
    }

    fn take(&mut self, value: f64) -> Result<(), RecordError> {
        if !value.is_finite() {
            let index = self.values.len();
            return Err(RecordError::Values { what: format!("sample {index} is {value}"), index });
        }
        self.values.push(value);
        Ok(())
    }

    /// Number of samples so far.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// True before the first sample.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The record of the samples so far, which goes on growing.
    ///
    /// # Errors
    /// [`RecordError::Values`] without a sample, [`RecordError::TimeAxis`] for fewer than two times.
    pub fn record(&self) -> Result<Record, RecordError> {
        self.clone().finish()
    }

    /// The record of all samples.
    ///
    /// # Errors
    /// As for [`record`](Self::record).
    pub fn finish(self) -> Result<Record, RecordError> {
        match self.rate {
            Some(rate) => Record::sampled(rate, self.values, self.quantity, self.unit),
            None => Record::at_times(&self.times, self.values, self.quantity, self.unit),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The record is that of all samples at once, whenever it is asked for.
    #[test]
    fn samples_one_by_one_make_the_same_record() {
        let values: Vec<f64> = (0..50).map(|i| f64::from(i).sin()).collect();
        let mut growing = GrowingRecord::sampled(20.0, Quantity::Velocity, "m/s").unwrap();
        let times: Vec<f64> = (0..50).map(|i| f64::from(i) + 0.3 * f64::from(i).cos()).collect();
        let mut stamped = GrowingRecord::stamped(Quantity::Velocity, "m/s");
        for (count, (time, value)) in times.iter().zip(&values).enumerate() {
            growing.push(*value).unwrap();
            stamped.push_at(*time, *value).unwrap();
            let so_far = values[..=count].to_vec();
            let expected = Record::sampled(20.0, so_far, Quantity::Velocity, "m/s").unwrap();
            assert_eq!((growing.record().unwrap(), growing.len()), (expected, count + 1));
        }
        assert_eq!(stamped.finish().unwrap(), Record::at_times(&times, values, Quantity::Velocity, "m/s").unwrap());
    }

    #[test]
    fn what_is_refused_changes_nothing() {
        let mut growing = GrowingRecord::sampled(20.0, Quantity::Velocity, "m/s").unwrap();
        assert!(growing.is_empty() && growing.record().is_err());
        assert!(growing.push_at(0.0, 1.0).is_err() && growing.push(f64::INFINITY).is_err() && growing.is_empty());
        let mut stamped = GrowingRecord::stamped(Quantity::Velocity, "m/s");
        assert!(stamped.push(1.0).is_err() && stamped.push_at(f64::NAN, 1.0).is_err());
        stamped.push_at(1.0, 1.0).unwrap();
        for (time, value) in [(1.0, 2.0), (0.5, 2.0), (2.0, f64::NAN)] {
            assert!(stamped.push_at(time, value).is_err());
        }
        stamped.push_at(2.0, 3.0).unwrap();
        assert_eq!(stamped.finish().unwrap().values(), [1.0, 3.0]);
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(GrowingRecord::sampled(rate, Quantity::Velocity, "m/s").is_err());
        }
    }
}
