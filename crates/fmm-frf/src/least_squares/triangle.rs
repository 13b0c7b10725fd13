//! Small linear least squares, row by row.

/// The triangular factor R of a matrix of P columns and the right side turned with it, built up by Givens rotations: no
/// row is stored, and the matrix is not squared.
#[derive(Debug, Clone)]
pub(crate) struct Triangle<const P: usize> {
    r: [[f64; P]; P],
    right: [f64; P],
    /// Sum of the squares of the right sides of all rows.
    pub(crate) total: f64,
    /// What of that no choice of the unknowns can explain.
    pub(crate) rest: f64,
    pub(crate) rows: usize,
}

impl<const P: usize> Triangle<P> {
    pub(crate) fn new() -> Self {
        Self { r: [[0.0; P]; P], right: [0.0; P], total: 0.0, rest: 0.0, rows: 0 }
    }

    /// Adds the equation `row` · x = `right`.
    pub(crate) fn add(&mut self, mut row: [f64; P], mut right: f64) {
        self.total += right * right;
        self.rows += 1;
        for k in 0..P {
            if row[k] == 0.0 {
                continue;
            }
            let diagonal = self.r[k][k].hypot(row[k]);
            let (cosine, sine) = (self.r[k][k] / diagonal, row[k] / diagonal);
            for (above, below) in self.r[k][k..].iter_mut().zip(&mut row[k..]) {
                (*above, *below) = (cosine * *above + sine * *below, cosine * *below - sine * *above);
            }
            (self.right[k], right) = (cosine * self.right[k] + sine * right, cosine * right - sine * self.right[k]);
        }
        self.rest += right * right;
    }

    /// The unknowns; none if the rows do not determine them to better than rounding.
    pub(crate) fn solve(&self) -> Option<[f64; P]> {
        self.back_substituted(self.right)
    }

    /// (RᵀR)⁻¹, the covariance of the unknowns for right sides of unit variance; none as in [`Triangle::solve`].
    pub(crate) fn cofactors(&self) -> Option<[[f64; P]; P]> {
        // Columns of R⁻¹.
        let mut columns = [[0.0; P]; P];
        for (k, column) in columns.iter_mut().enumerate() {
            let mut unit = [0.0; P];
            unit[k] = 1.0;
            *column = self.back_substituted(unit)?;
        }
        let entry = |i: usize, j: usize| columns.iter().map(|column| column[i] * column[j]).sum();
        Some(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))))
    }

    /// The solution of R x = `right`.
    fn back_substituted(&self, right: [f64; P]) -> Option<[f64; P]> {
        let mut x = right;
        for k in (0..P).rev() {
            if !self.determines(k) {
                return None;
            }
            for j in k + 1..P {
                x[k] -= self.r[k][j] * x[j];
            }
            x[k] /= self.r[k][k];
        }
        x.iter().all(|value| value.is_finite()).then_some(x)
    }

    /// Covariance of the unknowns with the variance that the rest tells; none without a degree of freedom.
    pub(crate) fn covariance(&self) -> Option<[[f64; P]; P]> {
        let freedom = self.rows.checked_sub(P).filter(|freedom| *freedom > 0)?;
        let variance = self.rest / freedom as f64;
        Some(self.cofactors()?.map(|row| row.map(|entry| entry * variance)))
    }

    /// Whether column `k` adds to those before it more than the rounding of its own length.
    fn determines(&self, k: usize) -> bool {
        let length = (0..=k).map(|i| self.r[i][k] * self.r[i][k]).sum::<f64>().sqrt();
        self.r[k][k].abs() > 1e-13 * length
    }
}

/// gᵀ C g, the variance of a function with `gradient` g of unknowns with `covariance` C.
pub(crate) fn variance_of<const P: usize>(gradient: [f64; P], covariance: &[[f64; P]; P]) -> f64 {
    let rows = covariance.iter().zip(gradient);
    rows.map(|(row, g)| g * row.iter().zip(gradient).map(|(c, h)| c * h).sum::<f64>()).sum::<f64>().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through (0, 1), (1, 3), (2, 4), (3, 4): slope 1, intercept 3/2, residual sum of squares 1.
    #[test]
    fn a_straight_line() {
        let mut triangle = Triangle::new();
        for (x, y) in [(0.0, 1.0), (1.0, 3.0), (2.0, 4.0), (3.0, 4.0)] {
            triangle.add([1.0, x], y);
        }
        let [intercept, slope] = triangle.solve().unwrap();
        assert!((intercept - 1.5).abs() < 1e-14 && (slope - 1.0).abs() < 1e-14, "{intercept} + {slope} x");
        assert!((triangle.rest - 1.0).abs() < 1e-14 && (triangle.total - 42.0).abs() < 1e-14);
        // s² = 1/2, Σ(x − x̄)² = 5: var(slope) = 1/10, var(intercept) = s² Σx²/(n 5) = 7/20, covariance −s² x̄/5.
        let covariance = triangle.covariance().unwrap();
        for (found, expected) in covariance.iter().flatten().zip([0.35, -0.15, -0.15, 0.1]) {
            assert!((found - expected).abs() < 1e-14, "{covariance:?}");
        }
        assert!((variance_of([1.0, 1.5], &covariance) - 0.125).abs() < 1e-14);
    }

    #[test]
    fn what_is_not_determined_has_no_solution() {
        let mut triangle = Triangle::new();
        for x in 1..5 {
            triangle.add([f64::from(x), 3.0 * f64::from(x)], 1.0);
        }
        assert_eq!(triangle.solve(), None);
        assert_eq!(triangle.covariance(), None);
        let mut exact = Triangle::new();
        exact.add([2.0], 3.0);
        assert_eq!((exact.solve(), exact.covariance()), (Some([1.5]), None));
    }
}
