//! Why a text file did not become a record.

use std::io;
use std::path::PathBuf;

use crate::reading::quoted;
use crate::stated::Conflict;
use crate::{Column, RecordError};

/// A text file that does not hold the record asked for. Lines count from 1, as in an editor.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CsvError {
    /// The file cannot be opened.
    #[error("cannot open {}: {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Reading stopped half way.
    #[error("cannot read on: {source}")]
    Io {
        /// What the system says.
        #[from]
        source: io::Error,
    },
    /// UTF-16, as some spreadsheets write it.
    #[error("the file is UTF-16 text; save it as UTF-8")]
    Utf16,
    /// A line that no table of numbers has; the file is probably not text.
    #[error("line {line} is longer than {limit} bytes; this is not a table of numbers")]
    LineTooLong {
        /// The line.
        line: u64,
        /// The limit (bytes).
        limit: usize,
    },
    /// Nothing but comments and blank lines.
    #[error("the file is empty or holds comments only")]
    Empty,
    /// A header without a table.
    #[error("the file has a header but no rows of data below it")]
    NoRows,
    /// Separators other than comma, semicolon, tab and the like cannot be told from numbers.
    #[error("{:?} cannot separate columns of numbers", char::from(*separator))]
    Separator {
        /// The separator given.
        separator: u8,
    },
    /// A row with more or fewer fields than the first.
    #[error("line {line} has {found} fields, but the first row has {expected}{}", remedy(*separator))]
    Ragged {
        /// The line.
        line: u64,
        /// Number of fields in the first row.
        expected: usize,
        /// Number of fields in this one.
        found: usize,
        /// The separator in use.
        separator: u8,
    },
    /// A field that is not a number.
    #[error("line {line}, column \"{column}\": \"{text}\" is not a number")]
    NotANumber {
        /// The line.
        line: u64,
        /// Name of the column.
        column: String,
        /// The field, cut after some characters.
        text: String,
    },
    /// A last line that ends within its last number.
    #[error(
        "line {line} ends with \"{text}\" and without a line end, and all other numbers of its column have more digits: the \
         file is cut off; if it is not, end its last line"
    )]
    Cut {
        /// The line.
        line: u64,
        /// The last field, cut after some characters.
        text: String,
    },
    /// Numbers with a comma that may be two.
    #[error("\"{text}\" may be two whole numbers or one with a decimal comma; give the separator, a comma or another")]
    AmbiguousComma {
        /// The first row.
        text: String,
    },
    /// Two numbers above the table tell different rates.
    #[error("\"{first}\" says {first_rate} Hz, but \"{second}\" says {second_rate} Hz; give the rate")]
    ConflictingRates {
        /// One name.
        first: String,
        /// The rate that it states (Hz).
        first_rate: f64,
        /// The other name.
        second: String,
        /// The rate that it states (Hz).
        second_rate: f64,
    },
    /// Decimal points and decimal commas in one file.
    #[error(
        "line {line}, column \"{column}\": \"{text}\" has a decimal {}, but earlier numbers have a decimal {}; \
         a file must keep to one of them", if *comma { "comma" } else { "point" }, if *comma { "point" } else { "comma" }
    )]
    MixedDecimals {
        /// The line.
        line: u64,
        /// Name of the column.
        column: String,
        /// The field.
        text: String,
        /// Whether this field has the comma.
        comma: bool,
    },
    /// No column of that name or position.
    #[error("there is no column {column}; the file has: {}", quoted(available))]
    NoSuchColumn {
        /// The column asked for.
        column: Column,
        /// The names of all columns.
        available: Vec<String>,
    },
    /// More than one column of that name.
    #[error("{count} columns are called {column}; choose one by its position, counted from 0")]
    AmbiguousColumn {
        /// The column asked for.
        column: Column,
        /// How many there are.
        count: usize,
    },
    /// Time and channel must differ.
    #[error("column \"{column}\" cannot be both the time and the channel")]
    SameColumn {
        /// The name of the column.
        column: String,
    },
    /// Nothing but time.
    #[error("the file has only the time column \"{time}\", and no other to read")]
    NoChannel {
        /// The name of the time column.
        time: String,
    },
    /// Both a time column and a rate were given.
    #[error("both a time column and a rate were given; give one of them")]
    TimeAndRate,
    /// Neither a time column nor a rate.
    #[error("the sampling rate is not known: give a time column or a rate; the file has: {}", quoted(available))]
    NoRate {
        /// The names of all columns.
        available: Vec<String>,
    },
    /// The numbers do not make a record.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl From<Conflict> for CsvError {
    fn from(Conflict { first, first_rate, second, second_rate }: Conflict) -> Self {
        Self::ConflictingRates { first, first_rate, second, second_rate }
    }
}

/// What to try when rows have different numbers of fields.
fn remedy(separator: u8) -> &'static str {
    if separator == b',' {
        "; if the numbers have decimal commas, save the file with semicolons or tabs between the columns; if lines stand above \
         the table, skip them"
    } else {
        ""
    }
}
