//! Small dense complex linear systems, several at once, factored in plain numbers and solved for dual numbers.

use fmm_model::Scalar;

/// Number of systems.
pub(super) const SYSTEMS: usize = 4;

/// A complex number of each system: the real parts, then the imaginary ones.
pub(super) type Complex<D> = [D; 2 * SYSTEMS];

/// The factors of a square matrix of each system, by Gaussian elimination with partial pivoting. The systems share
/// their pivots, as those which differ on their diagonals only may.
///
/// # Why not a library
/// Right sides carry derivatives, memory is used again from step to step, and four systems fill the lanes of a
/// processor: nalgebra takes 3.9, 3.3 and 2.7 times as long at 3, 6 and 12 rows of plain numbers. `benches/peers` of
/// the workspace measures it.
#[derive(Debug, Clone, Default)]
pub(super) struct Factors {
    size: usize,
    /// Row by row: below the diagonal the multipliers, on it the inverses of the pivots, above it the upper factor.
    entries: Vec<Complex<f64>>,
    swaps: Vec<usize>,
}

impl Factors {
    /// Makes room for matrices of `size` rows and gives it, row by row, to be filled before [`factor`](Self::factor).
    pub(super) fn matrix(&mut self, size: usize) -> &mut [Complex<f64>] {
        self.size = size;
        self.entries.resize(size * size, [0.0; 2 * SYSTEMS]);
        &mut self.entries
    }

    /// Factors the matrices. False if one is singular or not finite.
    pub(super) fn factor(&mut self) -> bool {
        // Loops of the usual length, for laws of one state, are unrolled.
        match self.size {
            2 => self.factor_rows(2),
            size => self.factor_rows(size),
        }
    }

    #[expect(clippy::inline_always, reason = "loops of known lengths are unrolled only where they are inlined")]
    #[inline(always)]
    fn factor_rows(&mut self, size: usize) -> bool {
        let entries = &mut self.entries[..size * size];
        self.swaps.clear();
        for column in 0..size {
            let entry = |row: usize| entries[row * size + column].iter().map(|part| part.abs()).sum::<f64>();
            let mut pivot = column;
            for row in column + 1..size {
                if entry(row) > entry(pivot) {
                    pivot = row;
                }
            }
            self.swaps.push(pivot);
            if pivot != column {
                for k in 0..size {
                    entries.swap(pivot * size + k, column * size + k);
                }
            }
            let Some(inverse) = inverse(&entries[column * size + column]) else { return false };
            entries[column * size + column] = inverse;
            let (upper, lower) = entries.split_at_mut((column + 1) * size);
            let pivot_row = &upper[column * size + column + 1..];
            for row in lower.chunks_exact_mut(size) {
                let multiplier = product(&row[column], &inverse);
                for (entry, pivot) in row[column + 1..].iter_mut().zip(pivot_row) {
                    subtract_product(entry, &multiplier, pivot);
                }
                row[column] = multiplier;
            }
        }
        true
    }

    /// Replaces `right` by the solutions for it.
    pub(super) fn solve<D: Scalar>(&self, right: &mut [Complex<D>]) {
        match self.size {
            2 => self.solve_rows(2, right),
            size => self.solve_rows(size, right),
        }
    }

    #[expect(clippy::inline_always, reason = "loops of known lengths are unrolled only where they are inlined")]
    #[inline(always)]
    fn solve_rows<D: Scalar>(&self, size: usize, right: &mut [Complex<D>]) {
        let (right, entries) = (&mut right[..size], &self.entries[..size * size]);
        for (row, pivot) in self.swaps.iter().enumerate() {
            right.swap(row, *pivot);
        }
        for row in 0..size {
            let (known, rest) = right.split_at_mut(row);
            for (factor, known) in entries[row * size..row * size + row].iter().zip(&*known) {
                subtract_product(&mut rest[0], factor, known);
            }
        }
        for row in (0..size).rev() {
            let (rest, known) = right.split_at_mut(row + 1);
            let upper = &entries[row * size + row + 1..(row + 1) * size];
            for (factor, known) in upper.iter().zip(&*known) {
                subtract_product(&mut rest[row], factor, known);
            }
            rest[row] = product(&entries[row * size + row], &rest[row]);
        }
    }
}

