//! Arrays of numbers with names, as files of MATLAB and NumPy hold them, and the series in them.

mod file;

use crate::files::arrays::file::leaf;
use crate::files::clock::Clock;

pub(crate) use file::ArrayFile;

/// Notation and storage order of arrays in a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Notation {
    /// `m(2,:)` is the second row; columns are stored one after the other.
    Matlab,
    /// `m[1]` is the second row; rows are stored one after the other.
    Numpy,
}

/// A real numeric array of a file, its numbers converted to `f64` whatever their type was. (Integers beyond 2⁵³ are
/// rounded; true is 1.)
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    pub(crate) name: String,
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Vec<f64>,
    pub(crate) notation: Notation,
}

impl Array {
    /// Name of the array, with those of the structures that it lies in (`run.v`); empty for that of an npy file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Rows, columns and further dimensions: at least two in MATLAB; in NumPy one for a vector, `None` for a single
    /// number.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// All numbers: column after column in MATLAB, row after row in NumPy, whatever their order in the file was.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// True for a series of at least two numbers.
    pub(super) fn is_vector(&self) -> bool {
        self.values.len() >= 2 && self.shape.len() <= 2 && self.matrix().is_none()
    }

    /// Rows and columns, if it has at least two of both and no more dimensions.
    pub(super) fn matrix(&self) -> Option<(usize, usize)> {
        match self.shape[..] {
            [rows, columns] if rows >= 2 && columns >= 2 => Some((rows, columns)),
            _ => None,
        }
    }

    /// The series that it offers as channels: itself, or its rows or columns, whichever are longer.
    pub(super) fn offers(&self) -> Vec<Series> {
        match self.matrix() {
            Some((rows, columns)) if rows < columns => (0..rows).map(Series::Row).collect(),
            Some((_, columns)) => (0..columns).map(Series::Column).collect(),
            None if !self.is_vector() => Vec::new(),
            // One without a name cannot be called by it.
            None if self.name.is_empty() => vec![Series::Row(0)],
            None => vec![Series::Whole],
        }
    }

    /// The numbers of a series; `None` if the array does not have it, or is a matrix and no series is chosen.
    pub(super) fn series(&self, series: Series) -> Option<Vec<f64>> {
        let Some((rows, columns)) = self.matrix() else {
            // A vector is its own row or column.
            let is_series = self.is_vector() || (self.values.len() == 1 && series == Series::Whole);
            let is_first = matches!(series, Series::Whole | Series::Row(0) | Series::Column(0));
            return (is_series && is_first).then(|| self.values.clone());
        };
        let (down, across) = if self.notation == Notation::Matlab { (1, rows) } else { (columns, 1) };
        let (first, step, count) = match series {
            Series::Row(row) if row < rows => (row * down, across, columns),
            Series::Column(column) if column < columns => (column * across, down, rows),
            _ => return None,
        };
        Some(self.values.iter().skip(first).step_by(step).take(count).copied().collect())
    }
}

/// Name and size, as `data (30000×1)` in MATLAB, `data (3, 25600)` in NumPy.
impl std::fmt::Display for Array {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let between = match self.notation {
            Notation::Matlab => "×",
            Notation::Numpy => ", ",
        };
        let size = self.shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(between);
        let space = if self.name.is_empty() { "" } else { " " };
        write!(f, "{}{space}({size})", self.name)
    }
}

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

    /// True for a vector that is called time.
    pub(crate) fn is_called_time(&self) -> bool {
        self.series == Series::Whole && Clock::of(leaf(&self.array)).is_time
    }

    /// Selection written as in MATLAB (`data`, `m(:,2)` for the second column, `m(2,:)` for the second row), or as in
    /// NumPy (`data`, `m[:,1]`, `m[1]` or `m[1,:]`). Any other text is the name of an array.
    pub(crate) fn parse(text: &str, notation: Notation) -> Self {
        let text = text.trim();
        let indexed = match notation {
            Notation::Matlab => text.strip_suffix(')').and_then(|rest| rest.rsplit_once('(')),
            Notation::Numpy => text.strip_suffix(']').and_then(|rest| rest.split_once('[')),
        };
        let series = indexed.and_then(|(_, index)| match index.split_once(',') {
            None if notation == Notation::Numpy => from_zero(index, notation).map(Series::Row),
            Some((row, column)) if row.trim() == ":" => from_zero(column, notation).map(Series::Column),
            Some((row, column)) if column.trim() == ":" => from_zero(row, notation).map(Series::Row),
            _ => None,
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
            (Series::Row(row), Notation::Matlab) => format!("{name}({},:)", row.wrapping_add(1)),
            (Series::Column(column), Notation::Matlab) => format!("{name}(:,{})", column.wrapping_add(1)),
            (Series::Row(row), Notation::Numpy) => format!("{name}[{row}]"),
            (Series::Column(column), Notation::Numpy) => format!("{name}[:,{column}]"),
        }
    }
}

/// The position that a number of a row or column says, counted from 0. The one before the first in MATLAB is none that
/// an array has.
fn from_zero(number: &str, notation: Notation) -> Option<usize> {
    let number = number.trim().parse::<usize>().ok()?;
    Some(if notation == Notation::Matlab { number.wrapping_sub(1) } else { number })
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
