//! A sampled series with its quantity and unit.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use fmm_model::Rounded;

use crate::error::RecordError;
use crate::numerics::mean;
use crate::sampling::{is_clock, uniform_grid};
use crate::units::Quantity;

/// The times (s) between which samples are taken, to the end of the record where none is given, and whether they may
/// be unequally spaced.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Span {
    pub(crate) from: Option<f64>,
    pub(crate) to: Option<f64>,
    pub(crate) is_any_spacing: bool,
}

impl Span {
    /// The samples inside, of `length` ≥ 1 from `start` (s) on every `interval` (s), as [`Record::crop`] takes them.
    fn samples(self, start: f64, interval: f64, length: usize) -> Result<Range<usize>, RecordError> {
        const ROUNDING: f64 = 1e-6;
        let end = start + interval * (length - 1) as f64;
        let (from, to) = (self.from.unwrap_or(start), self.to.unwrap_or(end));
        let nothing = || {
            let [from, to] = [from, to].map(Rounded::every_digit);
            RecordError::options(format!(
                "no sample lies between {from} s and {to} s; the record spans {start} s to {end} s"
            ))
        };
        if from.is_nan() || to.is_nan() {
            return Err(nothing());
        }
        let first = ((from - start) / interval - ROUNDING).ceil().max(0.0);
        let last = ((to - start) / interval + ROUNDING).floor().min((length - 1) as f64);
        if first > last { Err(nothing()) } else { Ok(first as usize..last as usize + 1) }
    }

    /// The part inside of what [`Record::new`] makes, of no quantity and unit; values outside may be anything.
    pub(crate) fn record(self, start: f64, interval: f64, mut values: Vec<f64>) -> Result<Record, RecordError> {
        if !(interval > 0.0 && interval.is_finite()) {
            return Err(RecordError::interval(interval));
        }
        if values.is_empty() {
            let what = "a record needs at least one sample, but none were given".into();
            return Err(RecordError::Values { index: 0, what });
        }
        let length = values.len();
        let reach = start.abs() + interval * length as f64;
        if !(reach.is_finite() && reach * f64::EPSILON < interval) {
            return Err(RecordError::options(format!(
                "with a start of {start} s and an interval of {interval} s, {length} time stamps cannot be told apart"
            )));
        }
        let kept = self.samples(start, interval, length)?;
        values.truncate(kept.end);
        values.drain(..kept.start);
        let record = Record {
            start: start + interval * kept.start as f64,
            interval,
            elapsed: None,
            values,
            quantity: Quantity::Other,
            unit: String::new(),
        };
        let Some(first) = record.values.iter().position(|value| !value.is_finite()) else { return Ok(record) };
        let count = record.values.iter().filter(|value| !value.is_finite()).count();
        let (index, length) = (kept.start + first, kept.len());
        let (time, are) = (start + interval * index as f64, if count == 1 { "is" } else { "are" });
        let what = format!(
            "{count} of {length} samples {are} not finite; the first is sample {index} (at {time} s); cut the record \
             there, or fill the gap"
        );
        Err(RecordError::Values { index, what })
    }

    /// The part inside of what [`Record::sampled`] makes.
    pub(crate) fn sampled(self, rate: f64, values: Vec<f64>) -> Result<Record, RecordError> {
        if !(rate > 0.0 && rate.is_finite() && rate.recip().is_finite()) {
            let what = format!("the sampling rate must be positive and finite, but is {rate} Hz");
            return Err(RecordError::options(what));
        }
        if self.lacking(&values).is_some() {
            let times: Vec<f64> = (0..values.len()).map(|index| index as f64 / rate).collect();
            return self.timed(&times, values);
        }
        self.record(0.0, rate.recip(), values)
    }

