//! Arrays in MATLAB files, versions 5 to 7.3.
//!
//! Fields of structures count as variables, called as MATLAB calls them: `run.v`, `trial(2).v`. Arrays of other kinds
//! (text, cells, complex or sparse arrays) are not read, but they are listed, as is what cannot be read. HDF5 files of
//! other programs are read as MATLAB shows them, with the order of dimensions reversed.
//!
//! Numbers are decoded by the crate matfile. It is handed one array at a time, whose structure has been checked
//! here: by itself it stops at damage without a word, drops what it does not know, and refuses a whole file for one
//! array of 32-bit integers. HDF5 is read by the crate hdf5-pure, behind checks that the file can hold what it
//! promises.

mod element;
#[cfg(feature = "hdf5")]
mod hdf5;
mod kind;
mod numbers;
#[cfg(test)]
mod tests;
#[cfg(all(test, feature = "hdf5"))]
mod tests_hdf5;

use crate::RecordError;
use crate::files::arrays::{ArrayFile, Notation};
use element::{Variables, endian, place};
#[cfg(feature = "hdf5")]
pub(crate) use hdf5::parse as parse_hdf5;
use kind::Kind;
use numbers::add;

/// The arrays in the bytes of a file of version 5 to 7. A variable that is damaged by itself is an error only where it
/// is asked for. A file that is cut off exactly between two variables is a valid file with fewer variables.
pub(crate) fn parse(bytes: &[u8]) -> Result<ArrayFile, RecordError> {
    let endian = endian(bytes)?;
    let mut variables = Variables::new(bytes, endian);
    let mut file = ArrayFile::new(Notation::Matlab);
    while let Some((offset, body)) = variables.next()? {
        match body {
            Ok(body) => add(&mut file, offset, &body, endian),
            Err(error) => file.damaged.push((place(offset), error)),
        }
    }
    Ok(file)
}
