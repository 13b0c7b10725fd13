//! The text without its comments, with its line numbers kept.

use std::io::{self, BufRead, Read};

use super::CsvError;

/// The longest line that is read (bytes). A file without line ends is refused instead of filling the memory.
pub const LONGEST_LINE: usize = 1 << 20;

/// What stands for a line without data: a row of one empty field. The parser behind skips empty lines in silence,
/// and then tells the line of a row wrong.
pub(super) const NO_DATA: &[u8] = b"\"\"\n";

/// Passes lines on, with [`NO_DATA`] for those that are comments or blank.
///
/// The csv crate knows comments of its own, but of one kind only.
pub(super) struct WithoutComments<R> {
    source: R,
    line: Vec<u8>,
    given: usize,
    number: u64,
}

impl<R: BufRead> WithoutComments<R> {
    pub(super) fn new(source: R) -> Self {
        Self { source, line: Vec::new(), given: 0, number: 0 }
    }

    /// Reads the next line; false at the end.
    fn advance(&mut self) -> io::Result<bool> {
        self.line.clear();
        self.given = 0;
        let limit = LONGEST_LINE as u64 + 1;
        if self.source.by_ref().take(limit).read_until(b'\n', &mut self.line)? == 0 {
            return Ok(false);
        }
        self.number += 1;
        if self.number == 1 {
            if self.line.starts_with(&[0xFF, 0xFE]) || self.line.starts_with(&[0xFE, 0xFF]) {
                return Err(io::Error::other(CsvError::Utf16));
            }
            if self.line.starts_with("\u{FEFF}".as_bytes()) {
                self.line.drain(..3);
            }
        }
        if self.line.len() > LONGEST_LINE {
            return Err(io::Error::other(CsvError::LineTooLong { line: self.number, limit: LONGEST_LINE }));
        }
        let first = self.line.iter().find(|byte| !byte.is_ascii_whitespace());
        if matches!(first, None | Some(b'#' | b'%')) {
            self.line.clear();
            self.line.extend_from_slice(NO_DATA);
        }
        Ok(true)
    }
}

impl<R: BufRead> Read for WithoutComments<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if self.given == self.line.len() && !self.advance()? {
            return Ok(0);
        }
        let count = out.len().min(self.line.len() - self.given);
        out[..count].copy_from_slice(&self.line[self.given..self.given + count]);
        self.given += count;
        Ok(count)
    }
}
