//! Functions in Universal Files: data sets 58, as text and binary (58b), read and written.
//!
//! [`UffFile`] holds every data set 58 of a file: time records, spectra, frequency response functions. Data sets of
//! other numbers (151, 164, 15, …) are passed over and listed. [`DataSet::record`] makes a [`Record`](crate::Record)
//! of a time record, [`DataSet::of_record`] a data set of a record, and [`write()`] a file.
//!
//! Programs that write this format differ, and many err. The points count more than the header:
//! a data set is as long as its number of points and their type make it, whatever its count of bytes; points that a
//! header promises but the file does not have are reported as a warning.
//!
//! ```
//! use fmm_record::uff::{DataSet, Form, UffFile, write_to};
//! use fmm_record::{Quantity, Record};
//!
//! let record = Record::sampled(512.0, vec![0.0, 0.25, -0.125], Quantity::Velocity, "m/s")?;
//! let mut file = Vec::new();
//! write_to(&mut file, &[DataSet::of_record(&record)], Form::Ascii)?;
//!
//! let file = UffFile::parse(&file)?;
//! // The header says 1.95312E-03 s; 512 Hz is the whole number of hertz that reads so.
//! assert_eq!(file.sets()[0].record()?, record);
//! assert!(file.warnings().is_empty());
//! # Ok::<(), fmm_record::RecordError>(())
//! ```
//!
//! # References
//!
//! Structural Dynamics Research Corporation, Universal Dataset Number 58, *Function at Nodal DOF*; University of

mod data_set;
mod header;
mod lines;
mod points;
mod records;
#[cfg(test)]
mod tests;
mod writer;

use std::path::Path;

use crate::error::RecordError;
use crate::files::uff::lines::{Line, Lines, is_delimiter};
use crate::files::uff::points::{binary, encoding, text};
use crate::files::uff::records::shown;

pub use crate::files::number::ByteOrder;
pub use data_set::{Abscissa, DataSet, Ordinate};
pub use header::{Axis, DataType, Freedom, FunctionType, Header};
pub use writer::{Form, write, write_to};

/// All data sets 58 of a Universal File, and what else there is.
#[derive(Debug, Clone, PartialEq)]
pub struct UffFile {
    sets: Vec<DataSet>,
    others: Vec<(u32, u64)>,
    warnings: Vec<String>,
}

impl UffFile {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// [`RecordError::Io`], otherwise as [`UffFile::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, RecordError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| RecordError::io("read", path, source))?;
        Self::parse(&bytes)
    }

    /// Reads the bytes of a file. A missing end of a data set, or of the file, is a warning.
    ///
    /// # Errors
    /// [`RecordError::UnknownFormat`] for other files and those without any function; for a data set that contradicts
    /// the format [`RecordError::Damaged`]; [`RecordError::Unsupported`] for binary numbers that are not those of IEEE
    /// 754.
    pub fn parse(bytes: &[u8]) -> Result<Self, RecordError> {
        let mut file = Self { sets: Vec::new(), others: Vec::new(), warnings: Vec::new() };
        let mut lines = Lines::new(bytes);
        let (mut after_delimiter, mut in_stray_text, mut any) = (false, false, false);
        while let Some(line) = lines.next() {
            if is_delimiter(line.text) {
                (after_delimiter, in_stray_text) = (true, false);
                continue;
            }
            if line.text.trim_ascii().is_empty() {
                continue;
            }
            match identifier(&line).filter(|_| after_delimiter) {
                Some((58, is_binary)) => {
                    any = true;
                    file.take(is_binary, &line, &mut lines)?;
                }
                Some((number, _)) => {
                    any = true;
                    file.others.push((number, line.number));
                    while let Some(line) = lines.peek().filter(|line| !is_delimiter(line.text)) {
                        lines.pass(&line);
                    }
                }
                None if !in_stray_text => {
                    file.warnings.push(format!("line {} belongs to no data set", line.number));
                    in_stray_text = true;
                }
                None => {}
            }
            after_delimiter = false;
        }
        match (any, file.sets.is_empty()) {
            (false, _) => {
                let length = bytes.len();
                let what = format!("not a Universal File: {length} bytes without a data set between lines of -1");
                Err(RecordError::UnknownFormat { what })
            }
            (true, true) => {
                let mut others: Vec<u32> = file.others.iter().map(|(number, _)| *number).collect();
                others.sort_unstable();
                others.dedup();
                let others: Vec<String> = others.into_iter().map(|number| number.to_string()).collect();
                let others =
                    if others.is_empty() { "and no others".into() } else { format!("only {}", others.join(", ")) };
                let what = format!("the file has no data set 58 with points, {others}");
                let what = file.warnings.iter().fold(what, |what, warning| format!("{what}; {warning}"));
                Err(RecordError::UnknownFormat { what })
            }
            (true, false) => Ok(file),
        }
    }

    /// The data sets 58, in the order of the file.
    pub fn sets(&self) -> &[DataSet] {
        &self.sets
    }

    /// The other data sets, which were not read: their numbers, and the lines at which they begin.
    pub fn others(&self) -> &[(u32, u64)] {
        &self.others
    }

    /// Faults of the file that did not prevent reading it, each with its line, counted from 1.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Reads a data set up to the delimiter behind it, of which `line` is the first line.
    fn take(&mut self, is_binary: bool, line: &Line, lines: &mut Lines) -> Result<(), RecordError> {
        let begin = line.number;
        let encoding = if is_binary { Some(encoding(line)?) } else { None };
        let Some((header, form)) = records::read(lines)? else {
            self.warnings.push(format!("the file ends within the header of the data set at line {begin}"));
            return Ok(());
        };
        let numbers = match encoding {
            None => text(lines, &form, begin, &mut self.warnings)?,
            Some(encoding) => binary(lines, &form, encoding, begin, &mut self.warnings)?,
        };
        let points = numbers.chunks_exact(form.numbers());
        let (promised, present) = (form.count, points.len());
        if promised != present as u64 || present == 0 {
            self.warnings
                .push(format!("the data set at line {begin} promises {promised} points, but {present} are there"));
        }
        let count = points.clone().filter(|point| point.iter().any(|number| !number.is_finite())).count();
        if count > 0 {
            self.warnings.push(format!("the data set at line {begin} has {count} points that are not finite"));
        }
        if present > 0 {
            let (abscissa, value) = match form.even {
                Some((start, step)) => (Abscissa::Even { start, step }, 0),
                None => (Abscissa::Uneven(points.clone().map(|point| point[0]).collect()), 1),
            };
            let ordinate = if form.complex {
                Ordinate::Complex(points.map(|point| [point[value], point[value + 1]]).collect())
            } else {
                Ordinate::Real(points.map(|point| point[value]).collect())
            };
            self.sets.push(DataSet::new(header, abscissa, ordinate)?);
        }
        Ok(())
    }
}

/// The number of a data set, in its first line, and whether its points are bytes.
fn identifier(line: &Line) -> Option<(u32, bool)> {
    let text = shown(line.text);
    let word = text.split_whitespace().next()?;
    let number = word.trim_end_matches(|letter: char| letter.is_ascii_alphabetic()).parse().ok()?;
    Some((number, matches!(word, "58b" | "58B")))
}
