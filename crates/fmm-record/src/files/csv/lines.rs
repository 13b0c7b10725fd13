//! The lines of a text file, with their numbers.

use std::collections::VecDeque;
use std::io::{BufRead, ErrorKind};
use std::sync::Arc;

use super::stamp::Stamp;
use crate::error::RecordError;

/// The longest line that is read (bytes). A file without line ends is refused instead of filling the memory.
pub(crate) const LONGEST_LINE: usize = 1 << 20;

/// Number of comments before a line that are looked at.
const MOST_COMMENTS: usize = 100;

/// A line that is neither blank nor a comment.
#[derive(Debug, Clone, Default)]
pub(super) struct Line {
    /// Counted from 1, as in an editor.
    pub(super) number: u64,
    pub(super) text: Vec<u8>,
    /// True if a line end follows; it may be missing at the end of the file only.
    pub(super) is_ended: bool,
    /// The comments right before it, of many the last.
    pub(super) comments: VecDeque<Vec<u8>>,
    /// The names of its numbers, if they stand before each.
    pub(super) labels: Option<Vec<u8>>,
}

/// Goes through the lines of a text, whose ends may be those of any system.
pub(super) struct Lines<R> {
    source: R,
    number: u64,
    skip: u64,
    after_return: bool,
}

impl<R: BufRead> Lines<R> {
    /// The lines behind the first `skip`.
    pub(super) fn new(source: R, skip: u64) -> Self {
        Self { source, number: 0, skip, after_return: false }
    }

    /// Reads the next line that is neither blank nor a comment; false at the end.
    pub(super) fn next(&mut self, line: &mut Line) -> Result<bool, RecordError> {
        line.comments.clear();
        line.labels = None;
        while self.read(line)? {
            if line.number == 1 && line.text.starts_with("\u{FEFF}".as_bytes()) {
                line.text.drain(..3);
            }
            if line.number <= self.skip {
                continue;
            }
            match line.text.iter().find(|byte| !byte.is_ascii_whitespace()) {
                None => {}
                Some(b'#' | b'%') => {
                    line.comments.push_back(std::mem::take(&mut line.text));
                    if line.comments.len() > MOST_COMMENTS {
                        line.comments.pop_front();
                    }
                }
                Some(_) => {
                    separate_stamp(&mut line.text);
                    if let Some((names, numbers)) = labelled(&line.text) {
                        (line.labels, line.text) = (Some(names), numbers);
                    }
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Reads the next line, whatever is in it; false at the end.
    fn read(&mut self, line: &mut Line) -> Result<bool, RecordError> {
        line.text.clear();
        line.is_ended = false;
        let mut is_any = false;
        while !line.is_ended {
            let buffer = match self.source.fill_buf() {
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                buffer => {
                    buffer.map_err(|source| RecordError::Io { what: "read on".into(), source: Arc::new(source) })?
                }
            };
            // A line feed behind a carriage return belongs to the end of the line before.
            if std::mem::take(&mut self.after_return) && buffer.first() == Some(&b'\n') {
                self.source.consume(1);
                continue;
            }
            if buffer.is_empty() {
                break;
            }
            is_any = true;
            let end = buffer.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let piece = &buffer[..end.unwrap_or(buffer.len())];
            if line.text.len() + piece.len() > LONGEST_LINE {
                let line = self.number + 1;
                let what = format!("line {line} is longer than {LONGEST_LINE} bytes; this is not a table of numbers");
                return Err(RecordError::on_line(line, what));
            }
            line.text.extend_from_slice(piece);
            line.is_ended = end.is_some();
            self.after_return = end.is_some_and(|end| buffer[end] == b'\r');
            let used = piece.len() + usize::from(line.is_ended);
            self.source.consume(used);
        }
        if is_any {
            self.number += 1;
            line.number = self.number;
        }
        Ok(is_any)
    }
}

/// Puts a separator in place of the arrow behind the time of day that the monitor of a serial port writes before a
/// line: the one that stands in the rest of it, or a tab.
fn separate_stamp(line: &mut Vec<u8>) {
    const ARROW: &[u8] = b" -> ";
    let Some(at) = line.windows(ARROW.len()).position(|window| window == ARROW) else { return };
    if Stamp::of(&line[..at]).is_none() {
        return;
    }
    let rest = &line[at + ARROW.len()..];
    let separator = [b';', b'\t', b','].into_iter().find(|sign| rest.contains(sign)).unwrap_or(b'\t');
    line.splice(at..at + ARROW.len(), [separator]);
}

/// The names and the numbers of a line of nothing but such pairs, `ms:12 v:0.5` or `ms=12 v=0.5`, as plotters of serial
/// ports take them, each with tabs between; `None` for any other line, also one that repeats a name, as headers do.
fn labelled(line: &[u8]) -> Option<(Vec<u8>, Vec<u8>)> {
    // Most lines have neither mark, and are not looked at.
    line.iter().any(|sign| matches!(sign, b':' | b'=')).then_some(())?;
    let text = std::str::from_utf8(line).ok()?.replace('=', ":").replace(": ", ":");
    let pairs = text.split([' ', '\t', ',', ';']).filter(|pair| !pair.is_empty());
    let pairs: Vec<(&str, &str)> = pairs.map(|pair| pair.split_once(':')).collect::<Option<_>>()?;
    let is_pair = |(name, value): &(&str, &str)| {
        name.starts_with(|sign: char| sign.is_alphabetic()) && value.parse::<f64>().is_ok()
    };
    let is_repeated = |(at, (name, _)): (usize, &(&str, &str))| pairs[..at].iter().any(|(other, _)| other == name);
    if pairs.len() < 2 || !pairs.iter().all(is_pair) || pairs.iter().enumerate().any(is_repeated) {
        return None;
    }
    let (names, numbers): (Vec<&str>, Vec<&str>) = pairs.into_iter().unzip();
    Some((names.join("\t").into_bytes(), numbers.join("\t").into_bytes()))
}
