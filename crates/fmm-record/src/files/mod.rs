//! Files of every format, behind one door: [`open`].

#[cfg(any(feature = "mat", feature = "npy"))]
pub(crate) mod arrays;
#[cfg(any(feature = "csv", feature = "mat", feature = "npy"))]
pub(crate) mod clock;
#[cfg(feature = "csv")]
mod csv;
mod data_file;
mod format;
#[cfg(feature = "mat")]
mod mat;
#[cfg(feature = "npy")]
mod npy;
mod reader;
pub(crate) mod reading;
#[cfg(any(feature = "csv", feature = "mat", feature = "npy"))]
pub(crate) mod stated;
#[cfg(all(test, feature = "csv", feature = "hdf5", feature = "npy", feature = "uff"))]
mod tests;

#[cfg(feature = "uff")]
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
