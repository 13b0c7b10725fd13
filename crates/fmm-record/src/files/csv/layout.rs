//! Layout of a text file: beginning of the table, separator, names of the columns.

use super::header::{Header, header};
use super::lines::Line;
use crate::error::RecordError;
use crate::files::csv::fields::{Kind, NO_ROWS, Row, Separator, number, text};

/// The layout of a table.
pub(super) struct Layout {
    pub(super) separator: Separator,
    pub(super) columns: Vec<Kind>,
    pub(super) header: Header,
    /// Index of the line that is the first row.
    pub(super) first: usize,
}

impl Layout {
    /// The layout that the first lines of a file show, of which there must be one.
    ///
    /// The table is what the last of these lines look like. What stands before its first row is a preamble, but for the
    /// names of the columns and a row of units right before it.
    pub(super) fn of(lines: &[Line], given: Option<Separator>) -> Result<Self, RecordError> {
        let (begin, told) = preamble(lines);
        let body = &lines[begin..];
        if body.is_empty() {
            return Err(RecordError::damaged(NO_ROWS));
        }
        let separator = match given.or(told) {
            Some(separator) => separator,
            None => likely_separator(body)?,
        };
        let rows: Vec<Row> = body.iter().map(|line| Row::of(&line.text, separator)).collect();
        let width = usual_width(&rows);
        let columns = kinds(&rows, width, separator);
        let first = first_row(&rows, &columns, separator);
        let header = header(&lines[..begin + first], begin, lines.get(begin + first), &columns, separator)?;
        Ok(Self { separator, columns, header, first: begin + first })
    }
}

/// Earliest line of the table, and the separator, if lines state them: the first one of a spreadsheet
/// (`sep=;`), and the one of LabVIEW that ends its header.
fn preamble(lines: &[Line]) -> (usize, Option<Separator>) {
    let is_end = |line: &Line| line.text.trim_ascii().to_ascii_lowercase().starts_with(b"***end_of_header***");
    if let Some(end) = lines.iter().rposition(is_end) {
        return (end + 1, None);
    }
    let first = lines.first().map_or(&b""[..], |line| &line.text);
    match first.strip_prefix(b"sep=").or_else(|| first.strip_prefix(b"SEP=")) {
        // Behind it may be separators, as some spreadsheets put them behind every line.
        Some(&[sign, ..]) => (1, Some(Separator::Sign(sign))),
        _ => (0, None),
    }
}

/// Number of fields of most of the last three rows, or else of the last one.
fn usual_width(rows: &[Row]) -> usize {
    let last: Vec<usize> = rows.iter().rev().take(3).map(Row::len).collect();
    let repeated = last.iter().find(|width| last.iter().filter(|other| other == width).count() > 1);
    repeated.or(last.first()).copied().unwrap_or(0)
}

/// Content of the columns in the last two rows of that width. One damaged number does not make a column of text.
fn kinds(rows: &[Row], width: usize, separator: Separator) -> Vec<Kind> {
    let last: Vec<&Row> = rows.iter().rev().filter(|row| row.len() == width).take(2).collect();
    let kind = |column: usize| {
        if last.iter().any(|row| number(row.field(column), separator).is_some()) {
            Kind::Number
        } else if last.iter().all(|row| row.field(column).is_empty()) {
            Kind::Blank
        } else {
            Kind::Text
        }
    };
    (0..width).map(kind).collect()
}

/// The first row of the table: of its width, with a number in the first column of numbers and in half of all others.
/// A fault in its other fields is then an error with the line, and not a lost row.
fn first_row(rows: &[Row], columns: &[Kind], separator: Separator) -> usize {
    let numbers: Vec<usize> = (0..columns.len()).filter(|column| columns[*column] == Kind::Number).collect();
    let is_row = |row: &Row| {
        let is_number = |column: &&usize| number(row.field(**column), separator).is_some();
        let found = numbers.iter().filter(is_number).count();
        row.len() == columns.len() && numbers.first().iter().any(is_number) && 2 * found >= numbers.len()
    };
    let first = rows.iter().position(is_row);
    // Without any number, the first line names the columns of whatever follows.
    first.unwrap_or_else(|| rows.iter().position(|row| row.len() == columns.len()).map_or(0, |header| header + 1))
}

/// The separator in the last two lines: a semicolon or a tab, where there is one, since a comma beside them is a
/// decimal comma; blanks between nothing but numbers; else a comma.
fn likely_separator(lines: &[Line]) -> Result<Separator, RecordError> {
    let last = || lines.iter().rev().take(2);
    let found = |separator: &u8| last().any(|line| line.text.contains(separator));
    if let Some(sign) = [b';', b'\t'].into_iter().find(found) {
        return Ok(Separator::Sign(sign));
    }
    let are_aligned = |line: &Line| {
        let row = Row::of(&line.text, Separator::Blanks);
        row.len() > 1 && (0..row.len()).all(|column| number(row.field(column), Separator::Blanks).is_some())
    };
    if last().all(are_aligned) {
        return Ok(Separator::Blanks);
    }
    if found(&b',') && is_decimal_comma(lines)? { Ok(Separator::Blanks) } else { Ok(Separator::Sign(b',')) }
}

/// True if the commas of a table without another separator are decimal commas of one column of numbers.
fn is_decimal_comma(lines: &[Line]) -> Result<bool, RecordError> {
    let numbers: Vec<(i64, bool)> = lines.iter().rev().map_while(|line| before_comma(line.text.trim_ascii())).collect();
    if numbers.len() < lines.len().min(2) {
        return Ok(false);
    }
    if let Some(above) = lines.len().checked_sub(numbers.len() + 1).map(|above| &lines[above]) {
        // A name without a comma is that of one column.
        return Ok(!above.text.contains(&b','));
    }
    if numbers.iter().any(|(_, is_decimal)| *is_decimal) {
        return Ok(true);
    }
    let counts = numbers.windows(2).all(|pair| pair[0].0 == pair[1].0 + 1);
    if numbers.len() > 2 && counts {
        return Ok(false);
    }
    let text = lines.first().map(|line| text(line.text.trim_ascii())).unwrap_or_default();
    let what = format!(
        "\"{text}\" may be two whole numbers or one with a decimal comma; give the separator, a comma or another"
    );
    Err(RecordError::options(what))
}

/// The whole number before the comma of a number with at most one comma and no point, and true if it cannot be two
/// whole numbers as programs write them.
fn before_comma(text: &[u8]) -> Option<(i64, bool)> {
    let text = std::str::from_utf8(text).ok()?;
    let (before, after) = text.split_once(',').map_or((text, None), |(before, after)| (before, Some(after)));
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    if after.is_some_and(|after| !digits(after)) || !digits(before.trim_start_matches(['-', '+'])) {
        return None;
    }
    let is_padded = after.is_none_or(|after| after.len() > 1 && after.starts_with('0'));
    Some((before.parse().ok()?, is_padded || before == "-0"))
}
