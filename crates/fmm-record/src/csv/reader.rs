//! From a table of numbers to a record.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::CsvError;
use super::table::Table;
use crate::clock::Clock;
use crate::reading::{builder_of_choices, timed};
use crate::stated::stated;
use crate::{Column, Quantity, Reading, Record, RecordError, Resampling, Sampling, UniformTimes};

/// Reads one channel of a text file.
///
/// | what | found by default |
/// |---|---|
/// | separator | semicolon or tab if the rows have one, else blanks between nothing but numbers, else comma; what a first line `sep=;` says |
/// | first row | the first line with as many fields as the last ones have, and numbers where they have numbers |
/// | names | the line above the first row, with the units of a row of units; or a comment there, if it names the time |
/// | decimal comma | where it is used throughout and the separator is not a comma; one column of whole numbers with commas is refused if it may be two |
/// | time | the column called `t`, `time`, `Zeit`, `timestamp` or the like, in seconds unless its name tells another unit (ms, µs, ns, min, h, in any usual spelling); else the first column, if it increases uniformly, but not by whole numbers without a unit |
/// | channel | the first column that is neither the time nor called a number of samples |
/// | quantity, unit | [`Quantity::Other`], empty |
///
/// Where no column is time, a number above the table that is called an interval or a rate (`Sample Interval`, `Delta_X`) tells
/// the rate. With a rate, time stamps are not looked at, and the record begins at 0 s.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CsvReader {
    separator: Option<u8>,
    skip: u64,
    time: Option<Column>,
    channel: Option<Column>,
    rate: Option<f64>,
    resampling: Option<Resampling>,
    quantity: Quantity,
    unit: String,
}

impl CsvReader {
    /// Passes over the first `lines` lines of the file, which may hold anything.
    #[must_use]
    pub fn skip(mut self, lines: u64) -> Self {
        self.skip = lines;
        self
    }

