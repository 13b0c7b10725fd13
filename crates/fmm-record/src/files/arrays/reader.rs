//! From an array to a record.

use super::{Array, ArrayFile, Series, Slice};
use crate::files::clock::{Clock, are_whole};
use crate::files::reading::timed;
use crate::files::stated::stated;
use crate::{Quantity, Reader, Reading, RecordError, Sampling, UniformTimes};

impl ArrayFile {
    /// Makes a record of the channel that a reader names.
    ///
    /// The channel is a vector, or a row or column of a matrix. Where none is named, a matrix must have two columns, or
    /// two rows, the first of them time. Where no array is named, the file must have exactly one that can be the
    /// channel.
    ///
    /// The page of [`Reader`] has the sources of the rate, in their order.
    pub(crate) fn read(&self, reader: &Reader) -> Result<Reading, RecordError> {
        let given_time = reader.time.as_ref().map(|time| self.slice(time)).transpose()?;
        let channel = match &reader.channel {
            Some(channel) => self.slice(channel)?,
            None => Slice::of(self.only_candidate()?, Series::Whole),
        };
        let channel = self.resolved(channel, given_time.as_ref())?;
        let (array, values) = self.numbers(&channel)?;
        let time = given_time.or_else(|| self.time_beside(array, &channel, values.len())).or_else(|| {
            let is_stated = reader.rate.is_some() || !matches!(stated(self.scalars(array)), Ok(None));
            let around = || self.times(array, values.len()).next();
            if is_stated { None } else { around().map(|time| Slice::of(time, Series::Whole)) }
        });
        let (record, sampling) = if let Some(rate) = reader.rate {
            (reader.span.sampled(rate, values, Quantity::Other, "")?, Sampling::Given { rate })
        } else if let Some(time) = &time {
            let mut times = self.numbers(time)?.1;
            let name = time.written(self.notation);
            // The name of a matrix is not that of its first series.
            let clock = if time.series == Series::Whole { Clock::of(leaf(&time.array)) } else { Clock::nameless() };
            clock.to_seconds(&name, false, &mut times)?;
            timed(name, &times, values, reader.resampling, reader.span)?
        } else if let Some((rate, sampling)) = stated(self.scalars(array))? {
            (reader.span.sampled(rate, values, Quantity::Other, "")?, sampling)
        } else {
            let there = self.listing();
            return Err(RecordError::time(
                None,
                format!("the sampling rate is not known: give a rate or time stamps; the file has: {there}"),
            ));
        };
        let time = time.map(|time| time.written(self.notation));
        Ok(Reading { record, channel: channel.written(self.notation), time, columns: self.names(), sampling })
    }

    /// The channel with its row or column, where the array is a matrix.
    fn resolved(&self, channel: Slice, time: Option<&Slice>) -> Result<Slice, RecordError> {
        let array = self.array(&channel.array)?;
        let (Series::Whole, Some((rows, columns))) = (channel.series, array.matrix()) else { return Ok(channel) };
        for (count, [first, second]) in [(columns, [0, 1].map(Series::Column)), (rows, [0, 1].map(Series::Row))] {
            let is_time = || time == Some(&Slice::of(array, first)) || is_uniform(array, first);
            if count == 2 && is_time() {
                return Ok(Slice::of(array, second));
            }
        }
        let written = |series| Slice::of(array, series).written(self.notation);
        let (row, column) = (written(Series::Row(0)), written(Series::Column(0)));
        let name = if array.name().is_empty() { "the array".to_owned() } else { format!("\"{}\"", array.name()) };
        let what = format!("{name} has {rows} rows and {columns} columns; choose one, as in {row} or {column}");
        Err(RecordError::WhichChannel { what })
    }

    /// The only array that can be a channel: a vector that is not called time, or a matrix.
    fn only_candidate(&self) -> Result<&Array, RecordError> {
        let is_time = |array: &Array| Clock::of(leaf(array.name())).is_time;
        let can_be = |array: &&Array| array.matrix().is_some() || (array.is_vector() && !is_time(array));
        let mut candidates = self.arrays.iter().filter(can_be);
        match (candidates.next(), candidates.next()) {
            (Some(array), None) if self.damaged.is_empty() => Ok(array),
            _ if self.arrays.is_empty() => {
                Err(RecordError::WhichChannel { what: format!("the file has {}", self.listing()) })
            }
            _ => Err(RecordError::WhichChannel { what: format!("name the channel; the file has: {}", self.listing()) }),
        }
    }

    /// The array of a channel and its numbers.
    fn numbers(&self, channel: &Slice) -> Result<(&Array, Vec<f64>), RecordError> {
        let array = self.array(&channel.array)?;
        let (name, dimensions) = (array.name(), array.shape().len());
        if dimensions > 2 {
            let what =
                format!("\"{name}\" has {dimensions} dimensions; a record is a vector, or a row or column of a matrix");
            return Err(RecordError::unsupported(what));
        }
        let none = || format!("there is no {}; the array is {array}", channel.written(self.notation));
        let values = array.series(channel.series).ok_or_else(|| RecordError::NoSuchChannel { what: none() })?;
        Ok((array, values))
    }

    /// The scalars that may speak of an array, and their names: those beside it, and beside the structures that it lies
    /// in.
    fn scalars<'a>(&'a self, array: &'a Array) -> impl Iterator<Item = (&'a str, f64)> {
        let speaks = |other: &&Array| {
            let parent = parent(other.name());
            parent.is_empty() || array.name().strip_prefix(parent).is_some_and(|rest| rest.starts_with('.'))
        };
        self.arrays.iter().filter(speaks).filter_map(|other| other.scalar().map(|value| (other.name(), value)))
    }

    /// Time stamps beside the channel: in the first row or column of its matrix, or in a vector of the same length that
    /// is called time, in the same structure.
    fn time_beside(&self, array: &Array, channel: &Slice, length: usize) -> Option<Slice> {
        let first = match channel.series {
            Series::Row(1..) => Some(Series::Row(0)),
            Series::Column(1..) => Some(Series::Column(0)),
            _ => None,
        };
        if let Some(first) = first.filter(|first| array.matrix().is_some() && is_time(array, *first)) {
            return Some(Slice::of(array, first));
        }
        let mut times = self.times(array, length);
        times.find(|time| parent(time.name()) == parent(array.name())).map(|time| Slice::of(time, Series::Whole))
    }

    /// The vectors of that length that are called time.
    fn times<'a>(&'a self, array: &'a Array, length: usize) -> impl Iterator<Item = &'a Array> {
        self.arrays.iter().filter(move |other| {
            Clock::of(leaf(other.name())).is_known_time()
                && other.is_vector()
                && other.values().len() == length
                && other.name() != array.name()
        })
    }
}

/// The name of a field without that of its structure.
pub(super) fn leaf(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}

/// The structure that a field lies in, empty for a variable.
fn parent(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(parent, _)| parent)
}

fn is_uniform(array: &Array, series: Series) -> bool {
    array.series(series).is_some_and(|times| UniformTimes::of(&times).is_ok())
}

/// Whether a series is time by nature: uniform, and no count of samples.
fn is_time(array: &Array, series: Series) -> bool {
    is_uniform(array, series) && !array.series(series).is_some_and(|times| are_whole(&times))
}
