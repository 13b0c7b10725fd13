//! Arrays of a file, and the record of one of their series.

use crate::error::{RecordError, listed};
use crate::files::Reader;
use crate::files::arrays::{Array, Notation, Series, Slice};
use crate::files::clock::{Clock, are_whole};
#[cfg(feature = "hdf5")]
use crate::files::rate::is_rate;
use crate::files::rate::stated;
use crate::files::reading::{Column, Reading, only, without_unit};
use crate::sampling::{Sampling, uniform_grid};

/// All real numeric arrays of a file, and what else it holds.
#[derive(Debug, Clone)]
pub(crate) struct ArrayFile {
    pub(crate) notation: Notation,
    /// Arrays in the order of the file.
    pub(crate) arrays: Vec<Array>,
    /// Short texts beside the arrays, by their paths: attributes and variables that may be units.
    pub(crate) texts: Vec<(String, String)>,
    /// Content that was not read: names and kinds.
    pub(crate) others: Vec<(String, String)>,
    /// Content that cannot be read, and the reasons. Without a readable name, the place stands for it, as
    /// `(at byte 128)`.
    pub(crate) damaged: Vec<(String, RecordError)>,
}

impl ArrayFile {
    /// A file in which nothing has been found yet.
    pub(crate) fn new(notation: Notation) -> Self {
        Self { notation, arrays: Vec::new(), texts: Vec::new(), others: Vec::new(), damaged: Vec::new() }
    }

    /// Adds an array.
    pub(crate) fn add(&mut self, name: String, shape: Vec<usize>, values: Vec<f64>) {
        self.arrays.push(Array { name, shape, values, notation: self.notation });
    }

    /// Adds a statement beside the arrays: a text that may be a unit, or a number that may be a rate.
    #[cfg(feature = "hdf5")]
    pub(crate) fn state(&mut self, path: String, text: Option<&str>, number: Option<f64>) {
        match (text, number) {
            (Some(text), _) => self.texts.push((path, text.to_owned())),
            (None, Some(number)) if is_rate(leaf(&path)) => self.add(path, vec![1, 1], vec![number]),
            _ => {}
        }
    }

    /// The unit that a text beside the array called `name` states: an attribute of it, `name_unit`, or what is called a
    /// unit in its structure, as in `y_values.quantity.label` of Testlab; empty if there is none.
    pub(crate) fn unit(&self, name: &str) -> &str {
        if Clock::of(leaf(name)).is_time {
            return "";
        }
        let within =
            |key: &str| if parent(name).is_empty() { key.to_owned() } else { format!("{}.{key}", parent(name)) };
        let own = ["unit", "units"].map(|key| [format!("{name}.{key}"), format!("{name}_{key}")]);
        let around = ["unit", "units", "quantity.label"].map(within);
        let path = |path: &String| self.texts.iter().find(|(other, _)| other.eq_ignore_ascii_case(path));
        own.iter().flatten().chain(&around).find_map(path).map_or("", |(_, text)| text.trim())
    }

    /// The array called `name`, with or without its unit.
    pub(crate) fn array(&self, name: &str) -> Result<&Array, RecordError> {
        if let Some(array) = self.arrays.iter().find(|array| array.name() == name) {
            return Ok(array);
        }
        if let Some((_, reason)) = self.damaged.iter().find(|(other, _)| *other == name) {
            let what = format!("the variable \"{name}\" cannot be read: {reason}");
            let source = Some(std::sync::Arc::new(reason.clone()) as _);
            return Err(RecordError::Damaged { line: None, what, source });
        }
        if let Some((_, other)) = self.others.iter().find(|(other, _)| *other == name) {
            let there = self.listing();
            let what = format!("the variable \"{name}\" is {other}, not a real numeric array; the file has: {there}");
            return Err(RecordError::unsupported(what));
        }
        let names: Vec<String> = self.arrays.iter().map(|array| array.name().to_owned()).collect();
        let bare: Vec<usize> = (0..names.len()).filter(|index| without_unit(&names[*index]) == name).collect();
        if !bare.is_empty() {
            return only(&bare, &Column::from(name), "variable", &names).map(|index| &self.arrays[index]);
        }
        // It may be one whose name is not known.
        let unnamed = self.damaged.iter().filter(|(place, _)| place.starts_with('('));
        let unnamed = unnamed.map(|(place, reason)| format!(", one {place} that cannot be read: {reason}"));
        let there = self.listing() + &unnamed.collect::<String>();
        Err(RecordError::channel(format!("there is no variable \"{name}\"; the file has: {there}")))
    }

    /// Names and sizes of the arrays.
    pub(super) fn names(&self) -> Vec<String> {
        self.arrays.iter().map(ToString::to_string).collect()
    }

