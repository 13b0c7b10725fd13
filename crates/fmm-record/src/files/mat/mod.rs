//! Arrays in MATLAB files, versions 4 to 7.3.
//!
//! Fields of structures count as variables, called as MATLAB calls them: `run.v`, `trial(2).v`. Arrays of other kinds
//! (text, cells, complex or sparse arrays) are not read, but they are listed, as is what cannot be read. HDF5 files of
//! other programs are read as MATLAB shows them, with the order of dimensions reversed.
//!
//! Versions 5 to 7 are read here and not by the crate matfile, which stops at damage without a word, drops unknown
//! arrays, inflates without a limit, and refuses a whole file for one array of 32-bit integers. HDF5 is read by the
//! crate hdf5-pure, behind checks that the file can hold what it promises.

mod element;
#[cfg(feature = "hdf5")]
mod hdf5;
mod numbers;
#[cfg(test)]
mod tests;
mod version_4;

use crate::error::RecordError;
use crate::files::arrays::{ArrayFile, Notation};
use crate::files::format::is_matlab_4;
use crate::files::mat::element::{Variables, byte_order, place};
use crate::files::mat::numbers::take_apart;

#[cfg(feature = "hdf5")]
pub(crate) use hdf5::parse as parse_hdf5;

/// The arrays in the bytes of a file of version 4 to 7. A variable that is damaged by itself is an error only where it
/// is asked for. A file that is cut off exactly between two variables is a valid file with fewer variables.
pub(crate) fn parse(bytes: &[u8]) -> Result<ArrayFile, RecordError> {
    if is_matlab_4(bytes) {
        return version_4::parse(bytes);
    }
    let order = byte_order(bytes)?;
    let mut variables = Variables::new(bytes, order);
    let mut file = ArrayFile::new(Notation::Matlab);
    while let Some((offset, body)) = variables.next()? {
        let taken = body.and_then(|body| take_apart(&body, order, None, 0, &mut file).map_err(RecordError::damaged));
        if let Err(error) = taken {
            file.damaged.push((place(offset), error));
        }
    }
    Ok(file)
}

/// Classes of variables that are not real numeric arrays.
pub(super) mod class {
    pub(crate) const CELL: &str = "a cell array";
    pub(crate) const STRUCTURE: &str = "a structure";
    /// An object, a function or another thing of MATLAB's own.
    pub(crate) const OBJECT: &str = "an object";
    pub(crate) const TEXT: &str = "text";
    pub(crate) const SPARSE: &str = "a sparse matrix";
    pub(crate) const COMPLEX: &str = "complex";

    /// The class by its number; `None` for the numeric classes, 6 to 15.
    pub(crate) fn of(number: u32) -> Option<&'static str> {
        match number {
            1 => Some(CELL),
            2 => Some(STRUCTURE),
            4 => Some(TEXT),
            5 => Some(SPARSE),
            6..=15 => None,
            _ => Some(OBJECT),
        }
    }
}
