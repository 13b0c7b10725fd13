//! Why a file of NumPy did not become a record.

use std::io;
use std::path::PathBuf;

use super::Channel;
use crate::RecordError;
use crate::stated::Conflict;

/// A file of NumPy that cannot be read, or that does not hold the record asked for.
///
/// The name of an array is empty where the file is an npy file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NpyError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Something else.
    #[error("not a file of NumPy: {length} bytes that begin neither as npy nor as npz")]
    NotNpy {
        /// Length of the file (bytes).
        length: usize,
    },
    /// An archive that is damaged, or of a kind that cannot be read.
    #[error("the archive cannot be read: {reason}")]
    Archive {
        /// What the decoder says.
        reason: String,
    },
    /// A version of the format that does not exist yet.
    #[error("the array \"{name}\" is of version {version} of the format; known are 1 to 3")]
    Version {
        /// Name of the array.
        name: String,
        /// The version.
        version: u8,
    },
    /// A header that contradicts the format.
    #[error("the header of the array \"{name}\" is damaged: {what}")]
    Header {
        /// Name of the array.
        name: String,
        /// What is wrong with it.
        what: &'static str,
    },
    /// Numbers that are not real, or no numbers.
    #[error("the array \"{name}\" is of type {descr}; real numbers of up to 64 bits are read, but not of 16")]
    Unsupported {
        /// Name of the array.
        name: String,
        /// Its type as NumPy writes it, cut after some characters.
        descr: String,
    },
    /// A file that ends too early.
    #[error("the array \"{name}\" is cut off: it promises {promised} bytes, but {present} are there")]
    Truncated {
        /// Name of the array.
        name: String,
        /// What its header promises (bytes).
        promised: u64,
        /// What is there (bytes).
        present: u64,
    },
    /// Data behind the array.
    #[error("data follow the array \"{name}\"; arrays saved one behind the other are to be saved as npz")]
    Trailing {
        /// Name of the array.
        name: String,
    },
    /// More numbers than the reader agrees to expand.
    #[error("the arrays of the archive expand to more than {limit} bytes")]
    TooLarge {
        /// The limit (bytes), [`MOST_INFLATED`](super::MOST_INFLATED).
        limit: usize,
    },
    /// An array of an archive that is damaged, or stored in a way that cannot be read.
    #[error("the array \"{name}\" cannot be read: {reason}")]
    Damaged {
        /// Its name.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// No array of that name.
    #[error("there is no array \"{name}\"; the file has: {}", list(available))]
    NoSuchArray {
        /// The name asked for.
        name: String,
        /// Names and shapes of the real numeric arrays.
        available: Vec<String>,
    },
    /// Neither a vector nor a matrix.
    #[error("\"{name}\" has {axes} axes; a record is a vector, or a row or column of a matrix")]
    Axes {
        /// Name of the array.
        name: String,
        /// How many axes it has.
        axes: usize,
    },
    /// A matrix of which a row or column must be chosen.
    #[error("\"{name}\" has {rows} rows and {columns} columns; choose one, as in {name}[1] or {name}[:,1]")]
    ChooseSeries {
        /// Name of the array.
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
        /// Name and shape of the array.
        array: String,
    },
    /// No channel was named, and the file does not have exactly one.
    #[error("name the channel; the file has: {}", list(available))]
    ChooseArray {
        /// Names and shapes of the real numeric arrays.
        available: Vec<String>,
    },
    /// Neither the caller nor the file tells the rate.
    #[error("the sampling rate is not known: give a rate or time stamps; the file has: {}", list(available))]
    NoRate {
        /// Names and shapes of the real numeric arrays.
        available: Vec<String>,
    },
    /// Two arrays tell different rates.
    #[error("\"{first}\" says {first_rate} Hz, but \"{second}\" says {second_rate} Hz; give the rate")]
    ConflictingRates {
        /// One array.
        first: String,
        /// The rate that it holds (Hz).
        first_rate: f64,
        /// The other array.
        second: String,
        /// The rate that it holds (Hz).
        second_rate: f64,
    },
    /// Both time stamps and a rate were given.
    #[error("both time stamps and a rate were given; give one of them")]
    TimeAndRate,
    /// The numbers do not make a record.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl NpyError {
    /// The decoder of the archive gave up.
    pub(super) fn damaged(error: &impl std::fmt::Display) -> Self {
        Self::Archive { reason: error.to_string() }
    }

    /// An array of structures.
    pub(super) fn structure(name: &str) -> Self {
        Self::Unsupported { name: name.into(), descr: "[…] (structure)".into() }
    }
}

impl From<Conflict> for NpyError {
    fn from(Conflict { first, first_rate, second, second_rate }: Conflict) -> Self {
        Self::ConflictingRates { first, first_rate, second, second_rate }
    }
}

fn list(available: &[String]) -> String {
    if available.is_empty() { "no real numeric arrays".into() } else { available.join(", ") }
}
