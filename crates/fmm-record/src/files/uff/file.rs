//! The data sets of a Universal File.

use std::path::Path;

use super::binary::Encoding;
use super::lines::{Line, Lines, is_delimiter};
use super::records::shown;
use super::{Abscissa, DataSet, Warning, ascii, binary, records};
use crate::RecordError;

/// All data sets 58 of a Universal File, and what else there is.
#[derive(Debug, Clone, PartialEq)]
pub struct UffFile {
    sets: Vec<DataSet>,
    others: Vec<(u32, u64)>,
    warnings: Vec<Warning>,
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

    /// Reads the bytes of a file. A missing end of a data set, or of the file, is a [`Warning`].
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
            match Identifier::of(&line).filter(|_| after_delimiter) {
                Some(identifier) => {
                    any = true;
                    file.take(&identifier, &line, &mut lines)?;
                }
                None if !in_stray_text => {
                    file.warnings.push(Warning::Stray { line: line.number });
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

    /// The data sets 58 without their file.
    pub fn into_sets(self) -> Vec<DataSet> {
        self.sets
    }

    /// The other data sets, which were not read: their numbers, and the lines at which they begin.
    pub fn others(&self) -> &[(u32, u64)] {
        &self.others
    }

    /// Faults of the file that did not prevent reading it.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Reads a data set up to the delimiter behind it, of which `line` is the first line.
    fn take(&mut self, identifier: &Identifier, line: &Line, lines: &mut Lines) -> Result<(), RecordError> {
        let begin = line.number;
        let encoding = match identifier {
            Identifier::Function => None,
            Identifier::BinaryFunction => Some(Encoding::of(line)?),
            Identifier::Other(number) => {
                self.others.push((*number, begin));
                while let Some(line) = lines.peek().filter(|line| !is_delimiter(line.text)) {
                    lines.pass(&line);
                }
                return Ok(());
            }
        };
        let Some((header, form)) = records::read(lines)? else {
            self.warnings.push(Warning::HeaderCut { line: begin });
            return Ok(());
        };
        let points = match encoding {
            None => ascii::read(lines, &form, begin, &mut self.warnings)?,
            Some(encoding) => binary::read(lines, &form, &encoding, begin, &mut self.warnings)?,
        };
        let present = points.len();
        if form.count != present as u64 || present == 0 {
            self.warnings.push(Warning::FewerPoints { line: begin, promised: form.count, present });
        }
        let count = points.not_finite();
        if count > 0 {
            self.warnings.push(Warning::NotFinite { line: begin, count });
        }
        if present > 0 {
            let (abscissae, ordinate) = points.into_parts();
            let abscissa = match form.even {
                Some((start, step)) => Abscissa::Even { start, step },
                None => Abscissa::Uneven(abscissae),
            };
            self.sets.push(DataSet::new(header, abscissa, ordinate)?.with_precision(form.precision));
        }
        Ok(())
    }
}

/// The number of a data set, in its first line.
enum Identifier {
    Function,
    BinaryFunction,
    Other(u32),
}

impl Identifier {
    fn of(line: &Line) -> Option<Self> {
        let text = shown(line.text);
        match text.split_whitespace().next()? {
            "58" => Some(Self::Function),
            "58b" | "58B" => Some(Self::BinaryFunction),
            word => word.trim_end_matches(|letter: char| letter.is_ascii_alphabetic()).parse().ok().map(Self::Other),
        }
    }
}
