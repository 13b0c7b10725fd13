//! Why a MATLAB file did not become a record.

use std::io;
use std::path::PathBuf;

use super::{Channel, Kind};
use crate::RecordError;
use crate::stated::Conflict;

/// A MATLAB file that cannot be read, or that does not hold the record asked for. What is wrong with a variable of a file
/// that can be read is [`MatError::Damaged`] where the variable is asked for, and in [`MatFile::damaged`](super::MatFile::damaged).
///
/// Byte positions count from the begin of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MatError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Something else.
    #[error("not a MATLAB file: {length} bytes without the header of one")]
    NotMat {
        /// Length of the file (bytes).
        length: usize,
    },
    /// MATLAB version 4.
    #[error("a MATLAB version 4 file; load it in MATLAB and save it with -v7")]
    Version4,
    /// MATLAB version 7.3, which is HDF5, without the feature `hdf5`.
    #[error("a MATLAB version 7.3 file (HDF5); load it in MATLAB and save it with -v7")]
    Version73,
    /// A MATLAB file of a version that does not exist yet.
    #[error("a MATLAB file of unknown version {version:#06x}; save it with -v7")]
    UnknownVersion {
        /// The number in the header, 0x0100 for versions 5 to 7.
        version: u16,
    },
    /// A file that ends too early.
    #[error("the file is cut off: the variable at byte {offset} promises {promised} bytes, but {present} are there")]
    Truncated {
        /// Where the variable begins.
        offset: usize,
        /// Its length as its header says (bytes).
        promised: u64,
        /// What is left of the file there (bytes).
        present: u64,
    },
    /// A variable that is neither an array nor a compressed array.
    #[error(
        "the variable at byte {offset} is of type {code}, which is neither an array (14) nor a compressed one (15)"
    )]
    UnknownElement {
        /// Where the variable begins.
        offset: usize,
        /// The number of its type.
        code: u32,
    },
    /// Compressed data that cannot be expanded.
    #[error("the compressed variable at byte {offset} is damaged: {reason}")]
    Compression {
        /// Where the variable begins.
        offset: usize,
        /// What the decoder says.
        reason: String,
    },
    /// More data than the reader agrees to expand.
    #[error("the variables of the file expand to more than {limit} bytes")]
    TooLarge {
        /// The limit (bytes), [`MOST_INFLATED`](super::MOST_INFLATED).
        limit: usize,
    },
    /// An HDF5 file that is damaged, or of a kind that cannot be read.
    #[error("the version 7.3 file (HDF5) cannot be read: {reason}")]
    Hdf5File {
        /// What the decoder says.
        reason: String,
    },
    /// A variable that is damaged, or stored in a way that cannot be read.
    #[error("the variable \"{name}\" cannot be read: {reason}")]
    Damaged {
        /// Its name.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// No variable of that name.
    #[error("there is no variable \"{name}\"; the file has: {}", list(available))]
    NoSuchVariable {
        /// The name asked for.
        name: String,
        /// Names and sizes of the numeric arrays.
        available: Vec<String>,
    },
    /// A variable that is no real numeric array.
    #[error("the variable \"{name}\" is {kind}, not a real numeric array; the file has: {}", list(available))]
    NotNumeric {
        /// The name asked for.
        name: String,
        /// What it is.
        kind: Kind,
        /// Names and sizes of the numeric arrays.
        available: Vec<String>,
    },
    /// An array of more than two dimensions.
    #[error("\"{name}\" has {dimensions} dimensions; a record is a vector, or a row or column of a matrix")]
    Dimensions {
        /// Its name.
        name: String,
        /// How many dimensions it has.
        dimensions: usize,
    },
    /// A matrix of which a row or column must be chosen.
    #[error(
        "\"{name}\" is a matrix of {rows} rows and {columns} columns; choose one, as in {name}(1,:) or {name}(:,1)"
    )]
    ChooseSeries {
        /// Its name.
        name: String,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// A row or column that the array does not have.
    #[error("there is no {channel}; the array is {array}")]
    NoSuchSeries {
        /// What was asked for.
        channel: Channel,
        /// Name and size of the array.
        array: String,
    },
    /// No channel was named, and the file does not have exactly one.
    #[error("name the channel; the file has: {}", list(available))]
    ChooseVariable {
        /// Names and sizes of the numeric arrays.
        available: Vec<String>,
    },
    /// Neither the caller nor the file tells the rate.
    #[error(
        "the sampling rate is not known: give a rate or a variable of time stamps; the file has: {}",
        list(available)
    )]
    NoRate {
        /// Names and sizes of the numeric arrays.
        available: Vec<String>,
    },
    /// Two variables tell different rates.
    #[error("\"{first}\" says {first_rate} Hz, but \"{second}\" says {second_rate} Hz; give the rate")]
    ConflictingRates {
        /// One variable.
        first: String,
        /// The rate that it holds (Hz).
        first_rate: f64,
        /// The other variable.
        second: String,
        /// The rate that it holds (Hz).
        second_rate: f64,
    },
    /// Both time stamps and a rate were given.
    #[error("both a variable of time stamps and a rate were given; give one of them")]
    TimeAndRate,
    /// The numbers do not make a record.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl From<Conflict> for MatError {
    fn from(Conflict { first, first_rate, second, second_rate }: Conflict) -> Self {
        Self::ConflictingRates { first, first_rate, second, second_rate }
    }
}

fn list(available: &[String]) -> String {
    if available.is_empty() { "no numeric arrays".into() } else { available.join(", ") }
}
