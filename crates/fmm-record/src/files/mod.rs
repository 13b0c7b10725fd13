//! Files of every format, behind one door: [`open`].

#[cfg(any(feature = "mat", feature = "npy"))]
pub(crate) mod arrays;
pub(crate) mod clock;
mod csv;
mod data_file;
mod format;
#[cfg(feature = "mat")]
mod mat;
#[cfg(feature = "npy")]
mod npy;
mod reader;
pub(crate) mod reading;
pub(crate) mod stated;
#[cfg(all(test, feature = "hdf5", feature = "npy"))]
mod tests;

pub mod uff;

use std::path::Path;

pub use data_file::{Channel, DataFile};
pub use format::Format;
#[cfg(feature = "mat")]
pub(crate) use format::is_matlab_4;
pub use reader::Reader;

use crate::RecordError;

/// Opens a file of measured channels, whatever its format and its name are: [`Reader::open`] with nothing said beside
/// it.
///
/// # Errors
/// As [`Reader::open`].
pub fn open(path: impl AsRef<Path>) -> Result<DataFile, RecordError> {
    Reader::default().open(path)
}
