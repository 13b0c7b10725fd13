//! From a table of numbers to a record.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::CsvError;
use super::table::Table;
use crate::clock::{Choice, Clock};
use crate::reading::builder_of_choices;
use crate::{Column, Quantity, Reading, Record, RecordError, Sampling, UniformTimes};

/// Reads one channel of a text file.
///
/// | what | found by default |
/// |---|---|
/// | separator | semicolon or tab if the rows have one, else comma |
/// | header | the first row, if any of its fields is not a number |
/// | decimal comma | where it is used throughout and the separator is not a comma |
/// | time | the column called `t`, `time`, `Zeit`, `timestamp` or the like, in seconds unless its name tells another unit (ms, µs, ns, min, h, in any usual spelling); else the first column, if it increases uniformly, but not by whole numbers without a unit |
/// | channel | the first column that is neither the time nor called a number of samples |
/// | quantity, unit | [`Quantity::Other`], empty |
///
/// With a rate, time stamps are not looked at, and the record begins at 0 s.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CsvReader {
    separator: Option<u8>,
    time: Option<Column>,
    channel: Option<Column>,
    rate: Option<f64>,
    quantity: Quantity,
    unit: String,
}

impl CsvReader {
    /// The byte between columns: comma, semicolon, tab, space, `|` or `:`.
    #[must_use]
    pub fn separator(mut self, separator: u8) -> Self {
        self.separator = Some(separator);
        self
    }

    builder_of_choices!(Column);

    /// Reads the file at `path`.
    ///
    /// # Errors
    /// [`CsvError::Open`], otherwise as [`CsvReader::read_from`].
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Reading, CsvError> {
        self.read_from(open(path.as_ref())?)
    }

    /// Reads text from `input`, which is buffered here.
    ///
    /// # Errors
    /// Any [`CsvError`] but [`CsvError::Open`]; infinite or missing numbers (`NaN`, `inf`) are
    /// [`RecordError::NonFinite`](crate::RecordError::NonFinite).
    pub fn read_from(&self, input: impl Read) -> Result<Reading, CsvError> {
        if self.time.is_some() && self.rate.is_some() {
            return Err(CsvError::TimeAndRate);
        }
        let table = Table::open(input, self.separator)?;
        let columns = table.names().to_vec();
        let channel = self.channel.as_ref().map(|column| table.find(column)).transpose()?;
        let time = match &self.time {
            Some(column) => Some(table.find(column)?),
            None => time_by_name(&columns, channel),
        };
        if let (Some(time), true) = (time, time == channel) {
            return Err(CsvError::SameColumn { column: columns[time].clone() });
        }
        let other_than =
            |time| (0..columns.len()).find(|index| *index != time && !Clock::of(&columns[*index]).is_counter);
        let found = match (time, channel) {
            (Some(time), channel) => {
                let Some(channel) = channel.or_else(|| other_than(time)) else {
                    return Err(CsvError::NoChannel { time: columns[time].clone() });
                };
                if self.rate.is_some() {
                    Found::only(channel, table.read_columns([channel])?).beside(time)
                } else {
                    Found::both(time, Choice::Called, channel, table.read_columns([time, channel])?)
                }
            }
            (None, Some(channel)) if self.rate.is_some() => Found::only(channel, table.read_columns([channel])?),
            // No column says that it is time: the first one is, if it increases uniformly.
            (None, channel) if columns.len() > 1 && channel != Some(0) && Clock::of(&columns[0]).may_be_time() => {
                let second = channel.unwrap_or(1);
                let [first, values] = table.read_columns([0, second])?;
                if UniformTimes::of(&first).is_ok() {
                    Found::both(0, Choice::ByNature, second, [first, values])
                } else if self.rate.is_some() {
                    if Clock::of(&columns[0]).is_counter {
                        Found::only(second, [values])
                    } else {
                        Found::only(0, [first])
                    }
                } else if Clock::of(&columns[0]).is_counter {
                    return Err(RecordError::Counter { name: columns[0].clone() }.into());
                } else {
                    return Err(CsvError::NoRate { available: columns });
                }
            }
            (None, None) if self.rate.is_some() => Found::only(0, table.read_columns([0])?),
            (None, _) => return Err(CsvError::NoRate { available: columns }),
        };
        self.reading(found, columns)
    }

