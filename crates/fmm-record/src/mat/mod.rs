//! Records from MATLAB files, versions 5 to 7.3.
//!
//! [`MatFile`] holds every real numeric array of a file, fields of structures among them; [`MatReader`] makes a record of
//! one of them. Arrays of other kinds (text, cells, complex or sparse arrays) are not read, but they are listed, as is what
//! cannot be read, and asking for one says what it is. Version 7.3, which is HDF5, needs the feature `hdf5`; without it, it is told apart and refused,
//! as version 4 is. HDF5 files of other programs are read as MATLAB shows them, with the order of dimensions reversed.
//!
//! ```no_run
//! let reading = fmm_record::mat::read("fork.mat")?.channel("data")?;
//! println!("{}: the rate was {}", reading.channel, reading.sampling);
//! # Ok::<(), fmm_record::mat::MatError>(())
//! ```
//!
//! Numbers are decoded by the crate matfile. It is handed one array at a time, whose structure has been checked
//! here: by itself it stops at damage without a word, drops what it does not know, and refuses a whole file for one
//! array of 32-bit integers. HDF5 is read by the crate hdf5-pure, behind checks that the file can hold what it promises.

mod array;
mod channel;
mod element;
mod error;
mod file;
#[cfg(feature = "hdf5")]
mod hdf5;
mod numbers;
mod reader;
#[cfg(test)]
mod tests;
#[cfg(all(test, feature = "hdf5"))]
mod tests_hdf5;

use std::path::Path;

pub use array::Array;
pub use channel::Channel;
pub use error::MatError;
pub use file::{Kind, MatFile};
pub use reader::MatReader;

pub use crate::reading::MOST_INFLATED;

/// Reads all real numeric arrays of a file: [`MatFile::read`].
///
/// # Errors
/// As [`MatFile::read`].
pub fn read(path: impl AsRef<Path>) -> Result<MatFile, MatError> {
    MatFile::read(path)
}
