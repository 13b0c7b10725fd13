//! Between data sets and records.

use super::{Abscissa, DataSet, DataType, FunctionType, Ordinate, UffFile};
use crate::files::reading::{only, quoted, seconds_in};
use crate::record::Span;
use crate::sampling::whole_hertz;
use crate::{Column, Reading, Record, RecordError, Sampling};

impl DataSet {
    /// The record over time that this is, with the quantity and the unit of its ordinate.
    ///
    /// The format has six digits for the interval. If the file has no more, and a whole number of hertz agrees with
    /// them within [`RATE_ROUNDING`](crate::RATE_ROUNDING), that is the sampling rate.
    ///
    /// # Errors
    /// [`RecordError::Unsupported`] for a function that is not one of time or not real, [`RecordError::TimeAxis`] for a
    /// unit of time that is not known, otherwise as [`Record::new`] and [`Record::from_times`].
    pub fn record(&self) -> Result<Record, RecordError> {
        self.sampled_record(Span::default()).map(|(record, _)| record)
    }

    /// Whether it is a record over time.
    fn is_over_time(&self) -> bool {
        match (self.header.function, self.header.abscissa.data_type) {
            (FunctionType::TIME_RESPONSE | FunctionType::GENERAL, DataType::TIME) => true,
            (FunctionType::TIME_RESPONSE, data_type) => matches!(data_type, DataType::UNKNOWN | DataType::GENERAL),
            _ => false,
        }
    }

    fn sampled_record(&self, span: Span) -> Result<(Record, Sampling), RecordError> {
        let header = &self.header;
        if !self.is_over_time() {
            let (name, function) = (self.name(), header.function);
            return Err(RecordError::unsupported(format!("\"{name}\" is no record over time, but a {function}")));
        }
        let Ordinate::Real(values) = self.ordinate() else {
            let name = self.name();
            return Err(RecordError::unsupported(format!("\"{name}\" has complex values; a record is real")));
        };
        let unit = &header.abscissa.unit;
        let second = seconds_in(unit).ok_or_else(|| {
            let name = self.name();
            RecordError::time(None, format!("the time axis of \"{name}\" is in \"{unit}\"; known are s, ms, µs and ns"))
        })?;
        let (values, quantity) = (values.clone(), header.ordinate.data_type.quantity());
        let unit = header.ordinate.unit.clone();
        Ok(match self.abscissa() {
            Abscissa::Even { start, step } => {
                let interval = if has_six_digits(*step) { whole_hertz(step * second) } else { step * second };
                let record = span.record(start * second, interval, values, quantity, unit)?;
                (record, Sampling::Header { interval: step * second, rate: interval.recip() })
            }
            Abscissa::Uneven(times) => {
                let times: Vec<f64> = times.iter().map(|time| time * second).collect();
                let record = span.timed(&times, values, quantity, unit)?;
                (record, Sampling::Times { name: header.abscissa.label.clone() })
            }
        })
    }
}

/// Whether six digits are enough to write a number.
fn has_six_digits(number: f64) -> bool {
    format!("{number:.5e}").parse() == Ok(number)
}

impl UffFile {
    /// The record in the data set called `channel`, as [`DataSet::name`] calls it, or at that position.
    ///
    /// # Errors
    /// [`RecordError::NoSuchChannel`], [`RecordError::WhichChannel`], otherwise as [`DataSet::record`].
    pub fn channel(&self, channel: impl Into<Column>) -> Result<Reading, RecordError> {
        self.part(Some(&channel.into()), Span::default())
    }

    /// The part within `span` of a channel, or else of the only record over time.
    pub(crate) fn part(&self, channel: Option<&Column>, span: Span) -> Result<Reading, RecordError> {
        let Some(channel) = channel else { return self.reading_of(self.only_over_time()?, span) };
        let names = self.names();
        self.reading_of(only(&channel.among(&[&names]), channel, "data set", &names)?, span)
    }

    /// The only record over time in the file.
    ///
    /// # Errors
    /// [`RecordError::WhichChannel`] if there are none or several, otherwise as [`DataSet::record`].
    pub fn reading(&self) -> Result<Reading, RecordError> {
        self.part(None, Span::default())
    }

    fn only_over_time(&self) -> Result<usize, RecordError> {
        let over_time: Vec<usize> = (0..self.sets().len()).filter(|index| self.sets()[*index].is_over_time()).collect();
        if let [index] = over_time[..] {
            return Ok(index);
        }
        let (count, names) = (over_time.len(), quoted(&self.names()));
        let what = format!("name the data set; the file has {count} records over time among: {names}");
        Err(RecordError::WhichChannel { what })
    }

    /// The names of all data sets 58, as [`DataSet::name`] calls them.
    pub fn names(&self) -> Vec<String> {
        self.sets().iter().map(DataSet::name).collect()
    }

    fn reading_of(&self, index: usize, span: Span) -> Result<Reading, RecordError> {
        let set = &self.sets()[index];
        let (record, sampling) = set.sampled_record(span)?;
        Ok(Reading { record, channel: set.name(), time: None, columns: self.names(), sampling })
    }
}
