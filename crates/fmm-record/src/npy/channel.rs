//! Which numbers of a file of NumPy: a vector, or a row or column of a matrix.

use std::convert::Infallible;
use std::str::FromStr;

/// A vector, or a row or column of a matrix, written as NumPy writes it: `velocity`, `data[2]` for the third row,
/// `data[:,1]` for the second column. Counting begins at 0. The array of an npy file has no name: `[2]`, `[:,1]`.
/// Any other text is the name of an array.
///
/// ```
/// use fmm_record::npy::{Channel, Series};
///
/// assert_eq!(Channel::from("data[:,1]"), Channel { array: "data".into(), series: Series::Column(1) });
/// assert_eq!(Channel::from("[2]"), Channel { array: String::new(), series: Series::Row(2) });
/// assert_eq!(Channel::from("v").to_string(), "v");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Name of the array, empty for that of an npy file.
    pub array: String,
    /// Which of its numbers.
    pub series: Series,
}

/// Which numbers of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Series {
    /// All of a vector. A matrix is taken as well if it is time and one more series.
    Whole,
    /// A row of a matrix, counted from 0.
    Row(usize),
    /// A column of a matrix, counted from 0.
    Column(usize),
}

impl From<&str> for Channel {
    fn from(text: &str) -> Self {
        let text = text.trim();
        let indexed = text.strip_suffix(']').and_then(|rest| rest.split_once('['));
        let series = indexed.and_then(|(_, index)| match index.split_once(',') {
            None => index.trim().parse().ok().map(Series::Row),
            Some((row, all)) if all.trim() == ":" => row.trim().parse().ok().map(Series::Row),
            Some((all, column)) if all.trim() == ":" => column.trim().parse().ok().map(Series::Column),
            Some(_) => None,
        });
        match (indexed, series) {
            (Some((array, _)), Some(series)) => Self { array: array.trim_end().into(), series },
            _ => Self { array: text.into(), series: Series::Whole },
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
        f.write_str(&self.array)?;
        match self.series {
            Series::Whole => Ok(()),
            Series::Row(row) => write!(f, "[{row}]"),
            Series::Column(column) => write!(f, "[:,{column}]"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_notation_of_numpy_names_a_series() {
        assert_eq!(Channel::from(" a [ 1 , : ] "), Channel { array: "a".into(), series: Series::Row(1) });
        for text in ["a[-1]", "a[1,2]", "a[:]", "a[::2]", "a]", "["] {
            assert_eq!(Channel::from(text), Channel { array: text.into(), series: Series::Whole }, "{text}");
        }
    }
}
