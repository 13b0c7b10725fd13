//! The arrays of a MATLAB file.

use std::path::Path;

use super::element::{Packed, Variables, endian, place};
use super::numbers::{Content, contents};
use super::{Array, Channel, MatError, MatReader};
use crate::Reading;

/// What a variable is that is not a real numeric array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A cell array.
    Cell,
    /// A structure.
    Structure,
    /// An object, a function or another thing of MATLAB's own.
    Object,
    /// Text.
    Text,
    /// A sparse matrix.
    Sparse,
    /// Complex numbers.
    Complex,
}

impl Kind {
    /// The kind of a class of arrays by its number; none for the numeric classes, 6 to 15.
    pub(super) fn of_class(class: u32) -> Option<Self> {
        match class {
            1 => Some(Self::Cell),
            2 => Some(Self::Structure),
            4 => Some(Self::Text),
            5 => Some(Self::Sparse),
            6..=15 => None,
            _ => Some(Self::Object),
        }
    }
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Cell => "a cell array",
            Self::Structure => "a structure",
            Self::Object => "an object",
            Self::Text => "text",
            Self::Sparse => "a sparse matrix",
            Self::Complex => "complex",
        })
    }
}

/// All real numeric arrays of a MATLAB file, and the names of its other variables. Fields of structures count as variables,
/// called as MATLAB calls them: `run.v`, `trial(2).v`.
#[derive(Debug, Clone, PartialEq)]
pub struct MatFile {
    pub(super) arrays: Vec<Array>,
    pub(super) others: Vec<(String, Kind)>,
    pub(super) damaged: Vec<(String, String)>,
}

impl MatFile {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// [`MatError::Open`], otherwise as [`MatFile::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, MatError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| MatError::Open { path: path.into(), source })?;
        Self::parse(&bytes)
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// [`MatError::NotMat`], the errors of versions ([`MatError::Version4`], [`MatError::Version73`],
    /// [`MatError::UnknownVersion`]) or those of damage to the file as a whole ([`MatError::Truncated`],
    /// [`MatError::UnknownElement`], in version 7.3 [`MatError::Hdf5File`]). A variable that is damaged by itself is an error
    /// only where it is asked for. A file of version 5 to 7 that is cut off exactly between two variables is a valid file
    /// with fewer variables.
    pub fn parse(bytes: &[u8]) -> Result<Self, MatError> {
        let endian = match endian(bytes) {
            #[cfg(feature = "hdf5")]
            Err(MatError::Version73) => return super::hdf5::parse(bytes),
            endian => endian?,
        };
        let mut variables = Variables::new(bytes, endian);
        let mut file = Self { arrays: Vec::new(), others: Vec::new(), damaged: Vec::new() };
        while let Some(variable) = variables.next()? {
            let variable = match variable {
                Ok(variable) => variable,
                Err(Packed { offset, reason }) => {
                    file.damaged.push((place(offset), reason));
                    continue;
                }
            };
            for content in contents(&variable, endian) {
                match content {
                    Content::Real(array) => file.arrays.push(array),
                    Content::Other { name, kind } => file.others.push((name, kind)),
                    Content::Damaged { name, what } => file.damaged.push((name, what.into())),
                }
            }
        }
        Ok(file)
    }

    /// The real numeric arrays, in the order of the file.
    pub fn arrays(&self) -> &[Array] {
        &self.arrays
    }

    /// The variables that were not read, and what they are.
    pub fn others(&self) -> &[(String, Kind)] {
        &self.others
    }

    /// The variables that cannot be read, and why. Where the name cannot be read either, it is the place, as
    /// `(at byte 128)`.
    pub fn damaged(&self) -> &[(String, String)] {
        &self.damaged
    }

    /// Names of the real numeric arrays, in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.arrays.iter().map(Array::name)
    }

    /// The real numeric array called `name`.
    ///
    /// # Errors
    /// [`MatError::NoSuchVariable`], [`MatError::NotNumeric`] or [`MatError::Damaged`].
    pub fn array(&self, name: &str) -> Result<&Array, MatError> {
        if let Some(array) = self.arrays.iter().find(|array| array.name() == name) {
            return Ok(array);
        }
        let (name, mut available) = (name.to_owned(), self.listing());
        if let Some((_, reason)) = self.damaged.iter().find(|(other, _)| *other == name) {
            return Err(MatError::Damaged { name, reason: reason.clone() });
        }
        // It may be one whose name is not known.
        let unnamed = self.damaged.iter().filter(|(place, _)| place.starts_with('('));
        available.extend(unnamed.map(|(place, reason)| format!("one {place} that cannot be read: {reason}")));
        match self.others.iter().find(|(other, _)| *other == name) {
            Some((_, kind)) => Err(MatError::NotNumeric { name, kind: *kind, available }),
            None => Err(MatError::NoSuchVariable { name, available }),
        }
    }

    /// The record of a channel, with everything else found out by itself: [`MatReader::read_from`].
    ///
    /// # Errors
    /// As [`MatReader::read_from`].
    pub fn channel(&self, channel: impl Into<Channel>) -> Result<Reading, MatError> {
        MatReader::default().channel(channel).read_from(self)
    }

    /// Names and sizes of the real numeric arrays.
    pub(super) fn listing(&self) -> Vec<String> {
        self.arrays.iter().map(ToString::to_string).collect()
    }
}
