//! Files of every format, behind one door: [`open`].

mod data_file;
mod format;
mod reader;
#[cfg(all(test, feature = "csv", feature = "hdf5", feature = "npy", feature = "uff"))]
mod tests;

use std::path::Path;

pub use data_file::{Channel, DataFile};
pub use format::Format;
#[cfg(feature = "mat")]
pub(crate) use format::is_matlab_4;
pub use reader::Reader;

use crate::RecordError;

/// Opens a file of measured channels, whatever its format and its name are: [`Reader::open`] with nothing said beside it.
///
/// # Errors
/// As [`Reader::open`].
pub fn open(path: impl AsRef<Path>) -> Result<DataFile, RecordError> {
    Reader::default().open(path)
}
