//! Which numbers of a MATLAB file: a vector, or a row or column of a matrix.

use std::convert::Infallible;
use std::str::FromStr;

use super::Array;

/// A vector, or a row or column of a matrix, written as MATLAB writes it: `data`, `NF20mm1(:,2)` for the second column,
/// `m(2,:)` for the second row. As in MATLAB, both count from 1 here. Any other text is the name of a variable.
///
/// ```
/// use fmm_record::mat::Channel;
///
/// assert_eq!(Channel::from("NF20mm1(:,2)"), Channel::column("NF20mm1", 2));
/// assert_eq!(Channel::from("run.m(2,:)"), Channel::row("run.m", 2));
/// assert_eq!(Channel::from("data"), Channel::variable("data"));
/// assert_eq!(Channel::column("NF20mm1", 2).to_string(), "NF20mm1(:,2)");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    pub(super) variable: String,
    pub(super) series: Series,
}

/// Which numbers of an array; rows and columns count from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Series {
    Whole,
    Row(usize),
    Column(usize),
}

impl Channel {
    /// A vector. A matrix is taken as well if its first column is time and it has one more, or else its first row.
    pub fn variable(name: impl Into<String>) -> Self {
        Self { variable: name.into(), series: Series::Whole }
    }

    /// A column of a matrix, counted from 1.
    pub fn column(name: impl Into<String>, column: usize) -> Self {
        Self { variable: name.into(), series: Series::Column(column) }
    }

    /// A row of a matrix, counted from 1.
    pub fn row(name: impl Into<String>, row: usize) -> Self {
        Self { variable: name.into(), series: Series::Row(row) }
    }

    /// A series of an array.
    pub(super) fn of(array: &Array, series: Series) -> Self {
        Self { variable: array.name().into(), series }
    }
}

impl From<&str> for Channel {
    fn from(text: &str) -> Self {
        let text = text.trim();
        let indexed = text.strip_suffix(')').and_then(|rest| rest.rsplit_once('('));
        let series = indexed.and_then(|(_, index)| index.split_once(',')).and_then(|(row, column)| {
            match (row.trim(), column.trim()) {
                (":", column) => column.parse().ok().map(Series::Column),
                (row, ":") => row.parse().ok().map(Series::Row),
                _ => None,
            }
        });
        match (indexed, series) {
            (Some((name, _)), Some(series)) => Self { variable: name.trim_end().into(), series },
            _ => Self::variable(text),
        }
    }
}

impl FromStr for Channel {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(Self::from(text))
    }
}

impl std::fmt::Display for Channel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.series {
            Series::Whole => f.write_str(&self.variable),
            Series::Row(row) => write!(f, "{}({row},:)", self.variable),
            Series::Column(column) => write!(f, "{}(:,{column})", self.variable),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_notation_of_matlab_names_a_series() {
        assert_eq!(Channel::from(" a ( : , 12 ) "), Channel::column("a", 12));
        assert_eq!(Channel::from("a(2).b( 1,: )"), Channel::row("a(2).b", 1));
        for text in ["a(1,1)", "a(:,x)", "a(2).b", "a(:,1).b", "a(:)", "a:2", "a(:,-1)", "(", ")", ""] {
            assert_eq!(Channel::from(text), Channel::variable(text), "{text:?}");
        }
    }
}
