//! From an array of NumPy to a record.

use std::path::Path;

use super::{Channel, NpyArray, NpyError, NpyFile, Series};
use crate::clock::{Clock, are_whole};
use crate::reading::{builder_of_choices, timed};
use crate::stated::stated;
use crate::{Quantity, Reading, Record, Resampling, Sampling, UniformTimes};

/// Reads one channel of a file of NumPy.
///
/// The channel is a vector, or a row or column of a matrix. Where none is named, a matrix must have two series, the
/// first of them time; its series are its rows if these are longer than its columns. Where no array is named, the file
/// must have exactly one that can be the channel.
///
/// The rate is, in this order: given; from the time stamps given; from the first row or column of the channel's own
/// matrix, if it increases uniformly and not by whole numbers; from a vector called `t`, `time` or the like of the same
/// length, in the unit of time that its name tells; from a single number whose
/// name says rate or interval, such as `fs`, `sample_rate`, `dt`, in any case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NpyReader {
    channel: Option<Channel>,
    time: Option<Channel>,
    rate: Option<f64>,
    resampling: Option<Resampling>,
    quantity: Quantity,
    unit: String,
}

impl NpyReader {
    builder_of_choices!(Channel);

    /// Reads the file at `path`.
    ///
    /// # Errors
    /// As [`NpyFile::read`] and [`NpyReader::read_from`].
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Reading, NpyError> {
        self.read_from(&NpyFile::read(path)?)
    }

    /// Makes a record of a file that has been read.
    ///
    /// # Errors
    /// The errors of choice ([`NpyError::NoSuchArray`], [`NpyError::Damaged`], [`NpyError::Unsupported`], [`NpyError::Axes`],
    /// [`NpyError::ChooseSeries`], [`NpyError::NoSuchSeries`], [`NpyError::ChooseArray`]) and of sampling
    /// ([`NpyError::NoRate`], [`NpyError::ConflictingRates`], [`NpyError::TimeAndRate`]), and [`NpyError::Record`].
    pub fn read_from(&self, file: &NpyFile) -> Result<Reading, NpyError> {
        if self.time.is_some() && self.rate.is_some() {
            return Err(NpyError::TimeAndRate);
        }
        let whole = |array: &NpyArray| Channel { array: array.name().into(), series: Series::Whole };
        let channel = match &self.channel {
            Some(channel) => self.resolved(file, channel)?,
            None => self.resolved(file, &whole(only_candidate(file)?))?,
        };
        let values = numbers(file, &channel)?;
        let time = match &self.time {
            Some(time) => Some(time.clone()),
            None => time_beside(file, &channel, values.len())?,
        };
        let scalars = file.arrays().iter().filter_map(|array| array.scalar().map(|value| (array.name(), value)));
        let unit = self.unit.clone();
        let (record, sampling) = if let Some(rate) = self.rate {
            (Record::sampled(rate, values, self.quantity, unit)?, Sampling::Given { rate })
        } else if let Some(time) = &time {
            let mut times = numbers(file, time)?;
            // The name of a matrix is not that of its first series.
            let clock = if time.series == Series::Whole { Clock::of(&time.array) } else { Clock::nameless() };
            clock.to_seconds(&time.to_string(), false, &mut times)?;
            let (record, sampling) = timed(time.to_string(), &times, values, self.resampling)?;
            (record.with_quantity(self.quantity).with_unit(unit), sampling)
        } else if let Some((rate, sampling)) = stated(scalars)? {
            (Record::sampled(rate, values, self.quantity, unit)?, sampling)
        } else {
            return Err(NpyError::NoRate { available: file.listing() });
        };
        let time = time.map(|time| time.to_string());
        Ok(Reading { record, channel: channel.to_string(), time, columns: file.listing(), sampling })
    }

    /// The channel with its row or column, where the array is a matrix.
    fn resolved(&self, file: &NpyFile, channel: &Channel) -> Result<Channel, NpyError> {
        let array = file.array(&channel.array)?;
        let (Series::Whole, Some((rows, columns))) = (channel.series, array.matrix()) else {
            return Ok(channel.clone());
        };
        let of_array = |series| Channel { array: channel.array.clone(), series };
        let (count, first, second) = if rows < columns {
            (rows, Series::Row(0), Series::Row(1))
        } else {
            (columns, Series::Column(0), Series::Column(1))
        };
        let is_time = self.time == Some(of_array(first)) || is_uniform(array, first);
        if count == 2 && is_time {
            return Ok(of_array(second));
        }
        Err(NpyError::ChooseSeries { name: channel.array.clone(), rows, columns })
    }
}

/// The only array that can be a channel: a vector that is not called time, or a matrix.
fn only_candidate(file: &NpyFile) -> Result<&NpyArray, NpyError> {
    let is_time = |array: &NpyArray| Clock::of(array.name()).is_time;
    let mut candidates =
        file.arrays().iter().filter(|array| array.matrix().is_some() || (array.is_vector() && !is_time(array)));
    match (candidates.next(), candidates.next()) {
        (Some(array), None) if file.damaged().is_empty() => Ok(array),
        _ => Err(NpyError::ChooseArray { available: file.listing() }),
    }
}

/// The numbers of a channel.
fn numbers(file: &NpyFile, channel: &Channel) -> Result<Vec<f64>, NpyError> {
    let array = file.array(&channel.array)?;
    let name = || channel.array.clone();
    match (channel.series, array.matrix()) {
        (Series::Whole, Some((rows, columns))) => Err(NpyError::ChooseSeries { name: name(), rows, columns }),
        (Series::Whole, None) if array.shape().len() > 2 => {
            Err(NpyError::Axes { name: name(), axes: array.shape().len() })
        }
        // A vector is its own row.
        (Series::Row(0) | Series::Column(0), None) if array.is_vector() => Ok(array.values().to_vec()),
        (series, _) => array.series(series).ok_or_else(|| {
            let array = array.to_string();
            NpyError::NoSuchSeries { channel: channel.clone(), array }
        }),
    }
}

/// Time stamps beside the channel: the first row or column of its matrix, or a vector of the same length that is
/// called time.
fn time_beside(file: &NpyFile, channel: &Channel, length: usize) -> Result<Option<Channel>, NpyError> {
    let array = file.array(&channel.array)?;
    let first = match channel.series {
        Series::Row(1..) => Some(Series::Row(0)),
        Series::Column(1..) => Some(Series::Column(0)),
        _ => None,
    };
    if let Some(series) = first.filter(|series| array.matrix().is_some() && is_time(array, *series)) {
        return Ok(Some(Channel { array: channel.array.clone(), series }));
    }
    let is_called_time = |other: &&NpyArray| {
        Clock::of(other.name()).is_known_time()
            && other.is_vector()
            && other.values().len() == length
            && other.name() != array.name()
    };
    let time = file.arrays().iter().find(is_called_time);
    Ok(time.map(|time| Channel { array: time.name().into(), series: Series::Whole }))
}

fn is_uniform(array: &NpyArray, series: Series) -> bool {
    array.series(series).is_some_and(|times| UniformTimes::of(&times).is_ok())
}

/// Whether a series is time by nature: uniform, and no count of samples.
fn is_time(array: &NpyArray, series: Series) -> bool {
    is_uniform(array, series) && !array.series(series).is_some_and(|times| are_whole(&times))
}
