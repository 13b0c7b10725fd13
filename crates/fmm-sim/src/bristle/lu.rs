//! Small dense linear systems: factored in plain numbers, solved for numbers with derivatives.

use fmm_model::Scalar;

/// The factors of a square matrix, by Gaussian elimination with partial pivoting.
///
/// # Why not a library
/// Right sides carry derivatives, and memory is used again from step to step: nalgebra takes 1.9, 1.6 and 1.2 times as long at 3, 6 and 12
/// rows of plain numbers. `benches/peers` of the workspace measures it.
#[derive(Debug, Clone, Default)]
pub(super) struct Factors {
    size: usize,
    /// Row by row: below the diagonal the multipliers, on it the inverses of the pivots, above it the upper factor.
    entries: Vec<f64>,
    swaps: Vec<usize>,
}

impl Factors {
    /// Makes room for a matrix of `size` rows and gives it, row by row, to be filled before [`factor`](Self::factor).
    pub(super) fn matrix(&mut self, size: usize) -> &mut [f64] {
        self.size = size;
        self.entries.resize(size * size, 0.0);
        &mut self.entries
    }

    /// Factors the matrix. False if it is singular or not finite.
    pub(super) fn factor(&mut self) -> bool {
        // Loops of the usual lengths, for laws of one state, are unrolled.
        match self.size {
            2 => self.factor_rows(2),
            4 => self.factor_rows(4),
            size => self.factor_rows(size),
        }
    }

    #[expect(clippy::inline_always, reason = "loops of known lengths are unrolled only where they are inlined")]
    #[inline(always)]
    fn factor_rows(&mut self, size: usize) -> bool {
        self.swaps.clear();
        for column in 0..size {
            let entry = |row: usize| self.entries[row * size + column].abs();
            let mut pivot = column;
            for row in column + 1..size {
                if entry(row) > entry(pivot) {
                    pivot = row;
                }
            }
            self.swaps.push(pivot);
            if pivot != column {
                for k in 0..size {
                    self.entries.swap(pivot * size + k, column * size + k);
                }
            }
            let inverse = 1.0 / self.entries[column * size + column];
            if !(inverse.is_finite() && inverse != 0.0) {
                return false;
            }
            self.entries[column * size + column] = inverse;
            let (upper, lower) = self.entries.split_at_mut((column + 1) * size);
            let pivot_row = &upper[column * size + column + 1..];
            for row in lower.chunks_exact_mut(size) {
                let multiplier = row[column] * inverse;
                if multiplier != 0.0 {
                    for (entry, pivot) in row[column + 1..].iter_mut().zip(pivot_row) {
                        *entry -= multiplier * pivot;
                    }
                }
                row[column] = multiplier;
            }
        }
        true
    }

    /// Replaces `right` by the solution for it.
    pub(super) fn solve<D: Scalar>(&self, right: &mut [D]) {
        match self.size {
            2 => self.solve_rows(2, right),
            4 => self.solve_rows(4, right),
            size => self.solve_rows(size, right),
        }
    }

    #[expect(clippy::inline_always, reason = "loops of known lengths are unrolled only where they are inlined")]
    #[inline(always)]
    fn solve_rows<D: Scalar>(&self, size: usize, right: &mut [D]) {
        let (right, entries) = (&mut right[..size], &self.entries[..size * size]);
        for (row, pivot) in self.swaps.iter().enumerate() {
            right.swap(row, *pivot);
        }
        for row in 0..size {
            let mut sum = right[row];
            for (factor, known) in entries[row * size..row * size + row].iter().zip(&right[..row]) {
                sum -= *known * *factor;
            }
            right[row] = sum;
        }
        for row in (0..size).rev() {
            let mut sum = right[row];
            let upper = &entries[row * size + row + 1..(row + 1) * size];
            for (factor, known) in upper.iter().zip(&right[row + 1..]) {
                sum -= *known * *factor;
            }
            right[row] = sum * entries[row * size + row];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    #[test]
    fn solves_what_needs_pivots_with_derivatives() {
        let rows = [[0.0, 2.0, 1.0], [4.0, -1.0, 3.0], [2.0, 2.0, -5.0]];
        let expected = [Dual::<2>::variable(3.0, 0), Dual::variable(-1.0, 1), Dual::from(0.5)];
        let mut right = [Dual::from(0.0); 3];
        for (right, row) in right.iter_mut().zip(rows) {
            for (factor, known) in row.iter().zip(expected) {
                *right += known * *factor;
            }
        }
        let mut factors = Factors::default();
        factors.matrix(3).copy_from_slice(&rows.concat());
        assert!(factors.factor());
        factors.solve(&mut right);
        for (got, expected) in right.iter().zip(expected) {
            assert!((got.value() - expected.value()).abs() < 1e-15, "{got:?}");
            for direction in 0..2 {
                assert!((got.partial(direction) - expected.partial(direction)).abs() < 1e-15, "{got:?}");
            }
        }
        factors.matrix(2).copy_from_slice(&[1.0, 2.0, 2.0, 4.0]);
        assert!(!factors.factor(), "a singular matrix");
    }
}
