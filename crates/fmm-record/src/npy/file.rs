//! The arrays of a file.

use std::io::{Cursor, Read};
use std::path::Path;

use zip::ZipArchive;

use super::header::{self, Header, MAGIC};
use super::{Channel, MOST_INFLATED, NpyArray, NpyError, NpyReader};
use crate::Reading;

/// All real numeric arrays of an npy or npz file, and the names of what else an archive holds.
#[derive(Debug, Clone, PartialEq)]
pub struct NpyFile {
    arrays: Vec<NpyArray>,
    others: Vec<(String, String)>,
    damaged: Vec<(String, String)>,
}

impl NpyFile {
    /// Reads the file at `path`, whatever its name ends with.
    ///
    /// # Errors
    /// [`NpyError::Open`], otherwise as [`NpyFile::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, NpyError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| NpyError::Open { path: path.into(), source })?;
        Self::parse(&bytes)
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// [`NpyError::NotNpy`]; for an archive [`NpyError::Archive`]; for an npy file [`NpyError::Version`],
    /// [`NpyError::Header`], [`NpyError::Truncated`], [`NpyError::Trailing`], [`NpyError::Unsupported`]. An array of an archive
    /// that cannot be read is an error only where it is asked for.
    pub fn parse(bytes: &[u8]) -> Result<Self, NpyError> {
        if bytes.starts_with(MAGIC) {
            // What is there cannot be too much.
            let array = array(bytes, String::new(), &mut { usize::MAX })?;
            return Ok(Self { arrays: vec![array], others: Vec::new(), damaged: Vec::new() });
        }
        if !bytes.starts_with(b"PK") {
            return Err(NpyError::NotNpy { length: bytes.len() });
        }
        let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| NpyError::damaged(&error))?;
        let mut file = Self { arrays: Vec::new(), others: Vec::new(), damaged: Vec::new() };
        let mut budget = MOST_INFLATED / size_of::<f64>();
        for index in 0..archive.len() {
            let name = match archive.name_for_index(index) {
                Some(name) => name.map_err(|error| NpyError::damaged(&error))?.into_owned(),
                None => continue,
            };
            let Some(name) = name.strip_suffix(".npy") else {
                file.others.push((name, "no array".into()));
                continue;
            };
            let entry = archive.by_index(index).map_err(|error| NpyError::damaged(&error));
            match entry.and_then(|entry| array(entry, name.to_owned(), &mut budget)) {
                Ok(array) => file.arrays.push(array),
                Err(NpyError::Unsupported { name, descr }) => file.others.push((name, descr)),
                Err(error) => file.damaged.push((name.to_owned(), error.to_string())),
            }
        }
        Ok(file)
    }

    /// The real numeric arrays, in the order of the file.
    pub fn arrays(&self) -> &[NpyArray] {
        &self.arrays
    }

    /// What else the archive holds, and of what type it is.
    pub fn others(&self) -> &[(String, String)] {
        &self.others
    }

    /// The arrays that cannot be read, and why.
    pub fn damaged(&self) -> &[(String, String)] {
        &self.damaged
    }

    /// Names of the real numeric arrays, in the order of the file; that of an npy file is empty.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.arrays.iter().map(NpyArray::name)
    }

    /// The real numeric array called `name`.
    ///
    /// # Errors
    /// [`NpyError::NoSuchArray`], [`NpyError::Unsupported`] if it is of another type, or [`NpyError::Damaged`].
    pub fn array(&self, name: &str) -> Result<&NpyArray, NpyError> {
        if let Some(array) = self.arrays.iter().find(|array| array.name() == name) {
            return Ok(array);
        }
        let (name, available) = (name.to_owned(), self.listing());
        if let Some((_, reason)) = self.damaged.iter().find(|(other, _)| *other == name) {
            return Err(NpyError::Damaged { name, reason: reason.clone() });
        }
        match self.others.iter().find(|(other, _)| *other == name) {
            Some((_, descr)) => Err(NpyError::Unsupported { name, descr: descr.clone() }),
            None => Err(NpyError::NoSuchArray { name, available }),
        }
    }

    /// The record of a channel, with everything else found out by itself: [`NpyReader::read_from`].
    ///
    /// # Errors
    /// As [`NpyReader::read_from`].
    pub fn channel(&self, channel: impl Into<Channel>) -> Result<Reading, NpyError> {
        NpyReader::default().channel(channel).read_from(self)
    }

    /// Names and shapes of the real numeric arrays.
    pub(super) fn listing(&self) -> Vec<String> {
        self.arrays.iter().map(ToString::to_string).collect()
    }
}

/// Reads an array, and takes its numbers off the budget before any of them is read.
fn array(mut input: impl Read, name: String, budget: &mut usize) -> Result<NpyArray, NpyError> {
    let header = header::read(&mut input, &name)?;
    let Header { number, count, .. } = header;
    if count > *budget {
        return Err(NpyError::TooLarge { limit: MOST_INFLATED });
    }
    *budget -= count;
    let promised = (count * number.width) as u64;
    let mut bytes = Vec::new();
    input.by_ref().take(promised).read_to_end(&mut bytes).map_err(|error| NpyError::damaged(&error))?;
    if (bytes.len() as u64) < promised {
        return Err(NpyError::Truncated { name, promised, present: bytes.len() as u64 });
    }
    // An archive compares its checksum when the end is reached.
    if input.read(&mut [0]).map_err(|error| NpyError::damaged(&error))? > 0 {
        return Err(NpyError::Trailing { name });
    }
    let values: Vec<f64> = bytes.chunks_exact(number.width).map(|bytes| number.value(bytes)).collect();
    let values = if header.fortran { row_after_row(&values, &header.shape) } else { values };
    Ok(NpyArray { name, shape: header.shape, values })
}

/// Numbers of which the first axis varies first, in the order in which the last one does.
fn row_after_row(values: &[f64], shape: &[usize]) -> Vec<f64> {
    let strides: Vec<usize> = shape
        .iter()
        .scan(1usize, |stride, length| {
            let own = *stride;
            *stride = stride.saturating_mul(*length);
            Some(own)
        })
        .collect();
    let mut at = vec![0; shape.len()];
    let mut offset = 0;
    (0..values.len())
        .map(|_| {
            let value = values[offset];
            for axis in (0..shape.len()).rev() {
                at[axis] += 1;
                offset += strides[axis];
                if at[axis] < shape[axis] {
                    break;
                }
                offset -= strides[axis] * shape[axis];
                at[axis] = 0;
            }
            value
        })
        .collect()
}