    /// The part inside of what [`Record::from_times`] makes.
    pub(crate) fn timed(self, times: &[f64], values: Vec<f64>) -> Result<Record, RecordError> {
        if times.len() != values.len() {
            let (times, values) = (times.len(), values.len());
            return Err(RecordError::time(None, format!("{times} time stamps were given for {values} values")));
        }
        if self.lacking(&values).is_some() {
            let (times, values): (Vec<f64>, Vec<f64>) =
                times.iter().zip(values).filter(|(_, value)| !value.is_nan()).unzip();
            return self.timed(&times, values);
        }
        let is_inside = |time: &f64| self.from.is_none_or(|from| *time >= from) && self.to.is_none_or(|to| *time <= to);
        let inside = || {
            let first = times.iter().position(is_inside).unwrap_or(0);
            first..first + times[first..].iter().take_while(|time| is_inside(time)).count()
        };
        let (start, interval) = match uniform_grid(times) {
            Ok(grid) => grid,
            Err(error) if self.from.is_none() && self.to.is_none() => return self.or_unequal(times, values, error),
            // Stamps outside may be anything.
            Err(_) => {
                let (times, values) = (&times[inside()], values[inside()].to_vec());
                return match uniform_grid(times) {
                    Ok((start, interval)) => self.record(start, interval, values),
                    Err(error) => self.or_unequal(times, values, error),
                };
            }
        };
        self.record(start, interval, values)
    }

    /// The record of unequally spaced `times`, where such are taken, else the `error` that they make.
    fn or_unequal(self, times: &[f64], values: Vec<f64>, error: RecordError) -> Result<Record, RecordError> {
        if self.is_any_spacing && is_clock(times) { Record::unequal(times, values) } else { Err(error) }
    }
}

impl From<Record> for Cow<'_, Record> {
    fn from(record: Record) -> Self {
        Self::Owned(record)
    }
}

impl<'a> From<&'a Record> for Cow<'a, Record> {
    fn from(record: &'a Record) -> Self {
        Self::Borrowed(record)
    }
}

/// A measured channel: samples at equal intervals, what they are, and their unit.
///
/// A record that exists is valid: it has at least one sample, every sample is finite, and the interval is positive.
///
/// One made by [`Record::at_times`] may be unequally spaced. Its interval is then the mean one, and what needs equal
/// intervals, such as an [`Examination`](crate::Examination) or a derivative, is that of [`Record::equally_spaced`].
///
/// ```
/// use fmm_record::{Quantity, Record};
///
/// let record = Record::new(0.0, 0.001, vec![0.0, 0.1, 0.2], Quantity::Velocity, "m/s")?;
/// assert_eq!((record.len(), record.rate()), (3, 1000.0));
/// assert_eq!(record.crop(0.001, 0.002)?.values(), [0.1, 0.2]);
/// assert_eq!(record.scaled(1000.0, "mm/s")?.values()[1], 100.0);
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    pub(crate) start: f64,
    pub(crate) interval: f64,
    /// Times since the first sample (s), if they are unequally spaced.
    pub(crate) elapsed: Option<Arc<[f64]>>,
    values: Vec<f64>,
    quantity: Quantity,
    unit: String,
}

impl Record {
    /// A record whose first sample is at `start` (s) and whose samples follow each other every `interval` (s).
    ///
    /// # Errors
    /// [`RecordError::Values`] if there are none or some are not finite, [`RecordError::Options`] if the interval is
    /// not positive and finite, or if `start` is not finite or so large that neighbouring samples would have
    /// equal times.
    pub fn new(
        start: f64,
        interval: f64,
        values: Vec<f64>,
        quantity: Quantity,
        unit: impl Into<String>,
    ) -> Result<Self, RecordError> {
        Ok(Span::default().record(start, interval, values)?.with_quantity(quantity).with_unit(unit))
    }