#[inline]
fn product<D: Scalar>(a: &Complex<f64>, b: &Complex<D>) -> Complex<D> {
    let mut product = *b;
    for i in 0..SYSTEMS {
        let (re, im) = (i, SYSTEMS + i);
        product[re] = b[re] * a[re] - b[im] * a[im];
        product[im] = b[re] * a[im] + b[im] * a[re];
    }
    product
}

#[inline]
fn subtract_product<D: Scalar>(sum: &mut Complex<D>, a: &Complex<f64>, b: &Complex<D>) {
    for (sum, product) in sum.iter_mut().zip(product(a, b)) {
        *sum -= product;
    }
}

/// 1/`of`, if that is finite and not zero in all systems.
#[inline]
fn inverse(of: &Complex<f64>) -> Option<Complex<f64>> {
    let mut inverse = *of;
    let mut is_regular = true;
    for i in 0..SYSTEMS {
        let (re, im) = (of[i], of[SYSTEMS + i]);
        let scale = 1.0 / (re * re + im * im);
        is_regular &= scale.is_finite() && scale != 0.0;
        (inverse[i], inverse[SYSTEMS + i]) = (re * scale, -im * scale);
    }
    is_regular.then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    #[test]
    fn solves_what_needs_pivots_with_derivatives() {
        type Number = Dual<2>;
        // Zeros, and a greatest entry below them, in the first column of all systems.
        let entry = |row: usize, column: usize| {
            let [re, im] = [
                [[0.0, 0.0], [2.0, 1.0], [1.0, 0.0]],
                [[4.0, 1.0], [-1.0, 0.0], [3.0, -2.0]],
                [[2.0, 0.0], [2.0, 2.0], [-5.0, 1.0]],
            ][row][column];
            let turned = |i: usize| if row == column { re + i as f64 * 0.1 * re } else { re };
            std::array::from_fn(|i| if i < SYSTEMS { turned(i) } else { im })
        };
        let known: [Complex<Number>; 3] = std::array::from_fn(|row| {
            std::array::from_fn(|i| Number::variable((row + 1) as f64 - 0.3 * i as f64, (row + i) % 2))
        });
        let mut factors = Factors::default();
        let matrix = factors.matrix(3);
        let mut right = [[Number::from(0.0); 2 * SYSTEMS]; 3];
        for (row, right) in right.iter_mut().enumerate() {
            for (column, known) in known.iter().enumerate() {
                let entry = entry(row, column);
                matrix[row * 3 + column] = entry;
                for (right, product) in right.iter_mut().zip(product(&entry, known)) {
                    *right += product;
                }
            }
        }
        assert!(factors.factor());
        factors.solve(&mut right);
        for (got, expected) in right.iter().flatten().zip(known.iter().flatten()) {
            assert!((got.value() - expected.value()).abs() < 1e-14, "{got:?}");
            for direction in 0..2 {
                assert!((got.partial(direction) - expected.partial(direction)).abs() < 1e-14, "{got:?}");
            }
        }
        for (entry, value) in factors.matrix(2).iter_mut().zip([1.0, 2.0, 2.0, 4.0]) {
            *entry = std::array::from_fn(|i| if i < SYSTEMS { value } else { 0.0 });
        }
        assert!(!factors.factor(), "a singular matrix");
    }

    #[test]
    fn a_pivot_is_looked_for_in_its_own_column() {
        let mut factors = Factors::default();
        for (entry, value) in factors.matrix(3).iter_mut().zip([1.0, 0.0, 2.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0]) {
            *entry = std::array::from_fn(|i| if i < SYSTEMS { value } else { 0.0 });
        }
        assert!(factors.factor(), "the second pivot is in the last row");
    }
}
