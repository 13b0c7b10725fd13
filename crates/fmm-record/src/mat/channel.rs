//! Which numbers of a MATLAB file: a vector, or a column of a matrix.

use std::convert::Infallible;
use std::str::FromStr;

/// A vector, or a column of a matrix, written as MATLAB writes it: `data`, or `NF20mm1(:,2)` for the second
/// column. As in MATLAB, columns count from 1 here. Any other text is the name of a variable.
///
/// ```
/// use fmm_record::mat::Channel;
///
/// assert_eq!(Channel::from("NF20mm1(:,2)"), Channel::column("NF20mm1", 2));
/// assert_eq!(Channel::from("data"), Channel::variable("data"));
/// assert_eq!(Channel::column("NF20mm1", 2).to_string(), "NF20mm1(:,2)");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    pub(super) variable: String,
    pub(super) column: Option<usize>,
}

impl Channel {
    /// A vector. A matrix is taken as well if its first column is time and it has one more.
    pub fn variable(name: impl Into<String>) -> Self {
        Self { variable: name.into(), column: None }
    }

    /// A column of a matrix, counted from 1.
    pub fn column(name: impl Into<String>, column: usize) -> Self {
        Self { variable: name.into(), column: Some(column) }
    }
}

impl From<&str> for Channel {
    fn from(text: &str) -> Self {
        let text = text.trim();
        let indexed = text.strip_suffix(')').and_then(|rest| rest.split_once('('));
        let column = indexed
            .and_then(|(_, index)| index.split_once(','))
            .and_then(|(rows, column)| if rows.trim() == ":" { column.trim().parse().ok() } else { None });
        match (indexed, column) {
            (Some((name, _)), Some(column)) => Self::column(name.trim_end(), column),
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
        match self.column {
            Some(column) => write!(f, "{}(:,{column})", self.variable),
            None => f.write_str(&self.variable),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_notation_of_matlab_names_a_column() {
        assert_eq!(Channel::from(" a ( : , 12 ) "), Channel::column("a", 12));
        for text in ["a(1,:)", "a(:,x)", "a(:)", "a:2", "a(:,-1)", "(", ")", ""] {
            assert_eq!(Channel::from(text), Channel::variable(text), "{text:?}");
        }
    }
}
