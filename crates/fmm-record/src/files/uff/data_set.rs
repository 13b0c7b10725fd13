//! Data set 58: a function of an abscissa, and its record if the abscissa is time.

use crate::error::RecordError;
use crate::files::reading::{Column, Reading, only, quoted};
use crate::files::uff::UffFile;
use crate::files::uff::header::{Axis, DataType, FunctionType, Header};
use crate::record::{Record, Span};
use crate::sampling::{Sampling, in_six_digits, whole_hertz};
use crate::units::seconds_in;

/// A function as a data set 58 holds it. It has at least one point, and as many abscissae as ordinates.
///
/// Numbers are as in the file: they may be infinite or not a number, as the ratio of two spectra is where both
/// vanish. [`DataSet::record`] refuses those.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSet {
    /// Labels, place and axes.
    pub header: Header,
    abscissa: Abscissa,
    ordinate: Ordinate,
}

/// Abscissa of a function.
#[derive(Debug, Clone, PartialEq)]
pub enum Abscissa {
    /// Abscissae at equal distances.
    Even {
        /// The first point.
        start: f64,
        /// Distance from point to point.
        step: f64,
    },
    /// Anywhere.
    Uneven(Vec<f64>),
}

/// The values of a function.
#[derive(Debug, Clone, PartialEq)]
pub enum Ordinate {
    /// Real numbers.
    Real(Vec<f64>),
    /// Complex numbers: real and imaginary part.
    Complex(Vec<[f64; 2]>),
}

impl Ordinate {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Complex(values) => values.len(),
        }
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl DataSet {
    /// A function of as many abscissae as ordinates.
    ///
    /// # Errors
    /// [`RecordError::Values`] without points, [`RecordError::Options`] for other numbers of abscissae than of
    /// ordinates, or a start or step that are not finite.
    pub fn new(header: Header, abscissa: Abscissa, ordinate: Ordinate) -> Result<Self, RecordError> {
        if ordinate.is_empty() {
            let what = "a data set needs at least one point, but none were given".into();
            return Err(RecordError::Values { index: 0, what });
        }
        match &abscissa {
            Abscissa::Even { start, step } if !(start.is_finite() && step.is_finite()) => Err(RecordError::options(
                format!("an even abscissa must be finite, but starts at {start} with a step of {step}"),
            )),
            Abscissa::Uneven(values) if values.len() != ordinate.len() => {
                let (abscissae, ordinates) = (values.len(), ordinate.len());
                Err(RecordError::options(format!("{abscissae} abscissae were given for {ordinates} ordinates")))
            }
            _ => Ok(Self { header, abscissa, ordinate }),
        }
    }

    /// A record over time, without a description or a place.
    pub fn of_record(record: &Record) -> Self {
        let header = Header {
            function: FunctionType::TIME_RESPONSE,
            abscissa: Axis::new(DataType::TIME, "Time", "s"),
            ordinate: Axis::new(record.quantity().into(), "", record.unit()),
            ..Header::default()
        };
        Self {
            header,
            abscissa: Abscissa::Even { start: record.start(), step: record.interval() },
            ordinate: Ordinate::Real(record.values().to_vec()),
        }
    }

    /// Abscissa of its points, as the file states it.
    pub fn abscissa(&self) -> &Abscissa {
        &self.abscissa
    }

    /// Its values.
    pub fn ordinate(&self) -> &Ordinate {
        &self.ordinate
    }

    /// The abscissae of all points, as the file says them.
    pub fn abscissae(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.ordinate.len()).map(|index| match &self.abscissa {
            Abscissa::Even { start, step } => start + step * index as f64,
            Abscissa::Uneven(values) => values[index],
        })
    }

    /// Name: its description, or else the place of its response, as `3+Z`.
    pub fn name(&self) -> String {
        let description = &self.header.lines[0];
        if description.is_empty() { self.header.response.to_string() } else { description.clone() }
    }

    /// The record over time that this is, with the quantity and the unit of its ordinate.
    ///
    /// The format has six digits for the interval. If the file has no more, and a whole number of hertz agrees with
    /// them within 10⁻⁵, that is the sampling rate.
    ///
    /// # Errors
    /// [`RecordError::Unsupported`] for a function that is not one of time or not real, [`RecordError::TimeAxis`] for a
    /// unit of time that is not known, otherwise as [`Record::new`] and [`Record::from_times`].
    pub fn record(&self) -> Result<Record, RecordError> {
        self.sampled_record(Span::default()).map(|(record, _)| record)
    }

    /// True for a record over time.
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
        let values = values.clone();
        let (record, sampling) = match self.abscissa() {
            Abscissa::Even { start, step } => {
                let interval = if in_six_digits(*step) == *step { whole_hertz(step * second) } else { step * second };
                let sampling = Sampling::Header { interval: step * second, rate: interval.recip() };
                (span.record(start * second, interval, values)?, sampling)
            }
            Abscissa::Uneven(times) => {
                let times: Vec<f64> = times.iter().map(|time| time * second).collect();
                (span.timed(&times, values)?, Sampling::Times { name: header.abscissa.label.clone() })
            }
        };
        let axis = &header.ordinate;
        Ok((record.with_quantity(axis.data_type.quantity()).with_unit(&*axis.unit), sampling))
    }
}

impl UffFile {
    /// The part within `span` of a channel, or else of the only record over time.
    pub(crate) fn part(&self, channel: Option<&Column>, span: Span) -> Result<Reading, RecordError> {
        let columns = self.names();
        let index = match channel {
            Some(channel) => only(&channel.among(&[&columns]), channel, "data set", &columns)?,
            None => self.only_over_time()?,
        };
        let set = &self.sets()[index];
        let (record, sampling) = set.sampled_record(span)?;
        Ok(Reading { record, channel: set.name(), time: None, columns, sampling, remarks: Vec::new() })
    }

    /// Position of the only record over time in the file.
    fn only_over_time(&self) -> Result<usize, RecordError> {
        let over_time: Vec<usize> = (0..self.sets().len()).filter(|index| self.sets()[*index].is_over_time()).collect();
        if let [index] = over_time[..] {
            return Ok(index);
        }
        let (count, names) = (over_time.len(), quoted(&self.names()));
        let what = format!("name the data set; the file has {count} records over time among: {names}");
        Err(RecordError::channel(what))
    }

    /// The names of all data sets 58, as [`DataSet::name`] calls them.
    pub fn names(&self) -> Vec<String> {
        self.sets().iter().map(DataSet::name).collect()
    }
}