    /// The columns of the file at `path` that can be the channel, by position counted from 0 and name: all but the time.
    ///
    /// ```
    /// use fmm_record::csv::CsvReader;
    ///
    /// let channels = CsvReader::default().channels_from("x,Zeit [ms],v\n1,0,4\n2,1,5\n".as_bytes())?;
    /// assert_eq!(channels, [(0, "x".to_owned()), (2, "v".to_owned())]);
    /// # Ok::<(), fmm_record::csv::CsvError>(())
    /// ```
    ///
    /// # Errors
    /// [`CsvError::Open`], otherwise as [`CsvReader::channels_from`].
    pub fn channels(&self, path: impl AsRef<Path>) -> Result<Vec<(usize, String)>, CsvError> {
        self.channels_from(open(path.as_ref())?)
    }

    /// The columns of text that can be the channel, as [`CsvReader::channels`]. Beyond the header, only what is needed to
    /// find the time is read.
    ///
    /// # Errors
    /// As [`CsvReader::read_from`], but for errors in columns other than the time.
    pub fn channels_from(&self, input: impl Read) -> Result<Vec<(usize, String)>, CsvError> {
        let table = Table::open(input, self.separator)?;
        let columns = table.names().to_vec();
        let named = match &self.time {
            Some(column) => Some(table.find(column)?),
            None => time_by_name(&columns, None),
        };
        let time = match named {
            Some(time) => Some(time),
            None if columns.len() > 1 && Clock::of(&columns[0]).may_be_time() => {
                // Text or gaps are no time either.
                table.read_columns([0]).ok().filter(|[first]| UniformTimes::of(first).is_ok()).map(|_| 0)
            }
            _ => None,
        };
        let is_channel = |(index, name): &(usize, String)| Some(*index) != time && !Clock::of(name).is_counter;
        Ok(columns.into_iter().enumerate().filter(is_channel).collect())
    }

    fn reading(&self, found: Found, columns: Vec<String>) -> Result<Reading, CsvError> {
        let time = found.time.map(|index| columns[index].clone());
        let unit = self.unit.clone();
        let (record, sampling) = match (self.rate, found.times, &time) {
            (Some(rate), ..) => (Record::sampled(rate, found.values, self.quantity, unit)?, Sampling::Given { rate }),
            (None, Some(mut times), Some(name)) => {
                Clock::of(name).to_seconds(name, found.choice, &mut times)?;
                let record = Record::from_times(&times, found.values, self.quantity, unit)?;
                (record, Sampling::Times { name: name.clone() })
            }
            _ => return Err(CsvError::NoRate { available: columns }),
        };
        Ok(Reading { record, channel: columns[found.channel].clone(), time, columns, sampling })
    }
}

fn open(path: &Path) -> Result<File, CsvError> {
    File::open(path).map_err(|source| CsvError::Open { path: path.into(), source })
}

/// The first column that is called time, other than the channel; one in a known unit before others.
fn time_by_name(columns: &[String], channel: Option<usize>) -> Option<usize> {
    let first = |is_time: fn(&Clock) -> bool| {
        let mut others = columns.iter().enumerate().filter(|(index, _)| Some(*index) != channel);
        others.find(|(_, name)| is_time(&Clock::of(name))).map(|(index, _)| index)
    };
    first(Clock::is_known_time).or_else(|| first(|clock| clock.is_time))
}

/// The columns in use and their numbers; the time stamps are not needed where the rate is given.
struct Found {
    time: Option<usize>,
    times: Option<Vec<f64>>,
    choice: Choice,
    channel: usize,
    values: Vec<f64>,
}

impl Found {
    fn only(channel: usize, [values]: [Vec<f64>; 1]) -> Self {
        Self { time: None, times: None, choice: Choice::Called, channel, values }
    }

    fn both(time: usize, choice: Choice, channel: usize, [times, values]: [Vec<f64>; 2]) -> Self {
        Self { time: Some(time), times: Some(times), choice, channel, values }
    }

    fn beside(self, time: usize) -> Self {
        Self { time: Some(time), ..self }
    }
}
