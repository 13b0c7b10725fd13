//! The rows of a text file.

use std::collections::VecDeque;
use std::io::{BufReader, Read};
use std::ops::Range;

use super::header::Header;
use super::layout::{END_OF_HEADER, Layout};
use super::lines::{Line, Lines};
use crate::error::RecordError;
use crate::files::csv::fields::{
    Kind, NO_ROWS, Separator, are_fewer, digits, grouped, is_value, not_a_number, number, ragged, split,
};
use crate::files::csv::stamp::{Stamp, Stamps};
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
    /// The line of names; a further table begins where it stands again.
    heading: Vec<u8>,
    is_labview: bool,
    repairs: bool,
    /// True if the channel may have rows without a number.
    may_lack: bool,
}

/// The chosen columns of all rows.
pub(super) struct Rows<const N: usize> {
    pub(super) columns: [Vec<f64>; N],
    /// The first time of day in each column that holds such; its numbers are times since then (s).
    pub(super) clocks: [Option<String>; N],
    /// Sentences about lines that were not used as they are.
    pub(super) remarks: Vec<String>,
    /// Rows at which a further table begins.
    pub(super) begins: Vec<usize>,
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
        let is_labview = head.iter().any(|line| line.text.starts_with(END_OF_HEADER));
        let heading = first.checked_sub(1).map_or_else(Vec::new, |above| head[above].text.clone());
        let head = head.into_iter().skip(first).collect();
        let (fields, mark) = (Vec::new(), None);
        Ok(Self {
            head,
            lines,
            line,
            fields,
            separator,
            columns,
            header,
            mark,
            heading,
            is_labview,
            repairs: false,
            may_lack: false,
        })
    }

    /// The first column that holds anything.
    pub(super) fn first(&self) -> usize {
        self.columns.iter().position(|kind| *kind != Kind::Blank).unwrap_or(0)
    }

    /// True for a column of numbers.
    pub(super) fn is_number(&self, column: usize) -> bool {
        self.columns[column] == Kind::Number
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

    /// Reads the chosen columns of all rows. With `repairs`, a damaged line is left out at the ends of the table, and
    /// inside of it a straight line between its neighbours stands for it. Where the last of the columns `may_lack`
    /// numbers, an empty field is one that is none (NaN), and rows in which all of them are empty are none.
    pub(super) fn read_columns<const N: usize>(
        mut self,
        chosen: [usize; N],
        repairs: bool,
        may_lack: bool,
    ) -> Result<Rows<N>, RecordError> {
        (self.repairs, self.may_lack) = (repairs, may_lack && !repairs);
        let mut rows = Rows {
            columns: [const { Vec::new() }; N],
            clocks: [const { None }; N],
            remarks: Vec::new(),
            begins: Vec::new(),
        };
        let mut stamps = [const { None }; N];
        let mut damaged: Vec<(usize, RecordError)> = Vec::new();
        let mut least: Option<[usize; 3]> = None;
        let mut length = 0;
        while let Some(begins_table) = self.advance()? {
            if N > 1 && self.may_lack && chosen.iter().all(|column| self.field(*column).is_empty()) {
                continue;
            }
            if begins_table && length > 0 {
                rows.begins.push(length);
            }
            let values = self.row(chosen, &mut stamps, &mut least, [length, damaged.len()]);
            match values {
                Ok(values) => rows.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value)),
                Err(error) if repairs => {
                    rows.columns.iter_mut().for_each(|column| column.push(f64::NAN));
                    damaged.push((length, error));
                }
                Err(error) => return Err(error),
            }
            length += 1;
        }
        rows.clocks = stamps.map(|stamps: Option<(String, Stamps)>| stamps.map(|(first, _)| first));
        if length == 0 {
            return Err(RecordError::damaged(NO_ROWS));
        }
        rows.repair(damaged)?;
        Ok(rows)
    }

    /// The chosen numbers of the current row. Rows above it are known, and some of them may be damaged.
    fn row<const N: usize>(
        &mut self,
        chosen: [usize; N],
        stamps: &mut [Option<(String, Stamps)>; N],
        least: &mut Option<[usize; 3]>,
        [length, damaged]: [usize; 2],
    ) -> Result<[f64; N], RecordError> {
        self.check_width()?;
        if self.repairs {
            // A line is damaged for all of its columns, so that they stay together.
            let is_damaged = |column: &usize| self.is_number(*column) && !is_value(self.field(*column));
            if let Some(column) = (0..self.columns.len()).find(is_damaged) {
                return Err(not_a_number(self.line.number, &self.header.names[column], &self.shown(column)));
            }
        }
        let mut values = [0.0; N];
        for ((value, &column), stamps) in values.iter_mut().zip(&chosen).zip(stamps) {
            *value = match Stamp::of(self.field(column)) {
                Some(stamp) if length == damaged || stamps.is_some() => {
                    let first = self.shown(column);
                    stamps.get_or_insert_with(|| (first, Stamps::default())).1.elapsed(stamp)
                }
                _ if self.may_lack && column == chosen[N - 1] && self.field(column).is_empty() => f64::NAN,
                _ => self.number(column)?,
            };
        }
        let last = self.columns.len() - 1;
        if chosen.contains(&last) {
            let digits = digits(self.field(last));
            if !self.line.is_ended && length >= ENOUGH && least.is_some_and(|least| are_fewer(digits, least)) {
                let (line, text) = (self.line.number, self.shown(last));
                let what = format!(
                    "line {line} ends with \"{text}\" and without a line end, and all other numbers of its column have \
                     more digits: the file is cut off; if it is not, end its last line"
                );
                return Err(RecordError::on_line(line, what));
            }
            *least = Some(std::array::from_fn(|i| least.map_or(digits[i], |least| least[i].min(digits[i]))));
        }
        Ok(values)
    }

    /// Goes to the next row that is not blank, and tells whether a further table begins with it; `None` at
    /// the end.
    fn advance(&mut self) -> Result<Option<bool>, RecordError> {
        let (mut begins_table, mut is_header) = (false, false);
        loop {
            match self.head.pop_front() {
                Some(line) => self.line = line,
                None if self.lines.next(&mut self.line)? => {}
                None => return Ok(None),
            }
            let text = &self.line.text;
            is_header |= self.is_labview && text.starts_with(b"Channels");
            if is_header || (!self.heading.is_empty() && *text == self.heading) {
                begins_table = true;
                is_header &= !text.starts_with(END_OF_HEADER);
                continue;
            }
            split(text, self.separator, &mut self.fields);
            if self.fields.iter().any(|field| !field.is_empty()) {
                return Ok(Some(begins_table));
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
        if found < expected && !self.line.is_ended {
            let line = self.line.number;
            let what = format!("line {line} has {found} of {expected} fields and no line end: the file is cut off");
            return Err(RecordError::on_line(line, what));
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
        let Some((value, mark)) = number(self.field(column)) else {
            return Err(not_a_number(line, &self.header.names[column], &self.shown(column)));
        };
        match (self.mark, mark) {
            (None, _) => self.mark = mark,
            (Some(earlier), Some(mark)) if earlier != mark => {
                if let Some(value) = grouped(self.field(column), earlier) {
                    return Ok(value);
                }
                let [this, other] = if mark == ',' { ["comma", "point"] } else { ["point", "comma"] };
                let (name, text) = (&self.header.names[column], self.shown(column));
                let what = format!(
                    "line {line}, column \"{name}\": \"{text}\" has a decimal {this}, but earlier numbers have a \
                     decimal {other}; a file must keep to one of them"
                );
                return Err(RecordError::on_line(line, what));
            }
            _ => {}
        }
        Ok(value)
    }
}

impl<const N: usize> Rows<N> {
    /// Leaves out the `damaged` rows at the ends, and puts straight lines in place of the others.
    fn repair(&mut self, mut damaged: Vec<(usize, RecordError)>) -> Result<(), RecordError> {
        /// Largest share of damaged rows in a table that is still one, and the number that is always few.
        const MOST: f64 = 0.1;
        const FEW: usize = 4;
        let length = self.columns.first().map_or(0, Vec::len);
        if damaged.len() > FEW && damaged.len() as f64 > MOST * length as f64 {
            return Err(damaged.swap_remove(0).1);
        }
        let (mut begin, mut end) = (0, length);
        for (row, error) in &damaged {
            begin += usize::from(*row == begin);
            self.remarks.push(format!("{error}; the line was not used"));
        }
        for (row, _) in damaged.iter().rev() {
            end -= usize::from(*row + 1 == end);
        }
        let inside: Vec<usize> = damaged.iter().map(|(row, _)| *row).filter(|row| (begin..end).contains(row)).collect();
        if !inside.is_empty() {
            let count = inside.len();
            self.remarks.push(format!("straight lines between their neighbours stand for {count} damaged lines"));
        }
        for column in &mut self.columns {
            let mut rows = inside.iter().peekable();
            while let Some(&first) = rows.next() {
                let mut last = first;
                while rows.next_if(|row| **row == last + 1).is_some() {
                    last += 1;
                }
                let (before, behind) = (column[first - 1], column[last + 1]);
                let steps = (last - first + 2) as f64;
                for (step, value) in column[first..=last].iter_mut().enumerate() {
                    *value = before + (behind - before) * (step + 1) as f64 / steps;
                }
            }
        }
        self.cut(begin, end);
        Ok(())
    }

    /// Keeps the rows from `begin` up to the one before `end`.
    pub(super) fn cut(&mut self, begin: usize, end: usize) {
        for column in &mut self.columns {
            column.truncate(end);
            column.drain(..begin.min(end));
        }
        self.begins = self.begins.iter().filter(|row| (begin + 1..end).contains(row)).map(|row| row - begin).collect();
    }
}
