//! QR factorisation of tall matrices, a block of rows at a time.

/// Rows per block: a block of a dozen columns stays in the first-level cache.
const BLOCK_ROWS: usize = 256;

/// The triangle `R`, `q = Qᵀ r` and `‖r − Q q‖` of a matrix `J = Q R` and a vector `r`.
///
/// Rows are folded in by Householder reflections of the stack of triangle and block, so `J` is read once, never
/// copied whole and need not be there at once. The order of operations is fixed: results are reproducible.
///
/// ```text
/// ⎡ R  q ⎤     order p, row by row, p + 1 numbers each
/// ⎣ 0  ρ ⎦
/// ```
///
/// # Why not a library
/// Built for any x86-64, from 1500 × 3 to 45 000 × 6 this takes a third to two thirds of the time of nalgebra's
/// factorisation and less than a fifth of that of faer's, which is sequential here and meant for larger matrices; at
/// 225 000 × 12 about a fifth of either. It needs one block of memory beside the Jacobian where they need a copy of it, and
/// the blocks of a joint fit are reduced without their zeros, five records of 45 000 × 4 six times faster than as one
/// matrix. `benches/least_squares.rs` of the workspace measures it.
///
/// # References
/// J. Demmel, L. Grigori, M. Hoemmen, J. Langou, "Communication-optimal parallel and sequential QR and LU
/// factorizations", SIAM J. Sci. Comput. 34 (2012) A206, <https://doi.org/10.1137/080731992> (flat tree).
#[derive(Debug, Clone, Default)]
pub(crate) struct Triangle {
    order: usize,
    entries: Vec<f64>,
}

impl Triangle {
    /// Empties the triangle and makes it one of `order` columns.
    pub(crate) fn reset(&mut self, order: usize) {
        self.order = order;
        self.entries.clear();
        self.entries.resize((order + 1) * (order + 1), 0.0);
    }

    /// Takes over the numbers of another triangle.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.order = other.order;
        self.entries.clear();
        self.entries.extend_from_slice(&other.entries);
    }

    pub(crate) fn order(&self) -> usize {
        self.order
    }

    /// `R[row][column]`.
    pub(crate) fn r(&self, row: usize, column: usize) -> f64 {
        self.entries[row * (self.order + 1) + column]
    }

    /// `q[row]`, the component of the residual along the row's direction.
    pub(crate) fn q(&self, row: usize) -> f64 {
        self.r(row, self.order)
    }

    /// Whether every number is finite; one that is not in `J` or `r` always shows here.
    pub(crate) fn is_finite(&self) -> bool {
        self.entries.iter().all(|entry| entry.is_finite())
    }

    /// Euclidean norm of a column of `J`.
    pub(crate) fn column_norm(&self, column: usize) -> f64 {
        (0..=column).map(|row| self.r(row, column).powi(2)).sum::<f64>().sqrt()
    }

    /// Euclidean norm of `r`.
    pub(crate) fn residual_norm(&self) -> f64 {
        (0..=self.order).map(|row| self.q(row).powi(2)).sum::<f64>().sqrt()
    }

    /// `(Jᵀ r)[column]`.
    pub(crate) fn gradient(&self, column: usize) -> f64 {
        (0..=column).map(|row| self.r(row, column) * self.q(row)).sum()
    }

    /// `R p`, one row of it.
    pub(crate) fn row_times(&self, row: usize, p: &[f64]) -> f64 {
        (row..self.order).map(|column| self.r(row, column) * p[column]).sum()
    }

    /// The `p` that solves `R p = −q`; not finite if `R` is singular.
    pub(crate) fn solve(&self, p: &mut [f64]) {
        for row in (0..self.order).rev() {
            let sum: f64 = (row + 1..self.order).map(|column| self.r(row, column) * p[column]).sum();
            p[row] = (-self.q(row) - sum) / self.r(row, row);
        }
    }

    /// Overwrites `w` with the solution `z` of `Rᵀ z = w`.
    pub(crate) fn solve_transposed(&self, w: &mut [f64]) {
        for row in 0..self.order {
            let sum: f64 = (0..row).map(|above| self.r(above, row) * w[above]).sum();
            w[row] = (w[row] - sum) / self.r(row, row);
        }
    }

    /// The factor of the given columns of `jacobian` (column after column, as long as `residuals`) and of
    /// `residuals`; `block` is scratch.
    pub(crate) fn factor(&mut self, jacobian: &[f64], columns: &[usize], residuals: &[f64], block: &mut Vec<f64>) {
        self.reset(columns.len());
        let length = residuals.len();
        for first in (0..length).step_by(BLOCK_ROWS) {
            let last = (first + BLOCK_ROWS).min(length);
            block.clear();
            for column in columns {
                block.extend_from_slice(&jacobian[column * length + first..column * length + last]);
            }
            block.extend_from_slice(&residuals[first..last]);
            self.fold(block);
        }
    }

    /// The factor of some columns of `other` with `q` replaced by `right(row)`; `block` is scratch.
    pub(crate) fn select(
        &mut self,
        other: &Self,
        columns: &[usize],
        right: impl Fn(usize) -> f64,
        block: &mut Vec<f64>,
    ) {
        block.clear();
        for &column in columns {
            block.extend((0..other.order).map(|row| if row > column { 0.0 } else { other.r(row, column) }));
        }
        block.extend((0..other.order).map(right));
        self.reset(columns.len());
        self.fold(block);
    }

    /// Folds in the rows of a smaller triangle whose columns are those at `places` here, in ascending order; `block` is
    /// scratch.
    pub(crate) fn merge(&mut self, other: &Self, places: &[usize], block: &mut Vec<f64>) {
        let rows = other.order + 1;
        block.clear();
        block.resize(rows * (self.order + 1), 0.0);
        for (column, &place) in places.iter().chain(std::iter::once(&self.order)).enumerate() {
            for (row, entry) in block[place * rows..][..=column].iter_mut().enumerate() {
                *entry = other.r(row, column);
            }
        }
        self.fold(block);
    }

    /// Folds in more rows of `[J r]`, given column after column; the block is overwritten.
    pub(crate) fn fold(&mut self, block: &mut [f64]) {
        let width = self.order + 1;
        let rows = block.len() / width;
        for k in 0..width {
            let (head, tail) = block.split_at_mut((k + 1) * rows);
            let pivot = &head[k * rows..];
            let square = dot(pivot, pivot);
            if square == 0.0 {
                continue;
            }
            let line = &mut self.entries[k * width..(k + 1) * width];
            let diagonal = line[k];
            let norm = (diagonal * diagonal + square).sqrt();
            let reflected = if diagonal > 0.0 { -norm } else { norm };
            let lead = diagonal - reflected;
            // 2/‖v‖² of the reflecting vector v = (lead, pivot).
            let factor = 1.0 / (norm * (norm + diagonal.abs()));
            line[k] = reflected;
            for (entry, column) in line[k + 1..].iter_mut().zip(tail.chunks_exact_mut(rows)) {
                let along = (lead * *entry + dot(pivot, column)) * factor;
                *entry -= along * lead;
                for (c, v) in column.iter_mut().zip(pivot) {
                    *c -= along * v;
                }
            }
        }
    }
}

/// Scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    sum_of(a, b, |x, y| x * y)
}

/// `½ (‖a‖² − ‖b‖²)` without the cancellation of two large sums.
pub(crate) fn half_difference_of_squares(a: &[f64], b: &[f64]) -> f64 {
    0.5 * sum_of(a, b, |x, y| (x - y) * (x + y))
}

/// Sum of `term` over both slices in eight interleaved sums, which vectorises and always adds in the same order.
fn sum_of(a: &[f64], b: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    let (a_lanes, a_rest) = a.as_chunks::<8>();
    let (b_lanes, b_rest) = b.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for (x, y) in a_lanes.iter().zip(b_lanes) {
        for lane in 0..8 {
            sums[lane] += term(x[lane], y[lane]);
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| term(*x, *y)).sum();
    ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7])) + rest
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// Vandermonde columns of a long abscissa, residual and all; 2500 rows make ten blocks.
    fn tall() -> (Vec<f64>, Vec<f64>) {
        let n = 2500;
        let x = |i: usize| i as f64 / n as f64;
        let jacobian = (0..6).flat_map(|j| (0..n).map(move |i| x(i).powi(j))).collect();
        let residuals = (0..n).map(|i| (7.0 * x(i)).sin()).collect();
        (jacobian, residuals)
    }

    #[test]
    fn triangle_is_that_of_a_dense_factorisation() {
        let (jacobian, residuals) = tall();
        let mut triangle = Triangle::default();
        triangle.factor(&jacobian, &[0, 1, 2, 3, 4, 5], &residuals, &mut Vec::new());
        let dense = DMatrix::from_column_slice(2500, 6, &jacobian).qr();
        let q = dense.q().transpose() * DVector::from_column_slice(&residuals);
        let r = dense.r();
        for row in 0..6 {
            // Rows are determined up to their sign.
            let sign = (r[(row, row)] * triangle.r(row, row)).signum();
            for column in row..6 {
                let difference = triangle.r(row, column) - sign * r[(row, column)];
                // Both are backward stable: a modest multiple of eps times the norm of the column, 50.
                assert!(difference.abs() < 1e-12, "R[{row}][{column}] differs by {difference}");
            }
            // q inherits the conditioning of its row, here about 1e5.
            assert!((triangle.q(row) - sign * q[row]).abs() < 1e-9);
        }
        let norm = residuals.iter().map(|r| r * r).sum::<f64>().sqrt();
        assert!((triangle.residual_norm() - norm).abs() < 1e-13 * norm);
        let gradient: f64 = jacobian[2500..5000].iter().zip(&residuals).map(|(a, b)| a * b).sum();
        assert!((triangle.gradient(1) - gradient).abs() < 1e-12 * norm * 50.0);
    }

    #[test]
    fn splitting_into_blocks_changes_rounding_only() {
        let (jacobian, residuals) = tall();
        let mut blockwise = Triangle::default();
        blockwise.factor(&jacobian, &[0, 1, 2, 3, 4, 5], &residuals, &mut Vec::new());
        let mut whole = Triangle::default();
        whole.reset(6);
        let mut block = jacobian;
        block.extend_from_slice(&residuals);
        whole.fold(&mut block);
        for (a, b) in blockwise.entries.iter().zip(&whole.entries) {
            assert!((a.abs() - b.abs()).abs() < 1e-11, "{a} against {b}");
        }
    }

    #[test]
    fn a_non_finite_entry_is_always_seen() {
        for bad in [f64::NAN, f64::INFINITY, 1e200] {
            let (mut jacobian, residuals) = tall();
            jacobian[4 * 2500 + 1777] = bad;
            let mut triangle = Triangle::default();
            triangle.factor(&jacobian, &[0, 1, 4], &residuals, &mut Vec::new());
            assert!(!triangle.is_finite(), "{bad} went unseen");
        }
    }
}
