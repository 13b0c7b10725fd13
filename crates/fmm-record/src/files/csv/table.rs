//! The rows of a text file.

use std::collections::VecDeque;
use std::io::{BufReader, Read};
use std::ops::Range;

use super::header::Header;
use super::layout::Layout;
use super::lines::{Line, Lines};
use crate::error::RecordError;
use crate::files::csv::fields::{Kind, NO_ROWS, Separator, are_fewer, digits, not_a_number, number, ragged, split};
use crate::files::reading::{Column, only};

/// Length of the part of the file by which its layout is judged (bytes).
const HEAD: usize = 1 << 16;

/// Rows that the last one is compared with before it is called cut off.
const ENOUGH: usize = 8;

/// An open table: the names of its columns are known, its rows are read one by one.
pub(super) struct Table<R> {
    head: VecDeque<Line>,
    lines: Lines<BufReader<R>>,
    line: Line,
    fields: Vec<Range<usize>>,
    separator: Separator,
    columns: Vec<Kind>,
    pub(super) header: Header,
    mark: Option<char>,
}

impl<R: Read> Table<R> {
    /// Opens the table behind the first `skip` lines.
    pub(super) fn open(input: R, separator: Option<u8>, skip: u64) -> Result<Self, RecordError> {
        let separator = match separator {
            None => None,
            Some(b' ') => Some(Separator::Blanks),
            Some(sign @ (b',' | b';' | b'\t' | b'|' | b':')) => Some(Separator::Sign(sign)),
            Some(separator) => {
                let sign = char::from(separator);
                return Err(RecordError::options(format!("{sign:?} cannot separate columns of numbers")));
            }
        };
        let mut lines = Lines::new(BufReader::new(input), skip);
        let mut head = Vec::new();
        let mut length = 0;
        let mut line = Line::default();
        while length < HEAD && lines.next(&mut line)? {
            length += line.text.len() + 1;
            head.push(std::mem::take(&mut line));
        }
        if head.is_empty() {
            return Err(RecordError::damaged("the file is empty or holds comments only"));
        }
        let Layout { separator, columns, header, first } = Layout::of(&head, separator)?;
        let head = head.into_iter().skip(first).collect();
        let (fields, mark) = (Vec::new(), None);
        Ok(Self { head, lines, line, fields, separator, columns, header, mark })
    }

    /// The first column that holds anything.
    pub(super) fn first(&self) -> usize {
        self.columns.iter().position(|kind| *kind != Kind::Blank).unwrap_or(0)
    }

    /// True for an empty column.
    pub(super) fn is_blank(&self, column: usize) -> bool {
        self.columns[column] == Kind::Blank
    }

    /// Position of the column that the caller means.
    pub(super) fn find(&self, column: &Column) -> Result<usize, RecordError> {
        let found = column.among(&[&self.header.names, &self.header.bare]);
        only(&found, column, "column", &self.header.names)
    }

    /// Reads the chosen columns of all rows.
    pub(super) fn read_columns<const N: usize>(mut self, chosen: [usize; N]) -> Result<[Vec<f64>; N], RecordError> {
        let mut columns = [const { Vec::new() }; N];
        let last = self.columns.len() - 1;
        let is_last_in_use = chosen.contains(&last);
        let mut least: Option<[usize; 3]> = None;
        while self.advance()? {
            self.check_width()?;
            for (values, &column) in columns.iter_mut().zip(&chosen) {
                values.push(self.number(column)?);
            }
            if is_last_in_use {
                let digits = digits(self.field(last));
                let rows = columns.first().map_or(0, Vec::len);
                if !self.line.is_ended && rows > ENOUGH && least.is_some_and(|least| are_fewer(digits, least)) {
                    let (line, text) = (self.line.number, self.shown(last));
                    let what = format!(
                        "line {line} ends with \"{text}\" and without a line end, and all other numbers of its column have more \
                         digits: the file is cut off; if it is not, end its last line"
                    );
                    return Err(RecordError::on_line(line, what));
                }
                least = Some(std::array::from_fn(|i| least.map_or(digits[i], |least| least[i].min(digits[i]))));
            }
        }
        if columns.iter().any(Vec::is_empty) { Err(RecordError::damaged(NO_ROWS)) } else { Ok(columns) }
    }

    /// Goes to the next row that is not blank; false at the end.
    fn advance(&mut self) -> Result<bool, RecordError> {
        loop {
            match self.head.pop_front() {
                Some(line) => self.line = line,
                None if self.lines.next(&mut self.line)? => {}
                None => return Ok(false),
            }
            split(&self.line.text, self.separator, &mut self.fields);
            if self.fields.iter().any(|field| !field.is_empty()) {
                return Ok(true);
            }
        }
    }

    /// Refuses a row with more or fewer fields than the table has columns; only columns in which nothing is may be
    /// missing.
    fn check_width(&self) -> Result<(), RecordError> {
        let (expected, found) = (self.columns.len(), self.fields.len());
        let missing_are_blank = || self.columns[found..].iter().all(|kind| *kind == Kind::Blank);
        if found == expected || (found < expected && missing_are_blank()) {
            return Ok(());
        }
        Err(ragged(self.line.number, expected, found, self.separator))
    }

    fn field(&self, column: usize) -> &[u8] {
        self.fields.get(column).map_or(&[], |range| &self.line.text[range.clone()])
    }

    /// A field, cut after as much as is enough to recognise it by.
    fn shown(&self, column: usize) -> String {
        const SHOWN: usize = 40;
        String::from_utf8_lossy(self.field(column)).chars().take(SHOWN).collect()
    }

    /// The number in a field of the current row.
    fn number(&mut self, column: usize) -> Result<f64, RecordError> {
        let line = self.line.number;
        let Some((value, mark)) = number(self.field(column), self.separator) else {
            return Err(not_a_number(line, &self.header.names[column], &self.shown(column)));
        };
        match (self.mark, mark) {
            (None, _) => self.mark = mark,
            (Some(earlier), Some(mark)) if earlier != mark => {
                let [this, other] = if mark == ',' { ["comma", "point"] } else { ["point", "comma"] };
                let (name, text) = (&self.header.names[column], self.shown(column));
                let what = format!(
                    "line {line}, column \"{name}\": \"{text}\" has a decimal {this}, but earlier numbers have a decimal \
                     {other}; a file must keep to one of them"
                );
                return Err(RecordError::on_line(line, what));
            }
            _ => {}
        }
        Ok(value)
    }
}
