//! From an array of a MATLAB file to a record.

use std::path::Path;

use super::{Array, Channel, MatError, MatFile};
use crate::clock::{Choice, Clock, are_whole};
use crate::reading::builder_of_choices;
use crate::stated::stated;
use crate::{Quantity, Reading, Record, Sampling, UniformTimes};

/// Reads one channel of a MATLAB file.
///
/// The channel is a vector, or a column of a matrix, written `name(:,2)`. Where no column is named, a matrix must
/// have two, the first of them time. Where no channel is named, the file must have exactly one array that can be it.
///
/// The rate is, in this order: given; from the time stamps given; from the first column of the channel's own
/// matrix, if it increases uniformly and not by whole numbers; from a vector called `t`, `time` or the like of the same
/// length, in the unit of time that its name tells; from a scalar whose
/// name says rate or interval, such as `fs`, `ActualRate`, `sample_rate`, `dt`, `Ts`, in any case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MatReader {
    channel: Option<Channel>,
    time: Option<Channel>,
    rate: Option<f64>,
    quantity: Quantity,
    unit: String,
}

impl MatReader {
    builder_of_choices!(Channel);

    /// Reads the file at `path`.
    ///
    /// # Errors
    /// As [`MatFile::read`] and [`MatReader::read_from`].
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Reading, MatError> {
        self.read_from(&MatFile::read(path)?)
    }

    /// Makes a record of a file that has been read.
    ///
    /// # Errors
    /// The errors of choice ([`MatError::NoSuchVariable`], [`MatError::NotNumeric`], [`MatError::Dimensions`],
    /// [`MatError::ChooseColumn`], [`MatError::NoSuchColumn`], [`MatError::ChooseVariable`]) and of sampling
    /// ([`MatError::NoRate`], [`MatError::ConflictingRates`], [`MatError::TimeAndRate`]), and [`MatError::Record`].
    pub fn read_from(&self, file: &MatFile) -> Result<Reading, MatError> {
        if self.time.is_some() && self.rate.is_some() {
            return Err(MatError::TimeAndRate);
        }
        let channel = match &self.channel {
            Some(channel) => self.resolved(file, channel)?,
            None => self.resolved(file, &Channel::variable(only_candidate(file)?.name()))?,
        };
        let (array, values) = numbers(file, &channel)?;
        let values = values.to_vec();
        let time = match &self.time {
            Some(time) => Some(time.clone()),
            None => time_beside(file, array, &channel),
        };
        let unit = self.unit.clone();
        let (record, sampling) = if let Some(rate) = self.rate {
            (Record::sampled(rate, values, self.quantity, unit)?, Sampling::Given { rate })
        } else if let Some(time) = &time {
            let mut times = numbers(file, time)?.1.to_vec();
            // The name of a matrix is not that of its first column.
            let clock = if time.column.is_none() { Clock::of(&time.variable) } else { Clock::nameless() };
            clock.to_seconds(&time.to_string(), Choice::Called, &mut times)?;
            let sampling = Sampling::Times { name: time.to_string() };
            (Record::from_times(&times, values, self.quantity, unit)?, sampling)
        } else if let Some((rate, sampling)) = stated(scalars(file))? {
            (Record::sampled(rate, values, self.quantity, unit)?, sampling)
        } else {
            return Err(MatError::NoRate { available: file.listing() });
        };
        let time = time.map(|time| time.to_string());
        Ok(Reading { record, channel: channel.to_string(), time, columns: file.listing(), sampling })
    }

    /// The channel with its column, where the array is a matrix.
    fn resolved(&self, file: &MatFile, channel: &Channel) -> Result<Channel, MatError> {
        let array = file.array(&channel.variable)?;
        if channel.column.is_some() || !array.is_matrix() {
            return Ok(channel.clone());
        }
        let first = Channel::column(array.name(), 1);
        let is_time = self.time.as_ref() == Some(&first) || has_uniform_first_column(array);
        if array.columns() == 2 && is_time {
            return Ok(Channel::column(array.name(), 2));
        }
        Err(MatError::ChooseColumn { name: array.name().into(), rows: array.rows(), columns: array.columns() })
    }
}

/// The scalars of a file and their names.
fn scalars(file: &MatFile) -> impl Iterator<Item = (&str, f64)> {
    file.arrays().iter().filter_map(|array| array.scalar().map(|value| (array.name(), value)))
}

/// The only array that can be a channel: a vector that is not called time, or a matrix.
fn only_candidate(file: &MatFile) -> Result<&Array, MatError> {
    let is_time = |array: &Array| Clock::of(array.name()).is_time;
    let mut candidates =
        file.arrays().iter().filter(|array| array.is_matrix() || (array.is_vector() && !is_time(array)));
    match (candidates.next(), candidates.next()) {
        (Some(array), None) => Ok(array),
        _ => Err(MatError::ChooseVariable { available: file.listing() }),
    }
}

/// The array of a channel and its numbers.
fn numbers<'a>(file: &'a MatFile, channel: &Channel) -> Result<(&'a Array, &'a [f64]), MatError> {
    let array = file.array(&channel.variable)?;
    let name = array.name();
    let dimensions = array.dimensions().len();
    if dimensions != 2 {
        return Err(MatError::Dimensions { name: name.into(), dimensions });
    }
    let column = match channel.column {
        Some(column) => column,
        None if array.is_matrix() => {
            let (rows, columns) = (array.rows(), array.columns());
            return Err(MatError::ChooseColumn { name: name.into(), rows, columns });
        }
        None => 1,
    };
    let none = || MatError::NoSuchColumn { name: name.into(), column, columns: array.columns() };
    Ok((array, array.column(column).ok_or_else(none)?))
}

/// Time stamps beside the channel: in the first column of its matrix, or in a vector of the same length that is
/// called time.
fn time_beside(file: &MatFile, array: &Array, channel: &Channel) -> Option<Channel> {
    if array.is_matrix() && channel.column != Some(1) && has_time_in_first_column(array) {
        return Some(Channel::column(array.name(), 1));
    }
    let length = if array.is_matrix() { array.rows() } else { array.values().len() };
    let is_time = |other: &&Array| {
        Clock::of(other.name()).is_known_time()
            && other.is_vector()
            && other.values().len() == length
            && other.name() != array.name()
    };
    file.arrays().iter().find(is_time).map(|time| Channel::variable(time.name()))
}

fn has_uniform_first_column(array: &Array) -> bool {
    array.column(1).is_some_and(|times| UniformTimes::of(times).is_ok())
}

/// Whether the first column is time by nature: uniform, and no count of samples.
fn has_time_in_first_column(array: &Array) -> bool {
    has_uniform_first_column(array) && !array.column(1).is_some_and(are_whole)
}
