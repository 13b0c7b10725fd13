//! Records from files of NumPy: npy, a single array, and npz, an archive of several.
//!
//! [`NpyFile`] holds every real numeric array of a file; [`NpyReader`] makes a record of one of them. Arrays of other
//! types (complex numbers, text, structures, Python objects) are not read, but those of an archive are listed.
//!
//! ```
//! use fmm_record::npy::NpyFile;
//!
//! // numpy.save(…, [[0, 0.5, 1], [3, 4, 5]])
//! let mut file = b"\x93NUMPY\x01\x00\x46\x00{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }".to_vec();
//! file.resize(79, b' ');
//! file.push(b'\n');
//! file.extend([0.0f64, 0.5, 1.0, 3.0, 4.0, 5.0].iter().flat_map(|x| x.to_le_bytes()));
//!
//! let reading = NpyFile::parse(&file)?.channel("[1]")?;
//! assert_eq!((reading.record.values(), reading.record.rate()), (&[3.0, 4.0, 5.0][..], 2.0));
//! assert_eq!(reading.sampling.to_string(), "found from the time stamps in \"[0]\"");
//! # Ok::<(), fmm_record::npy::NpyError>(())
//! ```

mod array;
mod channel;
mod error;
mod file;
mod header;
mod reader;
#[cfg(test)]
mod tests;

use std::path::Path;

pub use array::NpyArray;
pub use channel::{Channel, Series};
pub use error::NpyError;
pub use file::NpyFile;
pub use reader::NpyReader;

pub use crate::reading::MOST_INFLATED;

/// Reads all real numeric arrays of a file: [`NpyFile::read`].
///
/// # Errors
/// As [`NpyFile::read`].
pub fn read(path: impl AsRef<Path>) -> Result<NpyFile, NpyError> {
    NpyFile::read(path)
}