    /// A record sampled at `rate` (Hz) from time 0 on.
    ///
    /// # Errors
    /// [`RecordError::Options`] if the rate is not positive and finite, otherwise as [`Record::new`].
    pub fn sampled(
        rate: f64,
        values: Vec<f64>,
        quantity: Quantity,
        unit: impl Into<String>,
    ) -> Result<Self, RecordError> {
        Ok(Span::default().sampled(rate, values)?.with_quantity(quantity).with_unit(unit))
    }

    /// A record of `values` at `times` (s), which must lie on a uniform grid:
    ///
    /// ```text
    /// h = (t_last − t_first)/(n − 1),        |t_i − (t_first + i h)| ≤ 0.01 h + d
    /// ```
    ///
    /// The first term is jitter. The second is rounding: *d* is one unit of the last decimal that
    /// the stamps carry (half a unit for the stamp itself, half for the ends that define the grid), 1 ms for stamps
    /// with three decimals. It counts only if rounding shows: if more than 1 % of the steps, and more than two, differ
    /// from the usual one. A few odd steps among equal ones are gaps. No step may exceed 1.5 h + d.
    ///
    /// The rate is taken as a whole number of hertz if it is one within 10⁻⁵, because time columns often carry few
    /// digits.
    ///
    /// ```
    /// use fmm_record::{Quantity, Record};
    ///
    /// // 300 Hz, written with three decimals.
    /// let times: Vec<f64> = (0..3001).map(|i| (f64::from(i) / 300.0 * 1e3).round() / 1e3).collect();
    /// let record = Record::from_times(&times, vec![0.0; 3001], Quantity::Velocity, "m/s")?;
    /// assert_eq!(record.interval(), 1.0 / 300.0);
    /// # Ok::<(), fmm_record::RecordError>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordError::TimeAxis`] if there are not as many times as values or fewer than two, or if one is not finite,
    /// repeated, decreasing or off the grid; [`RecordError::Options`] if they span more than a number can hold;
    /// otherwise as [`Record::new`].
    pub fn from_times(
        times: &[f64],
        values: Vec<f64>,
        quantity: Quantity,
        unit: impl Into<String>,
    ) -> Result<Self, RecordError> {
        Ok(Span::default().timed(times, values)?.with_quantity(quantity).with_unit(unit))
    }

    /// Time of the first sample (s).
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Sampling interval (s), the mean one of unequally spaced samples.
    pub fn interval(&self) -> f64 {
        self.interval
    }

    /// Sampling rate (Hz), the mean one of unequally spaced samples.
    pub fn rate(&self) -> f64 {
        self.interval.recip()
    }

    /// The samples, in the unit of the record.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The samples without their record.
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// Number of samples; at least one.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Always false: a record has at least one sample. It stands here because `len` does.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Time of sample `index` (s); `index` may lie beyond the end.
    pub fn time(&self, index: usize) -> f64 {
        let elapsed = self.elapsed.as_ref().and_then(|elapsed| elapsed.get(index));
        elapsed.map_or_else(|| self.time_at(index as f64), |elapsed| self.start + elapsed)
    }

    /// Time of a point between equally spaced samples (s), at a fractional index.
    pub(crate) fn time_at(&self, index: f64) -> f64 {
        self.start + self.interval * index
    }

