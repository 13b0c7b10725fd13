//! Error of files, records and options.

use std::error::Error;
use std::io;
use std::sync::Arc;

/// A file that is not read, a record that cannot exist, or an operation that it does not allow. The variants are
/// categories to act on.
///
/// Lines and byte positions count as in an editor: lines from 1, bytes from 0.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The system refuses to open, read or write a file: check the path.
    #[error("cannot {what}: {source}")]
    Io {
        /// The operation that failed, with the path if it is known.
        what: String,
        /// Error of the operating system.
        source: Arc<io::Error>,
    },
    /// A file of another format than was asked for, or of none that is read: convert it, or choose another.
    #[error("{what}")]
    UnknownFormat {
        /// Content that was found, and formats that are read.
        what: String,
    },
    /// A file of a format whose reader was not compiled: add the feature.
    #[error("{what}")]
    MissingFeature {
        /// The format of the file, and the feature that reads it.
        what: String,
    },
    /// A file, or a variable of one, that contradicts itself or its format: repair it, or leave the variable alone.
    #[error("{what}")]
    Damaged {
        /// The line, in text and Universal Files.
        line: Option<u64>,
        /// Part of the file, and its fault.
        what: String,
        /// Error of the decoder, if there is one.
        source: Option<Arc<dyn Error + Send + Sync>>,
    },
    /// Something that is as it should be, but is not read, written or computed: save or choose it in another form.
    #[error("{what}")]
    Unsupported {
        /// Content that was found, and content that is supported.
        what: String,
    },
    /// The file does not have the channel, or has several that may be meant: choose one that it has.
    #[error("{what}")]
    Channel {
        /// Channel that was asked for, and those that exist.
        what: String,
    },
    /// The sampling is not known or not uniform: give the rate, name the time, or resample.
    #[error("{what}")]
    TimeAxis {
        /// Index of the first time stamp that is wrong.
        index: Option<usize>,
        /// Fault, and what would be right.
        what: String,
    },
    /// Channel, quantity or unit are not clear: state them by a [`Request`](crate::Request).
    #[error("{what}")]
    Unclear {
        /// The channel, and the missing statement.
        what: String,
        /// The statements of a request that help, their names between backquotes: "give `unit`, such as m/s".
        remedy: String,
    },
    /// Two statements about quantity or unit exclude each other, of the file or of a [`Request`](crate::Request): take
    /// one back, or choose another channel.
    #[error("{what}")]
    Contradiction {
        /// Both statements.
        what: String,
        /// The statements of a request that help, their names between backquotes: "leave out `unit` m/s".
        remedy: String,
    },
    /// Values that are missing, infinite or too large: look at the data.
    #[error("{what}")]
    Values {
        /// Index of the first of them.
        index: usize,
        /// Number of values, and their fault.
        what: String,
    },
    /// Too few samples for the operation: take a longer record.
    #[error("{operation} needs at least {needed} samples, but the record has {length}")]
    TooShort {
        /// Operation that was asked for.
        operation: &'static str,
        /// Number of samples that the operation needs.
        needed: usize,
        /// Number of samples of the record.
        length: usize,
    },
    /// An option, or a pair of them, that cannot be: give another.
    #[error("{what}")]
    Options {
        /// The option with its value, and what would be right.
        what: String,
    },
}

impl RecordError {
    /// Error of the time axis, with its fault.
    pub(crate) fn time(index: Option<usize>, what: String) -> Self {
        Self::TimeAxis { index, what }
    }

    /// A time stamp (s) that repeats its predecessor or precedes it.
    pub(crate) fn not_increasing(index: usize, time: f64, previous: f64) -> Self {
        let what = format!("time must increase, but time stamp {index} is {time} s after {previous} s");
        Self::time(Some(index), what)
    }

    /// A sampling interval (s) that is zero, negative or not finite.
    pub(crate) fn interval(interval: f64) -> Self {
        Self::options(format!("the sampling interval must be positive and finite, but is {interval} s"))
    }

    /// A channel that is not there, or is not the only one.
    pub(crate) fn channel(what: impl Into<String>) -> Self {
        Self::Channel { what: what.into() }
    }

    /// Channel, quantity or unit that are not clear.
    pub(crate) fn unclear(what: String, remedy: impl Into<String>) -> Self {
        Self::Unclear { what, remedy: remedy.into() }
    }

    /// Statements about quantity or unit that exclude each other.
    pub(crate) fn contradiction(what: String, remedy: String) -> Self {
        Self::Contradiction { what, remedy }
    }

    /// An option that cannot be.
    pub(crate) fn options(what: impl Into<String>) -> Self {
        Self::Options { what: what.into() }
    }

    /// Error of content that is not read, written or computed.
    pub(crate) fn unsupported(what: impl Into<String>) -> Self {
        Self::Unsupported { what: what.into() }
    }

    /// A file that the system does not open, read or create.
    pub(crate) fn io(verb: &str, path: &std::path::Path, source: io::Error) -> Self {
        Self::Io { what: format!("{verb} {}", path.display()), source: Arc::new(source) }
    }

    /// Error of a damaged file, or of a part of it.
    pub(crate) fn damaged(what: impl Into<String>) -> Self {
        Self::Damaged { line: None, what: what.into(), source: None }
    }

    /// Error of a line of text.
    pub(crate) fn on_line(line: u64, what: String) -> Self {
        Self::Damaged { line: Some(line), what, source: None }
    }

    /// Error of a decoder, with the part of the file.
    #[cfg(any(feature = "mat", feature = "npy", feature = "gzip", feature = "workbook", feature = "wav"))]
    pub(crate) fn undecoded(what: &str, source: impl Error + Send + Sync + 'static) -> Self {
        Self::Damaged { line: None, what: format!("{what}: {source}"), source: Some(Arc::new(source)) }
    }
}

/// Names in the sentence of an error at most, by judgement: a screen of them, and not a page.
const MOST_NAMES: usize = 12;

/// Names for an error that lists them, the first of many with the number of the others.
pub(crate) fn listed(names: &[String]) -> String {
    match names.len().checked_sub(MOST_NAMES) {
        Some(others @ 1..) => format!("{} and {others} more", names[..MOST_NAMES].join(", ")),
        _ => names.join(", "),
    }
}

/// True for an error whose message has `text`.
#[cfg(test)]
pub(crate) fn says<T>(result: &Result<T, RecordError>, text: &str) -> bool {
    result.as_ref().is_err_and(|error| error.to_string().contains(text))
}
