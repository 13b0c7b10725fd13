//! The rows of a text file, and the names of its columns.

use std::io::{BufReader, Chain, Cursor, Read};

use ::csv::{ByteRecord, ErrorKind, Reader, ReaderBuilder, Trim};

use super::CsvError;
use super::lines::{NO_DATA, WithoutComments};
use super::number::{self, Mark};
use crate::Column;

/// How much of the file the separator is judged by (bytes).
const HEAD: u64 = 1 << 16;

/// The text of the table: what the separator was judged by, then the rest.
type Source<R> = Chain<Cursor<Vec<u8>>, WithoutComments<BufReader<R>>>;

/// An open table: the names of its columns are known, its rows are read one by one.
pub(super) struct Table<R: Read> {
    reader: Reader<Source<R>>,
    row: ByteRecord,
    pending: bool,
    separator: u8,
    names: Vec<String>,
    mark: Option<Mark>,
}

impl<R: Read> Table<R> {
    /// Opens the table and reads its first row, which is a header if any of its fields is not a number.
    pub(super) fn open(input: R, separator: Option<u8>) -> Result<Self, CsvError> {
        if let Some(separator) = separator.filter(|byte| !matches!(byte, b',' | b';' | b'\t' | b' ' | b'|' | b':')) {
            return Err(CsvError::Separator { separator });
        }
        let mut source = WithoutComments::new(BufReader::new(input));
        let mut head = Vec::new();
        source.by_ref().take(HEAD).read_to_end(&mut head).map_err(io_error)?;
        let separator = separator.unwrap_or_else(|| likely_separator(&head));
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(separator)
            .trim(Trim::All)
            .from_reader(Cursor::new(head).chain(source));
        let mut table =
            Self { reader, row: ByteRecord::new(), pending: false, separator, names: Vec::new(), mark: None };
        if !table.advance()? {
            return Err(CsvError::Empty);
        }
        let fields: Vec<_> = table.row.iter().map(text).collect();
        table.pending = fields.iter().all(|field| field.is_empty() || number::parse(field, separator).is_some());
        table.names = if table.pending { (0..fields.len()).map(|i| i.to_string()).collect() } else { fields };
        Ok(table)
    }

    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// Position of the column that the caller means.
    pub(super) fn find(&self, column: &Column) -> Result<usize, CsvError> {
        let matching = |same: &dyn Fn(&str) -> bool| -> Vec<usize> {
            self.names.iter().enumerate().filter(|(_, name)| same(name)).map(|(index, _)| index).collect()
        };
        let found = match column {
            Column::Index(index) if *index < self.names.len() => vec![*index],
            Column::Index(_) => Vec::new(),
            Column::Name(wanted) => {
                let wanted = wanted.trim();
                let exact = matching(&|name| name == wanted);
                let lower = wanted.to_lowercase();
                if exact.is_empty() { matching(&|name| name.to_lowercase() == lower) } else { exact }
            }
        };
        match found[..] {
            [index] => Ok(index),
            [] => Err(CsvError::NoSuchColumn { column: column.clone(), available: self.names.clone() }),
            _ => Err(CsvError::AmbiguousColumn { column: column.clone(), count: found.len() }),
        }
    }

    /// Reads the chosen columns of all rows.
    pub(super) fn read_columns<const N: usize>(mut self, chosen: [usize; N]) -> Result<[Vec<f64>; N], CsvError> {
        let mut columns = [const { Vec::new() }; N];
        while self.advance()? {
            if self.row.len() != self.names.len() {
                return Err(CsvError::Ragged {
                    line: self.line(),
                    expected: self.names.len(),
                    found: self.row.len(),
                    separator: self.separator,
                });
            }
            for (values, &column) in columns.iter_mut().zip(&chosen) {
                values.push(self.number(column)?);
            }
        }
        if columns.iter().any(Vec::is_empty) { Err(CsvError::NoRows) } else { Ok(columns) }
    }

    /// Goes to the next row that is not blank; false at the end.
    fn advance(&mut self) -> Result<bool, CsvError> {
        if std::mem::take(&mut self.pending) {
            return Ok(true);
        }
        while self.reader.read_byte_record(&mut self.row).map_err(csv_error)? {
            if self.row.iter().any(|field| !field.is_empty()) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn line(&self) -> u64 {
        self.row.position().map_or(0, ::csv::Position::line)
    }

    /// The number in a field of the current row.
    fn number(&mut self, column: usize) -> Result<f64, CsvError> {
        /// Enough to recognise a field by.
        const SHOWN: usize = 40;
        let field = self.row.get(column).unwrap_or_default();
        let parsed = std::str::from_utf8(field).ok().and_then(|text| number::parse(text, self.separator));
        let shown = || String::from_utf8_lossy(field).chars().take(SHOWN).collect();
        let Some((value, mark)) = parsed else {
            return Err(CsvError::NotANumber { line: self.line(), column: self.names[column].clone(), text: shown() });
        };
        match (self.mark, mark) {
            (None, _) => self.mark = mark,
            (Some(earlier), Some(mark)) if earlier != mark => {
                return Err(CsvError::MixedDecimals {
                    line: self.line(),
                    column: self.names[column].clone(),
                    text: shown(),
                    comma: mark == Mark::Comma,
                });
            }
            _ => {}
        }
        Ok(value)
    }
}

/// The text of a field, in Latin-1 if it is not UTF-8.
fn text(field: &[u8]) -> String {
    std::str::from_utf8(field).map_or_else(|_| field.iter().copied().map(char::from).collect(), str::to_owned)
}

/// The separator in the last lines that `head` shows: a semicolon or a tab, where there is one, since a comma beside
/// them is a decimal comma. Two lines are asked, because the head may end within one; they are the last, because
/// the first may be a header of any text.
fn likely_separator(head: &[u8]) -> u8 {
    let rows = head.split_inclusive(|byte| *byte == b'\n').rev().filter(|line| *line != NO_DATA).take(2);
    let found = |separator: &u8| rows.clone().any(|row| row.contains(separator));
    [b';', b'\t'].into_iter().find(found).unwrap_or(b',')
}

fn csv_error(error: ::csv::Error) -> CsvError {
    match error.into_kind() {
        ErrorKind::Io(source) => io_error(source),
        // The other kinds concern headers, UTF-8 and equal lengths, none of which is asked for here.
        kind => CsvError::Io { source: std::io::Error::other(format!("{kind:?}")) },
    }
}

/// The error that [`WithoutComments`] wrapped, or the system's.
fn io_error(source: std::io::Error) -> CsvError {
    match source.downcast::<CsvError>() {
        Ok(error) => error,
        Err(source) => CsvError::Io { source },
    }
}
