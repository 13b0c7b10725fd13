//! Cholesky's factor of a banded matrix, to make correlated equations independent.

/// Lower factor L of a symmetric positive definite matrix Σ = L Lᵀ with few diagonals.
///
/// # Why not a library
/// nalgebra and faer factor full matrices: with 8 diagonals beside the main one nalgebra takes 4.6 times as long at 100
/// rows and 58 times at 400. `benches/peers` of the workspace measures it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BandedFactor {
    /// Row i holds L_{i, i−width} … L_{i,i}; what lies before the first column is zero.
    rows: Vec<Vec<f64>>,
    width: usize,
}

impl BandedFactor {
    /// The factor of the matrix of `count` rows with `element(i, j)` for i − width ≤ j ≤ i; `None` unless it is
    /// positive definite beyond rounding.
    pub(crate) fn of(count: usize, width: usize, element: impl Fn(usize, usize) -> f64) -> Option<Self> {
        let mut factor = Self { rows: Vec::with_capacity(count), width };
        for i in 0..count {
            let mut row = vec![0.0; width + 1];
            let diagonal = element(i, i);
            for j in i.saturating_sub(width)..i {
                let earlier: f64 = (i.saturating_sub(width)..j).map(|k| row[k + width - i] * factor.at(j, k)).sum();
                row[j + width - i] = (element(i, j) - earlier) / factor.rows[j][width];
            }
            let rest = diagonal - row.iter().map(|element| element * element).sum::<f64>();
            row[width] = (rest > 1e-12 * diagonal && rest.is_finite()).then(|| rest.sqrt())?;
            factor.rows.push(row);
        }
        Some(factor)
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        if j + self.width < i { 0.0 } else { self.rows[i][j + self.width - i] }
    }

    /// L⁻¹ y.
    pub(crate) fn whiten(&self, y: &[f64]) -> Vec<f64> {
        let mut white: Vec<f64> = Vec::with_capacity(y.len());
        for (i, y) in y.iter().enumerate() {
            let earlier: f64 = (i.saturating_sub(self.width)..i).map(|j| self.at(i, j) * white[j]).sum();
            white.push((y - earlier) / self.rows[i][self.width]);
        }
        white
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factor_gives_the_matrix_back() {
        let element = |i: usize, j: usize| match i - j {
            0 => 4.0 + i as f64,
            1 => -1.0,
            2 => 0.5,
            _ => 0.0,
        };
        let factor = BandedFactor::of(6, 2, element).unwrap();
        for i in 0..6usize {
            for j in 0..=i {
                let product: f64 = (0..=j).map(|k| factor.at(i, k) * factor.at(j, k)).sum();
                assert!((product - element(i, j)).abs() < 1e-14, "({i}, {j}): {product}");
            }
        }
        let y = [1.0, -2.0, 0.5, 3.0, 0.0, 1.0];
        let white = factor.whiten(&y);
        for (i, y) in y.iter().enumerate() {
            let back: f64 = (0..=i).map(|k| factor.at(i, k) * white[k]).sum();
            assert!((back - y).abs() < 1e-14);
        }
    }

    #[test]
    fn what_is_not_positive_definite_has_none() {
        assert_eq!(BandedFactor::of(2, 1, |_, _| 1.0), None);
        assert_eq!(BandedFactor::of(1, 0, |_, _| f64::NAN), None);
    }
}
