//! A real numeric array.

use super::Series;

/// Notation and storage order of arrays in a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Notation {
    /// `m(2,:)` is the second row; columns are stored one after the other.
    #[cfg(feature = "mat")]
    Matlab,
    /// `m[1]` is the second row; rows are stored one after the other.
    #[cfg(feature = "npy")]
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

    /// The single number, if it is one.
    pub(super) fn scalar(&self) -> Option<f64> {
        if let [value] = self.values[..] { Some(value) } else { None }
    }

    /// Whether it is a series of at least two numbers.
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
        let is_there = match series {
            Series::Whole => false,
            Series::Row(row) => row < rows,
            Series::Column(column) => column < columns,
        };
        let (first, step, count) = match (series, self.notation) {
            (Series::Whole, _) => return None,
            _ if !is_there => return None,
            #[cfg(feature = "mat")]
            (Series::Row(row), Notation::Matlab) => (row, rows, columns),
            #[cfg(feature = "mat")]
            (Series::Column(column), Notation::Matlab) => (column * rows, 1, rows),
            #[cfg(feature = "npy")]
            (Series::Row(row), Notation::Numpy) => (row * columns, 1, columns),
            #[cfg(feature = "npy")]
            (Series::Column(column), Notation::Numpy) => (column, columns, rows),
        };
        Some(self.values.iter().skip(first).step_by(step).take(count).copied().collect())
    }
}

/// Name and size, as `data (30000×1)` in MATLAB, `data (3, 25600)` in NumPy.
impl std::fmt::Display for Array {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let between = match self.notation {
            #[cfg(feature = "mat")]
            Notation::Matlab => "×",
            #[cfg(feature = "npy")]
            Notation::Numpy => ", ",
        };
        let size = self.shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(between);
        let space = if self.name.is_empty() { "" } else { " " };
        write!(f, "{}{space}({size})", self.name)
    }
}
