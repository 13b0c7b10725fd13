//! One mode of a decay by itself.

use fmm_record::Record;

use crate::decay::backbone::{BackboneOptions, Prepared};
use crate::error::FrfError;

/// One mode of a decay without the others, by a filter that does not shift it.
#[derive(Debug, Clone)]
pub struct IsolatedMode {
    /// The mode alone.
    pub record: Record,
    /// Its frequency (Hz), about.
    pub frequency: f64,
    /// Duration of the record left out at its start and at its end (s): the filter looks so far in both directions.
    pub edge: f64,
}

impl IsolatedMode {
    /// The mode of `record` that the `options` ask for.
    ///
    /// Each sample is the mode's part of a regression around it, the same as for a [backbone](crate::Backbone). A
    /// parabolic envelope passes unchanged, and so does its phase; noise passes within about two cycles per window.
    /// Harmonics of friction are removed with the other modes, and an event such as a stop is smeared over half a
    /// window.
    ///
    /// ```
    /// use fmm_frf::{BackboneOptions, IsolatedMode};
    /// use fmm_record::{Quantity, Record};
    /// use std::f64::consts::TAU;
    ///
    /// let mode = |t: f64| (-2.0 * t).exp() * (TAU * 150.0 * t).cos();
    /// let other = |t: f64| 0.5 * (-5.0 * t).exp() * (TAU * 556.0 * t).cos();
    /// let values = (0..8000).map(|i| f64::from(i) / 5000.0).map(|t| mode(t) + other(t) + 0.1).collect();
    /// let record = Record::sampled(5000.0, values, Quantity::Acceleration, "m/s²")?;
    ///
    /// let alone = IsolatedMode::of(&record, &BackboneOptions::default().at(150.0)?)?;
    /// for (time, value) in alone.record.times().zip(alone.record.values()) {
    ///     assert!((value - mode(time)).abs() < 2e-4);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`Backbone::of`](crate::Backbone::of), except that nothing has to decay.
    pub fn of(record: &Record, options: &BackboneOptions) -> Result<Self, FrfError> {
        let record = &*record.equally_spaced();
        let Prepared { taken, frequency, fixed } = Prepared::of(record, options)?;
        let values = fixed.filtered(taken.values);
        let edge = taken.half as f64 * record.interval();
        let alone = Record::new(record.time(taken.half), record.interval(), values, record.quantity(), record.unit());
        let record = alone.map_err(|error| FrfError::values(error.to_string()))?;
        Ok(Self { record, frequency, edge })
    }
}
