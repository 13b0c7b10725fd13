//! The arrays of a file.

use super::{Array, Notation, Slice};
use crate::files::reading::{only, without_unit};
use crate::{Column, RecordError};

/// All real numeric arrays of a file, and what else it holds.
#[derive(Debug, Clone)]
pub(crate) struct ArrayFile {
    pub(crate) notation: Notation,
    /// In the order of the file.
    pub(crate) arrays: Vec<Array>,
    /// Content that was not read: names and kinds.
    pub(crate) others: Vec<(String, String)>,
    /// Content that cannot be read, and the reasons. Without a readable name, the place stands for it, as
    /// `(at byte 128)`.
    pub(crate) damaged: Vec<(String, RecordError)>,
}

impl ArrayFile {
    /// A file in which nothing has been found yet.
    pub(crate) fn new(notation: Notation) -> Self {
        Self { notation, arrays: Vec::new(), others: Vec::new(), damaged: Vec::new() }
    }

    /// Adds an array.
    pub(crate) fn add(&mut self, name: String, shape: Vec<usize>, values: Vec<f64>) {
        self.arrays.push(Array { name, shape, values, notation: self.notation });
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
        Err(RecordError::NoSuchChannel { what: format!("there is no variable \"{name}\"; the file has: {there}") })
    }

    /// Names and sizes of the arrays.
    pub(super) fn names(&self) -> Vec<String> {
        self.arrays.iter().map(ToString::to_string).collect()
    }

    /// Names and sizes of the arrays, for an error that lists them.
    pub(super) fn listing(&self) -> String {
        if self.arrays.is_empty() { "no real numeric arrays".into() } else { self.names().join(", ") }
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
                let written = || offers.iter().map(|offer| offer.written(self.notation)).collect::<Vec<_>>().join(", ");
                let none = || format!("there is no channel {index}; there are, counted from 0: {}", written());
                offers.get(*index).cloned().ok_or_else(|| RecordError::NoSuchChannel { what: none() })
            }
        }
    }
}

#[cfg(test)]
impl ArrayFile {
    /// The record of a channel, with everything else found out by itself.
    pub(crate) fn channel(&self, name: &str) -> Result<crate::Reading, RecordError> {
        self.read(&crate::Reader::default().channel(name))
    }
}
