//! Faults of a table.

use super::fields::Separator;
use crate::RecordError;

/// A header without a table.
pub(super) const NO_ROWS: &str = "the file has a header but no rows of data below it";

/// A row with more or fewer fields than the first.
pub(super) fn ragged(line: u64, expected: usize, found: usize, separator: Separator) -> RecordError {
    let remedy = if separator.leaves_comma() {
        ""
    } else {
        "; if the numbers have decimal commas, save the file with semicolons or tabs between the columns; if lines stand above \
         the table, skip them"
    };
    RecordError::on_line(line, format!("line {line} has {found} fields, but the first row has {expected}{remedy}"))
}

/// A field that is not a number.
pub(super) fn not_a_number(line: u64, column: &str, text: &str) -> RecordError {
    RecordError::on_line(line, format!("line {line}, column \"{column}\": \"{text}\" is not a number"))
}