    /// The byte between columns: comma, semicolon, tab, `|` or `:`; a space stands for blanks, as many as there are.
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
        let table = Table::open(input, self.separator, self.skip)?;
        let columns = table.names().to_vec();
        let channel = self.channel.as_ref().map(|column| table.find(column)).transpose()?;
        let time = match &self.time {
            Some(column) => Some(table.find(column)?),
            None => time_by_name(&columns, channel),
        };
        if let (Some(time), true) = (time, time == channel) {
            return Err(CsvError::SameColumn { column: columns[time].clone() });
        }
        let rate = match self.rate {
            Some(rate) => Some((rate, Sampling::Given { rate })),
            None if time.is_some() => None,
            None => stated(table.stated().iter().map(|(name, value)| (&name[..], *value)))?,
        };
        let first = time.unwrap_or(table.first());
        let is_other =
            |index: &usize| *index != first && !table.is_blank(*index) && !Clock::of(&columns[*index]).is_counter;
        let other = channel.or_else(|| (0..columns.len()).find(is_other));
        let may_be_time = Clock::of(&columns[first]).may_be_time();
        let is_settled = channel.is_some() && self.rate.is_some();
        let series = match (time, other, rate) {
            (Some(time), None, _) => return Err(CsvError::NoChannel { time: columns[time].clone() }),
            (Some(time), Some(channel), Some(rate)) => {
                Series::of(channel, table.read_columns([channel])?).at(rate).beside(time)
            }
            (Some(time), Some(channel), None) => {
                let [times, values] = table.read_columns([time, channel])?;
                Series::of(channel, [values]).timed(time, false, times)
            }
            (None, Some(second), rate) if may_be_time && !is_settled && second != first => {
                let both = table.read_columns([first, second])?;
                by_nature(&columns, [first, second], both, rate, channel.is_some())?
            }
            (None, _, Some(rate)) => {
                let channel = channel.unwrap_or(first);
                Series::of(channel, table.read_columns([channel])?).at(rate)
            }
            (None, _, None) => return Err(CsvError::NoRate { available: columns }),
        };
        self.reading(series, columns)
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
        let table = Table::open(input, self.separator, self.skip)?;
        let columns = table.names().to_vec();
        let first = table.first();
        let blank: Vec<bool> = (0..columns.len()).map(|column| table.is_blank(column)).collect();
        let named = match &self.time {
            Some(column) => Some(table.find(column)?),
            None => time_by_name(&columns, None),
        };
        let time = match named {
            Some(time) => Some(time),
            None if columns.len() > 1 && Clock::of(&columns[first]).may_be_time() => {
                // Text or gaps are no time either.
                table.read_columns([first]).ok().filter(|[times]| UniformTimes::of(times).is_ok()).map(|_| first)
            }
            _ => None,
        };
        let is_channel =
            |(index, name): &(usize, String)| Some(*index) != time && !blank[*index] && !Clock::of(name).is_counter;
        Ok(columns.into_iter().enumerate().filter(is_channel).collect())
    }

    fn reading(&self, series: Series, columns: Vec<String>) -> Result<Reading, CsvError> {
        let Series { time, channel, values, scale } = series;
        let (time, channel) = (time.map(|index| columns[index].clone()), columns[channel].clone());
        let (quantity, unit) = (self.quantity, self.unit.clone());
        let (record, sampling) = match (scale, &time) {
            (Some(Scale::Rate(rate, sampling)), _) => (Record::sampled(rate, values, quantity, unit)?, sampling),
            (Some(Scale::Times(by_nature, mut times)), Some(name)) => {
                Clock::of(name).to_seconds(name, by_nature, &mut times)?;
                let (record, sampling) = timed(name.clone(), &times, values, self.resampling)?;
                (record.with_quantity(quantity).with_unit(unit), sampling)
            }
            _ => return Err(CsvError::NoRate { available: columns }),
        };
        Ok(Reading { record, channel, time, columns, sampling })
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

/// The series of a table in which no column says that it is time: the first one is, if it increases uniformly and does not
/// count. `rate` is that which is given or stated above the table; `is_chosen` tells whether the second column is the channel
/// in any case.
fn by_nature(
    columns: &[String],
    [first, second]: [usize; 2],
    [times, values]: [Vec<f64>; 2],
    rate: Option<(f64, Sampling)>,
    is_chosen: bool,
) -> Result<Series, CsvError> {
    let clock = Clock::of(&columns[first]);
    let is_uniform = UniformTimes::of(&times).is_ok();
    let counts = clock.is_counter || (is_uniform && clock.counts(&times));
    let is_time = is_uniform && !counts;
    let is_given = matches!(rate, Some((_, Sampling::Given { .. })));
    match rate {
        Some(rate) if is_given || !is_time => Ok(match is_time || counts || is_chosen {
            true if is_time => Series::of(second, [values]).at(rate).beside(first),
            true => Series::of(second, [values]).at(rate),
            false => Series::of(first, [times]).at(rate),
        }),
        _ if is_time => Ok(Series::of(second, [values]).timed(first, true, times)),
        _ if counts => Err(RecordError::Counter { name: columns[first].clone() }.into()),
        _ => Err(CsvError::NoRate { available: columns.to_vec() }),
    }
}

/// The columns in use, the numbers of the channel, and what scales its time.
struct Series {
    time: Option<usize>,
    channel: usize,
    values: Vec<f64>,
    scale: Option<Scale>,
}

enum Scale {
    Rate(f64, Sampling),
    /// Time stamps, and whether they are such by nature only.
    Times(bool, Vec<f64>),
}

impl Series {
    fn of(channel: usize, [values]: [Vec<f64>; 1]) -> Self {
        Self { time: None, channel, values, scale: None }
    }

    fn at(self, (rate, sampling): (f64, Sampling)) -> Self {
        Self { scale: Some(Scale::Rate(rate, sampling)), ..self }
    }

    fn timed(self, time: usize, by_nature: bool, times: Vec<f64>) -> Self {
        Self { time: Some(time), scale: Some(Scale::Times(by_nature, times)), ..self }
    }

    fn beside(self, time: usize) -> Self {
        Self { time: Some(time), ..self }
    }
}
