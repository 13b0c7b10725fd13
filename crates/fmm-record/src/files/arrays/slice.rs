//! Slice of an array in a file: a vector, or a row or column of a matrix.

use super::reader::leaf;
use super::{Array, Notation};
use crate::files::clock::Clock;

/// A vector, or a row or column of a matrix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Slice {
    /// Name of the array, empty for that of an npy file.
    pub(crate) array: String,
    pub(crate) series: Series,
}

/// Selection of numbers of an array; rows and columns count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Series {
    /// All of a vector. A matrix is taken as well if it is time and one more series.
    Whole,
    Row(usize),
    Column(usize),
}

impl Slice {
    /// A series of an array.
    pub(super) fn of(array: &Array, series: Series) -> Self {
        Self { array: array.name().into(), series }
    }

    /// Whether it is a vector that is called time.
    pub(crate) fn is_called_time(&self) -> bool {
        self.series == Series::Whole && Clock::of(leaf(&self.array)).is_time
    }

    /// Selection written as in MATLAB (`data`, `m(:,2)` for the second column, `m(2,:)` for the second row), or as in
    /// NumPy (`data`, `m[:,1]`, `m[1]` or `m[1,:]`). Any other text is the name of an array.
    pub(crate) fn parse(text: &str, notation: Notation) -> Self {
        let text = text.trim();
        let indexed = match notation {
            #[cfg(feature = "mat")]
            Notation::Matlab => text.strip_suffix(')').and_then(|rest| rest.rsplit_once('(')),
            #[cfg(feature = "npy")]
            Notation::Numpy => text.strip_suffix(']').and_then(|rest| rest.split_once('[')),
        };
        let series = indexed.and_then(|(_, index)| match index.split_once(',') {
            #[cfg(feature = "npy")]
            None if notation == Notation::Numpy => from_zero(index, notation).map(Series::Row),
            None => None,
            Some((row, column)) if row.trim() == ":" => from_zero(column, notation).map(Series::Column),
            Some((row, column)) if column.trim() == ":" => from_zero(row, notation).map(Series::Row),
            Some(_) => None,
        });
        match (indexed, series) {
            (Some((array, _)), Some(series)) => Self { array: array.trim_end().into(), series },
            _ => Self { array: text.into(), series: Series::Whole },
        }
    }

    /// The text that [`Slice::parse`] reads.
    pub(crate) fn written(&self, notation: Notation) -> String {
        let name = &self.array;
        match (self.series, notation) {
            (Series::Whole, _) => name.clone(),
            #[cfg(feature = "mat")]
            (Series::Row(row), Notation::Matlab) => format!("{name}({},:)", row.wrapping_add(1)),
            #[cfg(feature = "mat")]
            (Series::Column(column), Notation::Matlab) => format!("{name}(:,{})", column.wrapping_add(1)),
            #[cfg(feature = "npy")]
            (Series::Row(row), Notation::Numpy) => format!("{name}[{row}]"),
            #[cfg(feature = "npy")]
            (Series::Column(column), Notation::Numpy) => format!("{name}[:,{column}]"),
        }
    }
}

/// The position that a number of a row or column says, counted from 0. The one before the first in MATLAB is none that
/// an array has.
fn from_zero(number: &str, notation: Notation) -> Option<usize> {
    let number = number.trim().parse::<usize>().ok()?;
    Some(match notation {
        #[cfg(feature = "mat")]
        Notation::Matlab => number.wrapping_sub(1),
        #[cfg(feature = "npy")]
        Notation::Numpy => number,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(notation: Notation, written: &[(&str, &str, Series)], names: &[&str]) {
        for (text, array, series) in written {
            assert_eq!(Slice::parse(text, notation), Slice { array: (*array).into(), series: *series }, "{text}");
        }
        for text in names {
            assert_eq!(Slice::parse(text, notation), Slice { array: (*text).into(), series: Series::Whole }, "{text}");
        }
    }

    #[cfg(feature = "mat")]
    #[test]
    fn only_the_notation_of_matlab_names_a_series() {
        let written = [
            ("NF20mm1(:,2)", "NF20mm1", Series::Column(1)),
            (" a ( : , 12 ) ", "a", Series::Column(11)),
            ("a(2).b( 1,: )", "a(2).b", Series::Row(0)),
        ];
        let names =
            ["a(1,1)", "a(:,x)", "a(2).b", "a(:,1).b", "a(:)", "a:2", "a(:,-1)", "(", ")", "", "data", "a[1]", "[:,1]"];
        check(Notation::Matlab, &written, &names);
        assert_eq!(Slice::parse("a(:,2)", Notation::Matlab).written(Notation::Matlab), "a(:,2)");
    }

    #[cfg(feature = "npy")]
    #[test]
    fn only_the_notation_of_numpy_names_a_series() {
        let written = [
            ("data[:,1]", "data", Series::Column(1)),
            ("[2]", "", Series::Row(2)),
            (" a [ 1 , : ] ", "a", Series::Row(1)),
        ];
        check(Notation::Numpy, &written, &["a[-1]", "a[1,2]", "a[:]", "a[::2]", "a]", "[", "v", "a(:,2)"]);
        assert_eq!(Slice::parse("a[1,:]", Notation::Numpy).written(Notation::Numpy), "a[1]");
    }
}
