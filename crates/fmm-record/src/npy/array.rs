//! A real numeric array.

use super::Series;

/// A real numeric array of NumPy, its numbers converted to `f64` whatever their type was. (Integers beyond 2⁵³ are
/// rounded; true is 1.)
#[derive(Debug, Clone, PartialEq)]
pub struct NpyArray {
    pub(super) name: String,
    pub(super) shape: Vec<usize>,
    pub(super) values: Vec<f64>,
}

impl NpyArray {
    /// Name of the array in its archive, empty for that of an npy file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Length along each axis; empty for a single number.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// All numbers, row after row, whatever their order in the file was.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The single number, if it is one.
    pub(super) fn scalar(&self) -> Option<f64> {
        if let [value] = self.values[..] { Some(value) } else { None }
    }

    /// Whether it is a series of at least two numbers, perhaps with a second axis of length 1.
    pub(super) fn is_vector(&self) -> bool {
        self.values.len() >= 2
            && match self.shape[..] {
                [_] => true,
                [rows, columns] => rows == 1 || columns == 1,
                _ => false,
            }
    }

    /// Rows and columns, if it has at least two of both and no more axes.
    pub(super) fn matrix(&self) -> Option<(usize, usize)> {
        match self.shape[..] {
            [rows, columns] if rows >= 2 && columns >= 2 => Some((rows, columns)),
            _ => None,
        }
    }

    /// The numbers of a series; none if the array does not have it.
    pub(super) fn series(&self, series: Series) -> Option<Vec<f64>> {
        match (series, &self.shape[..]) {
            (Series::Whole, _) => self.is_vector().then(|| self.values.clone()),
            (Series::Row(row), &[rows, columns]) => {
                (row < rows).then(|| self.values[row * columns..(row + 1) * columns].to_vec())
            }
            (Series::Column(column), &[_, columns]) => {
                (column < columns).then(|| self.values.iter().skip(column).step_by(columns).copied().collect())
            }
            _ => None,
        }
    }
}

/// Name and shape, as `data (3, 25600)`.
impl std::fmt::Display for NpyArray {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let lengths = self.shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        let space = if self.name.is_empty() { "" } else { " " };
        write!(f, "{}{space}({lengths})", self.name)
    }
}