    /// Names and sizes of the arrays, for an error that lists them.
    pub(super) fn listing(&self) -> String {
        if self.arrays.is_empty() { "no real numeric arrays".into() } else { listed(&self.names()) }
    }

    /// All series that may be channels or their times, in the order of the file.
    pub(crate) fn offers(&self) -> Vec<Slice> {
        let offers =
            |array: &Array| array.offers().into_iter().map(|series| Slice::of(array, series)).collect::<Vec<_>>();
        self.arrays.iter().flat_map(offers).collect()
    }

    /// The series that a caller means: by name, or by its position among [`ArrayFile::offers`].
    pub(super) fn slice(&self, column: &Column) -> Result<Slice, RecordError> {
        match column {
            Column::Name(name) => {
                let slice = Slice::parse(name, self.notation);
                Ok(Slice { array: self.array(&slice.array)?.name().to_owned(), ..slice })
            }
            Column::Index(index) => {
                let offers = self.offers();
                let written = || listed(&offers.iter().map(|offer| offer.written(self.notation)).collect::<Vec<_>>());
                let none = || format!("there is no channel {index}; there are, counted from 0: {}", written());
                offers.get(*index).cloned().ok_or_else(|| RecordError::channel(none()))
            }
        }
    }

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
        let remarks: Vec<String> = reader.span.lacking(&values).into_iter().collect();
        let (record, sampling) = if let Some(rate) = reader.rate {
            (reader.span.sampled(rate, values)?, Sampling::Given { rate })
        } else if let Some(time) = &time {
            let mut times = self.numbers(time)?.1;
            let name = time.written(self.notation);
            // The name of a matrix is not that of its first series.
            let clock = if time.series == Series::Whole { Clock::of(leaf(&time.array)) } else { Clock::nameless() };
            let sampling = clock.in_unit(reader.time_unit.as_deref()).to_seconds(&name, false, &mut times)?;
            (reader.span.timed(&times, values)?, sampling)
        } else if let Some((rate, sampling)) = stated(self.scalars(array))? {
            (reader.span.sampled(rate, values)?, sampling)
        } else {
            let there = self.listing();
            return Err(RecordError::time(
                None,
                format!("the sampling rate is not known: give a rate or time stamps; the file has: {there}"),
            ));
        };
        let time = time.map(|time| time.written(self.notation));
        let record = record.with_unit(self.unit(array.name()));
        Ok(Reading { record, channel: channel.written(self.notation), time, columns: self.names(), sampling, remarks })
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
        Err(RecordError::channel(what))
    }

    /// The only array that can be a channel: a vector that is not called time, or a matrix.
    fn only_candidate(&self) -> Result<&Array, RecordError> {
        let is_time = |array: &Array| Clock::of(leaf(array.name())).is_time;
        let can_be = |array: &&Array| array.matrix().is_some() || (array.is_vector() && !is_time(array));
        let mut candidates = self.arrays.iter().filter(can_be);
        match (candidates.next(), candidates.next()) {
            (Some(array), None) if self.damaged.is_empty() => Ok(array),
            _ if self.arrays.is_empty() => Err(RecordError::channel(format!("the file has {}", self.listing()))),
            _ => Err(RecordError::channel(format!("name the channel; the file has: {}", self.listing()))),
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
        let values = array.series(channel.series).ok_or_else(|| RecordError::channel(none()))?;
        Ok((array, values))
    }

    /// The scalars that may speak of an array, and their names: those beside it, and beside the structures that it lies
    /// in.
    fn scalars<'a>(&'a self, array: &'a Array) -> impl Iterator<Item = (&'a str, f64)> {
        let speaks = |other: &&Array| {
            let parent = parent(other.name());
            // Testlab has the increment in a structure beside that of the values.
            let parent = parent.strip_suffix("x_values").map_or(parent, |rest| rest.trim_end_matches('.'));
            let is_around = |rest: &str| rest.is_empty() || rest.starts_with('.');
            parent.is_empty() || array.name().strip_prefix(parent).is_some_and(is_around)
        };
        self.arrays
            .iter()
            .filter(speaks)
            .filter_map(|other| if let [value] = other.values[..] { Some((other.name(), value)) } else { None })
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

#[cfg(test)]
impl ArrayFile {
    /// The record of a channel, with everything else found out by itself.
    pub(crate) fn channel(&self, name: &str) -> Result<crate::files::reading::Reading, RecordError> {
        self.read(&crate::files::Reader::default().channel(name))
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
    array.series(series).is_some_and(|times| uniform_grid(&times).is_ok())
}

/// True for a series that is time by nature: uniform, and no count of samples.
fn is_time(array: &Array, series: Series) -> bool {
    is_uniform(array, series) && !array.series(series).is_some_and(|times| are_whole(&times))
}
