//! Layout of a text file: beginning of the table, separator, names of the columns.

use super::header::{Header, SIGNAL_EXPRESS, header, is_called};
use super::lines::Line;
use crate::error::RecordError;
use crate::files::csv::fields::{Kind, NO_ROWS, Row, Separator, is_value, text};

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
        // A further segment of LabVIEW has a header of its own.
        let further = body.iter().position(|line| begin > 0 && line.text.starts_with(b"Channels"));
        let body = &body[..further.unwrap_or(body.len())];
        if body.is_empty() {
            return Err(RecordError::damaged(NO_ROWS));
        }
        let separator = match given.or(told) {
            Some(separator) => separator,
            None => likely_separator(body)?,
        };
        let mut rows: Vec<Row> = body.iter().map(|line| Row::of(&line.text, separator)).collect();
        // Spreadsheets save rows in which nothing is.
        while rows.last().is_some_and(Row::is_blank) {
            rows.pop();
        }
        if rows.is_empty() {
            return Err(RecordError::damaged(NO_ROWS));
        }
        let width = usual_width(&rows);
        let mut columns = kinds(&rows, width);
        let first = first_row(&rows, &columns);
        // Rows that end with a separator may have columns above which nothing stands in them: Rigol's increment.
        let named = first.checked_sub(1).map_or(0, |above| rows[above].len());
        if columns.last() == Some(&Kind::Blank) && named > width {
            columns.resize(named, Kind::Blank);
        }
        let header = header(&lines[..begin + first], begin, lines.get(begin + first), &columns, separator)?;
        Ok(Self { separator, columns, header, first: begin + first })
    }
}

/// The line of LabVIEW that ends a header.
pub(super) const END_OF_HEADER: &[u8] = b"***End_of_Header***";

/// Earliest line of the table, and the separator, if lines state them: the first one of a spreadsheet
/// (`sep=;`), and the one of LabVIEW that ends its header, or that of its first segment, or that of SignalExpress.
fn preamble(lines: &[Line]) -> (usize, Option<Separator>) {
    let is_end = |line: &Line| line.text.trim_ascii().to_ascii_lowercase().starts_with(b"***end_of_header***");
    let segment = lines.iter().position(|line| line.text.starts_with(b"Channels")).unwrap_or(lines.len());
    let of_segment = (segment..lines.len()).find(|at| is_end(&lines[*at]));
    if let Some(end) = of_segment.or_else(|| lines.iter().rposition(is_end)) {
        return (end + 1, None);
    }
    if let Some(names) = lines.iter().position(|line| is_called(line, SIGNAL_EXPRESS)) {
        return (names + 1, None);
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
fn kinds(rows: &[Row], width: usize) -> Vec<Kind> {
    let last: Vec<&Row> = rows.iter().rev().filter(|row| row.len() == width).take(2).collect();
    let kind = |column: usize| {
        if last.iter().any(|row| is_value(row.field(column))) {
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
fn first_row(rows: &[Row], columns: &[Kind]) -> usize {
    let numbers: Vec<usize> = (0..columns.len()).filter(|column| columns[*column] == Kind::Number).collect();
    let is_row = |row: &Row| {
        let is_number = |column: &&usize| is_value(row.field(**column));
        let found = numbers.iter().filter(is_number).count();
        row.len() == columns.len() && numbers.first().iter().any(is_number) && 2 * found >= numbers.len()
    };
    let first = rows.iter().position(is_row);
    // Without any number, the first line names the columns of whatever follows.
    first.unwrap_or_else(|| rows.iter().position(|row| row.len() == columns.len()).map_or(0, |header| header + 1))
}

/// The separator in the last two lines: a semicolon, a tab or a bar, where there is one, since a comma beside them is a
/// decimal comma; blanks between nothing but numbers; else a comma.
fn likely_separator(lines: &[Line]) -> Result<Separator, RecordError> {
    let last = || lines.iter().rev().take(2);
    let found = |separator: &u8| last().any(|line| line.text.contains(separator));
    if let Some(sign) = [b';', b'\t', b'|'].into_iter().find(found) {
        return Ok(Separator::Sign(sign));
    }
    let are_aligned = |line: &Line| {
        let row = Row::of(&line.text, Separator::Blanks);
        row.len() > 1 && (0..row.len()).all(|column| is_value(row.field(column)))
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
        "\"{text}\" may be two whole numbers or one with a decimal comma; put a line above with the name of each column"
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
