//! Why a Universal File was not read, not written, or did not become a record.

use std::io;
use std::path::PathBuf;

use super::{FunctionType, Warning};
use crate::reading::quoted;
use crate::{Column, RecordError};

/// A Universal File that cannot be read or written, or that does not hold the record asked for.
///
/// Lines count from 1, as in an editor.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UffError {
    /// The file cannot be opened, read or created.
    #[error("cannot open {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Writing stopped half way.
    #[error("cannot write on: {source}")]
    Write {
        /// What the system says.
        #[from]
        source: io::Error,
    },
    /// No data set of any number.
    #[error("not a Universal File: {length} bytes without a data set between lines of -1")]
    NotUff {
        /// Length of the file (bytes).
        length: usize,
    },
    /// Data sets, but none of number 58 with points.
    #[error("the file has no data set 58 with points, {}", instead(others, warnings))]
    NoFunction {
        /// What the data sets that it has are called, each once, in the order of the file.
        others: Vec<String>,
        /// What is wrong with the data sets 58 that it has.
        warnings: Vec<Warning>,
    },
    /// A line of a header that contradicts the format.
    #[error("line {line}: {what}, but the line is \"{text}\"")]
    Header {
        /// The line.
        line: u64,
        /// What the format wants there.
        what: &'static str,
        /// The line, cut after some characters.
        text: String,
    },
    /// Binary numbers that are not those of IEEE 754.
    #[error("line {line}: binary numbers of format {format} (1: VMS, 3: IBM) are not supported, only IEEE 754 (2)")]
    FloatFormat {
        /// The line.
        line: u64,
        /// The number of the format.
        format: u64,
    },
    /// Text among the numbers of a data set.
    #[error("line {line}: \"{text}\" is not a number")]
    NotANumber {
        /// The line.
        line: u64,
        /// The text, cut after some characters.
        text: String,
    },
    /// Binary points with an uneven abscissa, which programs write in two ways.
    #[error(
        "the binary data set at line {line} ends neither as if its abscissae were single nor as if they were double \
         numbers, and they increase neither way"
    )]
    AbscissaWidth {
        /// Where the data set begins.
        line: u64,
    },
    /// A data set without points.
    #[error("a data set needs at least one point, but none were given")]
    NoPoints,
    /// As many abscissae as ordinates are needed.
    #[error("{abscissa} abscissae were given for {ordinate} ordinates")]
    LengthMismatch {
        /// How many abscissae were given.
        abscissa: usize,
        /// How many ordinates were given.
        ordinate: usize,
    },
    /// An even abscissa that is not finite.
    #[error("an even abscissa must be finite, but starts at {start} with a step of {step}")]
    Even {
        /// The start given.
        start: f64,
        /// The step given.
        step: f64,
    },
    /// A function of something else than time.
    #[error("\"{name}\" is no record over time, but a {function}")]
    NotTime {
        /// Name of the data set.
        name: String,
        /// What it is.
        function: FunctionType,
    },
    /// Complex values.
    #[error("\"{name}\" has complex values; a record is real")]
    Complex {
        /// Name of the data set.
        name: String,
    },
    /// A time axis in a unit that is not known.
    #[error("the time axis of \"{name}\" is in \"{unit}\"; known are s, ms, µs and ns")]
    TimeUnit {
        /// Name of the data set.
        name: String,
        /// The unit.
        unit: String,
    },
    /// No data set of that name or position.
    #[error("there is no data set {channel}; the file has: {}", quoted(available))]
    NoSuchChannel {
        /// What was asked for.
        channel: Column,
        /// The names of all data sets 58.
        available: Vec<String>,
    },
    /// More than one data set of that name.
    #[error("{count} data sets are called {channel}; choose one by its position, counted from 0")]
    AmbiguousChannel {
        /// What was asked for.
        channel: Column,
        /// How many there are.
        count: usize,
    },
    /// No data set was named, and the file does not have exactly one record over time.
    #[error("name the data set; the file has {times} records over time among: {}", quoted(available))]
    ChooseChannel {
        /// How many records over time there are.
        times: usize,
        /// The names of all data sets 58.
        available: Vec<String>,
    },
    /// A text that the format cannot hold: too long, a control character, or a letter beyond Latin-1.
    #[error("{what} \"{text}\" cannot be written: it must have at most {limit} characters of Latin-1 on one line")]
    Text {
        /// Which text.
        what: &'static str,
        /// The text.
        text: String,
        /// How many characters fit.
        limit: usize,
    },
    /// A number that its columns cannot hold.
    #[error("{what} {value} cannot be written: it has only {columns} columns")]
    Number {
        /// Which number.
        what: &'static str,
        /// The number.
        value: i64,
        /// How many columns it has.
        columns: usize,
    },
    /// Uneven abscissae that are equal in the digits of the format.
    #[error("abscissa {index}, {value}, cannot be told from its neighbour in the digits that the format has for it")]
    AbscissaDigits {
        /// Index of the abscissa.
        index: usize,
        /// The abscissa.
        value: f64,
    },
    /// A value beyond single precision.
    #[error("value {index}, {value}, is beyond the range of single precision; write the data set in double precision")]
    BeyondSingle {
        /// Index of the value.
        index: usize,
        /// The value, or one of its parts.
        value: f64,
    },
    /// The numbers do not make a record.
    #[error(transparent)]
    Record(#[from] RecordError),
}

/// What the file has instead of functions.
fn instead(others: &[String], warnings: &[Warning]) -> String {
    let others = if others.is_empty() { "and no others".into() } else { format!("only {}", others.join(", ")) };
    warnings.iter().fold(others, |text, warning| format!("{text}; {warning}"))
}
