//! Functions in Universal Files: data sets 58, as text and binary (58b), read and written.
//!
//! [`UffFile`] holds every data set 58 of a file: time records, spectra, frequency response functions. Data sets of
//! other numbers (151, 164, 15, …) are passed over and listed. [`DataSet::record`] makes a [`Record`](crate::Record)
//! of a time record, [`DataSet::of_record`] a data set of a record, and [`write()`] a file.
//!
//! Programs that write this format differ, and many err. The points count more than the header:
//! a data set is as long as its number of points and their type make it, whatever its count of bytes; points that a
//! header promises but the file does not have are reported as a [`Warning`].
//!
//! ```
//! use fmm_record::uff::{DataSet, Form, UffFile, write_to};
//! use fmm_record::{Quantity, Record};
//!
//! let record = Record::sampled(512.0, vec![0.0, 0.25, -0.125], Quantity::Velocity, "m/s")?;
//! let mut file = Vec::new();
//! write_to(&mut file, &[DataSet::of_record(&record)], Form::Ascii)?;
//!
//! let file = UffFile::parse(&file)?;
//! // The header says 1.95312E-03 s; 512 Hz is the whole number of hertz that reads so.
//! assert_eq!(file.sets()[0].record()?, record);
//! assert!(file.warnings().is_empty());
//! # Ok::<(), fmm_record::RecordError>(())
//! ```
//!
//! # References
//!
//! Structural Dynamics Research Corporation, Universal Dataset Number 58, *Function at Nodal DOF*; University of
//! Cincinnati, Structural Dynamics Research Laboratory, *The Binary 58 Universal File Format*.

mod ascii;
mod binary;
mod codes;
mod data_set;
mod file;
mod header;
mod lines;
mod number;
mod points;
mod record;
mod records;
#[cfg(test)]
mod tests;
mod warning;
mod writer;

use std::path::Path;

use crate::RecordError;

pub use codes::{DataType, FunctionType};
pub use data_set::{Abscissa, DataSet, Ordinate, Precision};
pub use file::UffFile;
pub use header::{Axis, Freedom, Header};
pub use warning::Warning;
pub use writer::{ByteOrder, Form, write, write_to};

/// Reads all data sets 58 of a file: [`UffFile::read`].
///
/// # Errors
/// As [`UffFile::read`].
pub fn read(path: impl AsRef<Path>) -> Result<UffFile, RecordError> {
    UffFile::read(path)
}
