//! What a reader hands over: the record, and what it chose in the file to get it.

use std::convert::Infallible;
use std::str::FromStr;

use crate::{Record, Sampling};

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
    /// How the sampling rate was found.
    pub sampling: Sampling,
}

/// The choices that all readers offer, as methods of a builder with fields of these names; `$column` is how a format
/// names a column.
#[cfg(any(feature = "csv", feature = "mat", feature = "npy"))]
macro_rules! builder_of_choices {
    ($column:ty) => {
        /// The column to read.
        #[must_use]
        pub fn channel(mut self, column: impl Into<$column>) -> Self {
            self.channel = Some(column.into());
            self
        }

        /// The column of time stamps, in seconds unless its name tells another unit.
        #[must_use]
        pub fn time(mut self, column: impl Into<$column>) -> Self {
            self.time = Some(column.into());
            self
        }

        /// The sampling rate (Hz).
        #[must_use]
        pub fn rate(mut self, rate: f64) -> Self {
            self.rate = Some(rate);
            self
        }

        /// What the channel measured.
        #[must_use]
        pub fn quantity(mut self, quantity: Quantity) -> Self {
            self.quantity = quantity;
            self
        }

        /// Unit of the numbers in the channel.
        #[must_use]
        pub fn unit(mut self, unit: impl Into<String>) -> Self {
            self.unit = unit.into();
            self
        }
    };
}
#[cfg(any(feature = "csv", feature = "mat", feature = "npy"))]
pub(crate) use builder_of_choices;

/// How many bytes the compressed data of one file may expand to, all together: 33 million numbers. A small file can
/// be made to expand a thousandfold; one that exceeds this limit is refused.
#[cfg(any(feature = "mat", feature = "npy"))]
pub const MOST_INFLATED: usize = 1 << 28;

/// A column of a table, by name or by position.
///
/// A name matches exactly or, if no column does, without regard to case; a position counts from **0**. Text of
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
    /// By name.
    Name(String),
    /// By position, counted from 0.
    Index(usize),
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

impl FromStr for Column {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(Self::from(text))
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

/// Whether `name` calls a column or variable of time stamps, and if so how many seconds its unit has: `t`,
/// `time`, `Zeit`, alone or followed by a unit as in `t_s`, `time (ms)`, `Time [s]` or `t/s`.
#[cfg(any(feature = "csv", feature = "mat", feature = "npy"))]
pub(crate) fn seconds_per_unit_of_time(name: &str) -> Option<f64> {
    const WORDS: [&str; 3] = ["time", "zeit", "t"];
    let lower = name.trim().to_lowercase();
    let rest = WORDS.iter().find_map(|word| {
        let rest = lower.strip_prefix(word)?;
        rest.chars().next().is_none_or(|next| !next.is_alphanumeric()).then_some(rest)
    })?;
    seconds_in(rest.trim_matches(|c: char| !c.is_alphanumeric()))
}

/// How many seconds a unit of time has, in lower case; no unit means seconds.
pub(crate) fn seconds_in(unit: &str) -> Option<f64> {
    const UNITS: [(&str, f64); 10] = [
        ("", 1.0),
        ("s", 1.0),
        ("sec", 1.0),
        ("second", 1.0),
        ("seconds", 1.0),
        ("ms", 1e-3),
        ("us", 1e-6),
        ("µs", 1e-6),
        ("μs", 1e-6),
        ("ns", 1e-9),
    ];
    UNITS.iter().find(|(known, _)| *known == unit).map(|(_, seconds)| *seconds)
}

/// Names for an error that lists them.
#[cfg(any(feature = "csv", feature = "uff"))]
pub(crate) fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

/// Brings time stamps to seconds from the unit that the `name` of their column tells, if it tells one.
#[cfg(any(feature = "csv", feature = "mat", feature = "npy"))]
pub(crate) fn to_seconds(name: &str, times: &mut [f64]) {
    let scale = seconds_per_unit_of_time(name).unwrap_or(1.0);
    if scale != 1.0 {
        for time in times {
            *time *= scale;
        }
    }
}

#[cfg(all(test, any(feature = "csv", feature = "mat", feature = "npy")))]
mod tests {
    use super::*;

    #[test]
    fn names_of_time_are_known_with_their_units() {
        for name in ["t", "T", "time", "t_s", "time_s", "Time (s)", "t [s]", "t/s", "Zeit", " Zeit [s] ", "TIME"] {
            assert_eq!(seconds_per_unit_of_time(name), Some(1.0), "{name}");
        }
        assert_eq!(seconds_per_unit_of_time("time_ms"), Some(1e-3));
        assert_eq!(seconds_per_unit_of_time("t [µs]"), Some(1e-6));
        for name in ["theta", "t_coil", "velocity", "timer", "", "trial", "time constant"] {
            assert_eq!(seconds_per_unit_of_time(name), None, "{name}");
        }
    }
}
