//! A real numeric array.

use super::channel::Series;

/// A real numeric array of a MATLAB file, its numbers converted to `f64` whatever their type was. (Integers beyond
/// 2⁵³ are rounded.)
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    pub(super) name: String,
    pub(super) dimensions: Vec<usize>,
    pub(super) values: Vec<f64>,
}

impl Array {
    /// Name of the variable.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Rows, columns and further dimensions; at least two.
    pub fn dimensions(&self) -> &[usize] {
        &self.dimensions
    }

    /// All numbers, column after column.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Number of rows, for an array of two dimensions.
    pub(super) fn rows(&self) -> usize {
        self.dimensions[0]
    }

    /// Number of columns, for an array of two dimensions.
    pub(super) fn columns(&self) -> usize {
        self.dimensions[1]
    }

    /// The single number, if it is one.
    pub(super) fn scalar(&self) -> Option<f64> {
        if let [value] = self.values[..] { Some(value) } else { None }
    }

    /// Whether it is a row or a column of at least two numbers.
    pub(super) fn is_vector(&self) -> bool {
        self.dimensions.len() == 2 && self.values.len() >= 2 && (self.rows() == 1 || self.columns() == 1)
    }

    /// Whether it has at least two rows and two columns and no more dimensions.
    pub(super) fn is_matrix(&self) -> bool {
        self.dimensions.len() == 2 && self.rows() >= 2 && self.columns() >= 2
    }

    /// The numbers of a series; none if the array does not have it, or is a matrix and no series is chosen.
    pub(super) fn series(&self, series: Series) -> Option<Vec<f64>> {
        if self.is_vector() {
            // A vector is its own row or column.
            return matches!(series, Series::Whole | Series::Row(1) | Series::Column(1)).then(|| self.values.clone());
        }
        let (rows, columns) = (self.rows(), self.columns());
        match series {
            Series::Whole => (self.values.len() == 1).then(|| self.values.clone()),
            Series::Row(row) => {
                let first = row.checked_sub(1).filter(|index| *index < rows)?;
                Some(self.values.iter().skip(first).step_by(rows).copied().collect())
            }
            Series::Column(column) => {
                let index = column.checked_sub(1).filter(|index| *index < columns)?;
                Some(self.values[index * rows..(index + 1) * rows].to_vec())
            }
        }
    }
}

/// Name and size, as `data (30000×1)`.
impl std::fmt::Display for Array {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let size = self.dimensions.iter().map(ToString::to_string).collect::<Vec<_>>().join("×");
        write!(f, "{} ({size})", self.name)
    }
}