    /// Times of all samples (s).
    pub fn times(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.values.len()).map(|index| self.time(index))
    }

    /// Time of the last sample (s).
    pub fn end(&self) -> f64 {
        self.time(self.values.len() - 1)
    }

    /// Time from the first sample to the last (s); 0 for a single sample.
    pub fn duration(&self) -> f64 {
        self.interval * (self.values.len() - 1) as f64
    }

    /// Measured quantity.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Unit of the samples.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// The same samples as another quantity: a reader cannot know what a channel measured.
    #[must_use]
    pub fn with_quantity(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self
    }

    /// The same samples in another unit, without a change of their numbers; [`Record::scaled`] changes both.
    #[must_use]
    pub fn with_unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = unit.into();
        self
    }

    /// The same samples with the first one at `start` (s).
    ///
    /// # Errors
    /// [`RecordError::Options`] as in [`Record::new`].
    pub fn starting_at(self, start: f64) -> Result<Self, RecordError> {
        let elapsed = self.elapsed;
        Ok(Self { elapsed, ..Self::new(start, self.interval, self.values, self.quantity, self.unit)? })
    }

    /// The samples from `from` to `to` (s), both ends included; times keep their origin. A sample counts as inside
    /// if it misses an end by no more than 1e-6 of the interval, so that rounding does not drop it.
    ///
    /// # Errors
    /// [`RecordError::Options`] if no sample lies there.
    pub fn crop(&self, from: f64, to: f64) -> Result<Self, RecordError> {
        let kept = self.samples_within(from, to)?;
        if self.is_equally_spaced() {
            return Ok(self.derived(self.time(kept.start), self.values[kept].to_vec()));
        }
        self.of_samples(kept)
    }

    /// The samples that [`Record::crop`] takes.
    pub(crate) fn samples_within(&self, from: f64, to: f64) -> Result<Range<usize>, RecordError> {
        let span = Span { from: Some(from), to: Some(to), ..Span::default() };
        match &self.elapsed {
            None => span.samples(self.start, self.interval, self.len()),
            Some(elapsed) => span.samples_at(self.start, elapsed),
        }
    }

    /// The same motion in `most` samples or fewer: the means of neighbours where there are more.
    pub(crate) fn in_at_most(&self, most: usize) -> Cow<'_, Self> {
        match self.len().div_ceil(most) {
            1 => Cow::Borrowed(self),
            group => self.means(group).map_or(Cow::Borrowed(self), Cow::Owned),
        }
    }

    /// Every sample times `factor`, in the new `unit`.
    ///
    /// # Errors
    /// [`RecordError::Options`] if the factor is zero or not finite, [`RecordError::Values`] if a product
    /// overflows.
    pub fn scaled(&self, factor: f64, unit: impl Into<String>) -> Result<Self, RecordError> {
        if factor == 0.0 || !factor.is_finite() {
            return Err(RecordError::options(format!("a scale factor must be finite and not zero, but is {factor}")));
        }
        let values = self.values.iter().map(|value| value * factor).collect();
        Ok(self.with_values(values)?.with_unit(unit))
    }

    /// Every sample less `offset` (in the unit of the record).
    ///
    /// # Errors
    /// [`RecordError::Options`] if the offset is not finite, [`RecordError::Values`] if a difference overflows.
    pub fn shifted(&self, offset: f64) -> Result<Self, RecordError> {
        if !offset.is_finite() {
            return Err(RecordError::options(format!("an offset must be finite, but is {offset}")));
        }
        self.with_values(self.values.iter().map(|value| value - offset).collect())
    }

    /// Other `values` at the same times.
    ///
    /// # Errors
    /// [`RecordError::Options`] if they are not as many, [`RecordError::Values`] if some are not finite.
    pub fn with_values(&self, values: Vec<f64>) -> Result<Self, RecordError> {
        if values.len() != self.len() {
            let (given, needed) = (values.len(), self.len());
            return Err(RecordError::options(format!("{given} values were given for a record of {needed} samples")));
        }
        let elapsed = self.elapsed.clone();
        Ok(Self { elapsed, ..Self::new(self.start, self.interval, values, self.quantity, self.unit.clone())? })
    }

    /// Arithmetic mean of all samples.
    pub fn mean(&self) -> f64 {
        mean(&self.values)
    }

    /// An equally spaced record like this one, with `values` that are known to be finite and not empty.
    pub(crate) fn derived(&self, start: f64, values: Vec<f64>) -> Self {
        let (quantity, unit) = (self.quantity, self.unit.clone());
        Self { start, interval: self.interval, elapsed: None, values, quantity, unit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::says;

    fn record(values: &[f64]) -> Result<Record, RecordError> {
        Record::new(1.0, 0.5, values.to_vec(), Quantity::Velocity, "m/s")
    }

    #[test]
    fn impossible_records_are_refused() {
        assert!(matches!(record(&[]), Err(RecordError::Values { index: 0, .. })));
        let error = record(&[0.0, 1.0, f64::NAN, f64::INFINITY]).unwrap_err();
        assert!(matches!(error, RecordError::Values { index: 2, .. }));
        assert_eq!(
            error.to_string(),
            "2 of 4 samples are not finite; the first is sample 2 (at 2 s); cut the record there, or fill the gap"
        );
        for interval in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                Record::new(0.0, interval, vec![0.0], Quantity::Other, ""),
                Err(RecordError::Options { .. })
            ));
        }
        for start in [1e300, f64::NAN, f64::INFINITY] {
            assert!(says(&Record::new(start, 1e-3, vec![0.0], Quantity::Other, ""), "cannot be told apart"));
        }
        assert!(says(&Record::sampled(0.0, vec![0.0], Quantity::Other, ""), "the sampling rate must be positive"));
    }

    #[test]
    fn times_and_span() {
        let record = record(&[0.0, 1.0, 2.0]).unwrap();
        assert_eq!((record.start(), record.end(), record.duration(), record.rate()), (1.0, 2.0, 1.0, 2.0));
        assert_eq!(record.times().collect::<Vec<_>>(), [1.0, 1.5, 2.0]);
    }

    #[test]
    fn crop_keeps_both_ends_and_the_origin_of_time() {
        let record = Record::new(0.0, 0.1, (0..100).map(f64::from).collect(), Quantity::Other, "").unwrap();
        // 0.3 is not a multiple of 0.1 in binary; the sample at its rounded place must not be lost.
        let piece = record.crop(0.3, 0.7).unwrap();
        assert_eq!(piece.values(), [3.0, 4.0, 5.0, 6.0, 7.0]);
        assert!((piece.start() - 0.3).abs() < 1e-15);
        assert_eq!(record.crop(f64::NEG_INFINITY, f64::INFINITY).unwrap(), record);
        let error = record.crop(20.0, 30.0).unwrap_err().to_string();
        assert!(error.starts_with("no sample lies between 20 s and 30 s; the record spans 0 s to 9.9"), "{error}");
        let error = record.crop(1e300, f64::INFINITY).unwrap_err().to_string();
        assert!(error.starts_with("no sample lies between 1e300 s and inf s"), "{error}");
        for (from, to) in [(0.5, 0.4), (0.11, 0.19), (f64::NAN, 1.0), (-2.0, -1.0)] {
            assert!(record.crop(from, to).is_err(), "{from} s to {to} s");
        }
    }

    #[test]
    fn scaling_and_shifting_refuse_what_loses_the_record() {
        let record = record(&[1.0, -2.0]).unwrap();
        assert_eq!(record.scaled(2.0, "V").unwrap().values(), [2.0, -4.0]);
        assert_eq!(record.scaled(2.0, "V").unwrap().unit(), "V");
        assert_eq!(record.shifted(1.0).unwrap().values(), [0.0, -3.0]);
        for factor in [0.0, f64::NAN, f64::INFINITY] {
            assert!(says(&record.scaled(factor, "V"), "a scale factor must be finite"));
        }
        assert!(says(&record.scaled(1e308, "V"), "not finite; the first is sample"));
        assert!(says(&record.shifted(f64::NAN), "must be finite, but is"));
    }

    #[test]
    fn mean_keeps_its_digits_beside_a_large_offset() {
        let values: Vec<f64> = (0..1_000_001).map(|i| 1e6 + f64::from(i % 3 - 1)).collect();
        // Deviations of whole numbers sum without rounding; the quotient rounds once.
        assert!((mean(&values) - 1e6).abs() < 1e-5, "{}", mean(&values));
    }
}
