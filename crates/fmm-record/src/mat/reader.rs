//! From an array of a MATLAB file to a record.

use std::path::Path;

use super::channel::Series;
use super::{Array, Channel, MatError, MatFile};
use crate::clock::{Clock, are_whole};
use crate::reading::{builder_of_choices, timed};
use crate::stated::stated;
use crate::{Quantity, Reading, Record, Resampling, Sampling, UniformTimes};

/// Reads one channel of a MATLAB file.
///
/// The channel is a vector, or a column `name(:,2)` or row `name(2,:)` of a matrix. Where none is named, a matrix must have
/// two columns, or two rows, the first of them time. Where no channel is named, the file must have exactly one array that
/// can be it.
///
/// The rate is, in this order: given; from the time stamps given; from the first column or row of the channel's own
/// matrix, if it increases uniformly and not by whole numbers; from a vector called `t`, `time` or the like of the same
/// length, in the unit of time that its name tells; from a scalar whose
/// name says rate or interval, such as `fs`, `ActualRate`, `sample_rate`, `dt`, `Ts`, in any case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MatReader {
    channel: Option<Channel>,
    time: Option<Channel>,
    rate: Option<f64>,
    resampling: Option<Resampling>,
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
    /// The errors of choice ([`MatError::NoSuchVariable`], [`MatError::NotNumeric`], [`MatError::Damaged`], [`MatError::Dimensions`],
    /// [`MatError::ChooseSeries`], [`MatError::NoSuchSeries`], [`MatError::ChooseVariable`]) and of sampling
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
        let time = match &self.time {
            Some(time) => Some(time.clone()),
            None => time_beside(file, array, &channel, values.len()).or_else(|| {
                let is_stated = self.rate.is_some() || !matches!(stated(scalars(file, array)), Ok(None));
                if is_stated { None } else { time_around(file, array, values.len()) }
            }),
        };
        let unit = self.unit.clone();
        let (record, sampling) = if let Some(rate) = self.rate {
            (Record::sampled(rate, values, self.quantity, unit)?, Sampling::Given { rate })
        } else if let Some(time) = &time {
            let mut times = numbers(file, time)?.1;
            // The name of a matrix is not that of its first series.
            let is_whole = time.series == Series::Whole;
            let clock = if is_whole { Clock::of(leaf(&time.variable)) } else { Clock::nameless() };
            clock.to_seconds(&time.to_string(), false, &mut times)?;
            let (record, sampling) = timed(time.to_string(), &times, values, self.resampling)?;
            (record.with_quantity(self.quantity).with_unit(unit), sampling)
        } else if let Some((rate, sampling)) = stated(scalars(file, array))? {
            (Record::sampled(rate, values, self.quantity, unit)?, sampling)
        } else {
            return Err(MatError::NoRate { available: file.listing() });
        };
        let time = time.map(|time| time.to_string());
        Ok(Reading { record, channel: channel.to_string(), time, columns: file.listing(), sampling })
    }

    /// The channel with its row or column, where the array is a matrix.
    fn resolved(&self, file: &MatFile, channel: &Channel) -> Result<Channel, MatError> {
        let array = file.array(&channel.variable)?;
        if channel.series != Series::Whole || !array.is_matrix() {
            return Ok(channel.clone());
        }
        let (rows, columns) = (array.rows(), array.columns());
        for (count, [first, second]) in [(columns, [1, 2].map(Series::Column)), (rows, [1, 2].map(Series::Row))] {
            let is_time = self.time == Some(Channel::of(array, first)) || is_uniform(array, first);
            if count == 2 && is_time {
                return Ok(Channel::of(array, second));
            }
        }
        Err(MatError::ChooseSeries { name: array.name().into(), rows, columns })
    }
}

/// The name of a field without that of its structure.
fn leaf(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}

/// The structure that a field lies in, empty for a variable.
fn parent(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(parent, _)| parent)
}

/// The scalars that may speak of an array, and their names: those beside it, and beside the structures that it lies in.
fn scalars<'a>(file: &'a MatFile, array: &'a Array) -> impl Iterator<Item = (&'a str, f64)> {
    let speaks = |other: &&Array| {
        let parent = parent(other.name());
        parent.is_empty() || array.name().strip_prefix(parent).is_some_and(|rest| rest.starts_with('.'))
    };
    file.arrays().iter().filter(speaks).filter_map(|other| other.scalar().map(|value| (other.name(), value)))
}

/// The only array that can be a channel: a vector that is not called time, or a matrix.
fn only_candidate(file: &MatFile) -> Result<&Array, MatError> {
    let is_time = |array: &Array| Clock::of(leaf(array.name())).is_time;
    let mut candidates =
        file.arrays().iter().filter(|array| array.is_matrix() || (array.is_vector() && !is_time(array)));
    match (candidates.next(), candidates.next()) {
        (Some(array), None) if file.damaged().is_empty() => Ok(array),
        _ => Err(MatError::ChooseVariable { available: file.listing() }),
    }
}

/// The array of a channel and its numbers.
fn numbers<'a>(file: &'a MatFile, channel: &Channel) -> Result<(&'a Array, Vec<f64>), MatError> {
    let array = file.array(&channel.variable)?;
    let (name, dimensions) = (array.name(), array.dimensions().len());
    if dimensions != 2 {
        return Err(MatError::Dimensions { name: name.into(), dimensions });
    }
    if channel.series == Series::Whole && array.is_matrix() {
        let (rows, columns) = (array.rows(), array.columns());
        return Err(MatError::ChooseSeries { name: name.into(), rows, columns });
    }
    let none = || MatError::NoSuchSeries { channel: channel.clone(), array: array.to_string() };
    Ok((array, array.series(channel.series).ok_or_else(none)?))
}

/// Time stamps beside the channel: in the first row or column of its matrix, or in a vector of the same length that is
/// called time, in the same structure.
fn time_beside(file: &MatFile, array: &Array, channel: &Channel, length: usize) -> Option<Channel> {
    let first = match channel.series {
        Series::Row(2..) => Some(Series::Row(1)),
        Series::Column(2..) => Some(Series::Column(1)),
        _ => None,
    };
    if let Some(first) = first.filter(|first| array.is_matrix() && is_time(array, *first)) {
        return Some(Channel::of(array, first));
    }
    let mut times = times(file, array, length);
    times.find(|time| parent(time.name()) == parent(array.name())).map(|time| Channel::variable(time.name()))
}

/// A vector of the same length that is called time, outside the structure of the channel.
fn time_around(file: &MatFile, array: &Array, length: usize) -> Option<Channel> {
    times(file, array, length).next().map(|time| Channel::variable(time.name()))
}

/// The vectors of that length that are called time.
fn times<'a>(file: &'a MatFile, array: &'a Array, length: usize) -> impl Iterator<Item = &'a Array> {
    file.arrays().iter().filter(move |other| {
        Clock::of(leaf(other.name())).is_known_time()
            && other.is_vector()
            && other.values().len() == length
            && other.name() != array.name()
    })
}

fn is_uniform(array: &Array, series: Series) -> bool {
    array.series(series).is_some_and(|times| UniformTimes::of(&times).is_ok())
}

/// Whether a series is time by nature: uniform, and no count of samples.
fn is_time(array: &Array, series: Series) -> bool {
    is_uniform(array, series) && !array.series(series).is_some_and(|times| are_whole(&times))
}
