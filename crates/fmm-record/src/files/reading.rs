//! A reading: the record, and the choices in the file that led to it.

use crate::error::{RecordError, listed};
use crate::record::Record;
use crate::sampling::Sampling;
use crate::units::label::{Label, without_groups};

/// A record as read from a file, with the choices that led to it, so that a report can name them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Reading {
    /// The record.
    pub record: Record,
    /// Name of the column or variable that became the record.
    pub channel: String,
    /// Name of the column or variable of time stamps, if the file has one.
    pub time: Option<String>,
    /// Every column or numeric variable that the file offers.
    pub columns: Vec<String>,
    /// Source of the sampling rate.
    pub sampling: Sampling,
    /// Sentences about what was not used as it stands: damaged lines, further parts. Statements of a [`Reader`] that
    /// choose otherwise are named between backquotes.
    ///
    /// [`Reader`]: crate::Reader
    pub remarks: Vec<String>,
}

/// Label of the channel that was read.
impl From<&Reading> for Label {
    fn from(reading: &Reading) -> Self {
        Self::of(&reading.channel).with_unit(reading.record.unit()).with_quantity(reading.record.quantity())
    }
}

/// Largest size of the expanded data of one file, all together (bytes): 33 million numbers. A small file can
/// be made to expand a thousandfold; one that exceeds this limit is refused.
#[cfg(any(feature = "mat", feature = "npy", feature = "gzip", feature = "workbook"))]
pub(crate) const MOST_INFLATED: usize = 1 << 28;

/// Error of a file whose data expand to more.
#[cfg(any(feature = "mat", feature = "npy", feature = "gzip", feature = "workbook"))]
pub(crate) fn too_large() -> RecordError {
    RecordError::damaged(format!("the variables of the file expand to more than {MOST_INFLATED} bytes"))
}

/// A column of a table, by name or by position.
///
/// A name matches exactly or, if no column does, without regard to case, or else without what the column has in
/// brackets: `velocity` means `velocity [m/s]`, if no other column is called so. A position counts from **0**. Text of
/// digits only is a position, any other text is a name; a column whose *name* is a number is chosen with
/// [`Column::Name`]. In a table without a header row the names are the positions.
///
/// ```
/// use fmm_record::Column;
///
/// assert_eq!(Column::from("velocity"), Column::Name("velocity".into()));
/// assert_eq!(Column::from("1"), Column::Index(1));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Column by its name.
    Name(String),
    /// Column by its position, counted from 0.
    Index(usize),
}

/// The only position of those `found` of what is `written`; `column` is what was looked for among columns, data sets or
/// variables, as `kind` calls one.
pub(crate) fn only(found: &[usize], column: &Column, kind: &str, written: &[String]) -> Result<usize, RecordError> {
    match found {
        [index] => Ok(*index),
        [] => {
            let what = format!("there is no {kind} {column}; the file has: {}", quoted(written));
            Err(RecordError::channel(what))
        }
        _ => {
            let candidate = |index: &usize| format!("\"{}\" at position {index}", written[*index]);
            let candidates = listed(&found.iter().map(candidate).collect::<Vec<_>>());
            let count = found.len();
            let what = format!(
                "{count} {kind}s are called {column}: {candidates}; choose one by its whole name or by its position, \
                 counted from 0"
            );
            Err(RecordError::channel(what))
        }
    }
}

impl Column {
    /// Positions of the columns that are meant. They are written in one way or several, of which the first has the
    /// units; the first way of looking that finds anything counts.
    pub(crate) fn among(&self, written: &[&[String]]) -> Vec<usize> {
        let names = written.first().copied().unwrap_or_default();
        let name = match self {
            Self::Index(index) => return (0..names.len()).filter(|other| other == index).collect(),
            Self::Name(name) => name.trim(),
        };
        let lower = name.to_lowercase();
        let exact = |other: &str| other == name;
        let alike = |other: &str| other.to_lowercase() == lower;
        let bare: Vec<String> = names.iter().map(|name| without_unit(name)).collect();
        let matching = |names: &[String], same: &dyn Fn(&str) -> bool| -> Vec<usize> {
            names.iter().enumerate().filter(|(_, name)| same(name)).map(|(index, _)| index).collect()
        };
        let whole = |same: &dyn Fn(&str) -> bool| {
            written.iter().map(|names| matching(names, same)).find(|found| !found.is_empty()).unwrap_or_default()
        };
        let in_turn = [whole(&exact), whole(&alike), matching(&bare, &exact), matching(&bare, &alike)];
        in_turn.into_iter().find(|found| !found.is_empty()).unwrap_or_default()
    }
}

/// A name without what it has in brackets, and without a slash before them.
pub(crate) fn without_unit(name: &str) -> String {
    without_groups(name).0.trim_end_matches(['/', ' ']).to_owned()
}

impl From<&str> for Column {
    fn from(text: &str) -> Self {
        text.parse().map_or_else(|_| Self::Name(text.into()), Self::Index)
    }
}

impl From<usize> for Column {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

impl std::fmt::Display for Column {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Name(name) => write!(f, "\"{name}\""),
            Self::Index(index) => write!(f, "{index}"),
        }
    }
}

/// Names for an error that lists them.
pub(crate) fn quoted(names: &[String]) -> String {
    listed(&names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>())
}
