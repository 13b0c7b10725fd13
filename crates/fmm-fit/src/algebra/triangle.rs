//! Factorisation of tall matrices.

use std::array;

use fmm_model::widest;

use crate::algebra::sums::products;

/// Numbers per block at most: the block and its copy share the first-level cache.
const BLOCK: usize = 1536;

/// Accumulators side by side: eight, which are two vectors of four numbers.
const LANES: usize = 8;

/// The least square of the sine between a column and those before it for which scalar products are exact enough: what
/// is left of a column after they are taken off has lost two digits at most.
const WELL_CONDITIONED: f64 = 1e-2;

/// Squares below have lost digits to underflow.
const UNDERFLOW: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// The triangle `R`, `q = Qᵀ r` and `‖r − Q q‖` of a matrix `J = Q R` and a vector `r`.
///
/// Columns at wide angles to each other, as those of most fits of a few parameters, are factored by way of their scalar
/// products (Cholesky), which is several times as fast and then as good: with sines of 0.1 or more it costs two digits
/// of sixteen. The rows of all others are folded in by Householder reflections of the stack of triangle and block, so
/// `J` is read once, never copied whole and need not be there at once. The order of operations is fixed: results are
/// reproducible.
///
/// ```text
/// ⎡ R  q ⎤     order p, row by row, p + 1 numbers each
/// ⎣ 0  ρ ⎦
/// ```
///
/// # Why not a library
/// Built for any x86-64, from 1500 × 3 to 45 000 × 6 this takes a third to two thirds of the time of nalgebra's
/// factorisation and less than a fifth of that of faer's, which is sequential here and meant for larger matrices; at
/// 225 000 × 12 about a fifth of either. It needs two blocks of memory beside the Jacobian where they need a copy of
/// it, and the blocks of a joint fit are reduced without their zeros, five records of 45 000 × 4 six times faster than
/// as one matrix. `benches/peers` of the workspace measures it.
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

    /// True if every number is finite; one that is not in `J` or `r` always shows here.
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
    /// `residuals`; `scratch` may have any length.
    pub(crate) fn factor(&mut self, jacobian: &[f64], columns: &[usize], residuals: &[f64], scratch: &mut Vec<f64>) {
        if !self.factor_few(jacobian, columns, residuals) {
            widest(
                #[inline(always)]
                || self.factor_here(jacobian, columns, residuals, scratch),
            );
        }
    }

    #[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
    #[inline(always)]
    fn factor_here(&mut self, jacobian: &[f64], columns: &[usize], residuals: &[f64], scratch: &mut Vec<f64>) {
        self.reset(columns.len());
        let (length, width) = (residuals.len(), self.order + 1);
        // Blocks of about the same length, a multiple of the lanes.
        let blocks = (length * width).div_ceil(BLOCK).max(1);
        let most = length.div_ceil(blocks).next_multiple_of(LANES).max(LANES);
        scratch.resize(scratch_length(most, width), 0.0);
        for first in (0..length).step_by(most) {
            let rows = first..length.min(first + most);
            let column = |j: usize| match columns.get(j) {
                Some(column) => &jacobian[column * length..][rows.clone()],
                None => &residuals[rows.clone()],
            };
            self.fold_columns(column, rows.len(), scratch);
        }
    }

    /// The factor by way of scalar products, for a few columns only; false if that is not good enough.
    fn factor_few(&mut self, jacobian: &[f64], columns: &[usize], residuals: &[f64]) -> bool {
        let column = |j: usize| &jacobian[j * residuals.len()..][..residuals.len()];
        match *columns {
            [a] => self.factor_products(products([column(a), residuals])),
            [a, b] => self.factor_products(products([column(a), column(b), residuals])),
            [a, b, c] => self.factor_products(products([column(a), column(b), column(c), residuals])),
            _ => false,
        }
    }

    /// Cholesky's factor of the scalar products of the columns and the residual; false if a column is nearly a
    /// combination of those before it.
    fn factor_products<const W: usize>(&mut self, products: [[f64; W]; W]) -> bool {
        self.order = W - 1;
        self.entries.clear();
        self.entries.extend_from_slice(products.as_flattened());
        for column in 0..W {
            let square = self.r(column, column);
            let mut left = square;
            for row in 0..column {
                let known: f64 = (0..row).map(|above| self.r(above, row) * self.r(above, column)).sum();
                let entry = (self.r(row, column) - known) / self.r(row, row);
                self.entries[row * W + column] = entry;
                left -= entry * entry;
            }
            if column < self.order && !(square > UNDERFLOW && left >= WELL_CONDITIONED * square) {
                return false;
            }
            // Of the residual nothing at all may be left.
            self.entries[column * W + column] = left.max(0.0).sqrt();
        }
        self.is_finite()
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
    pub(crate) fn fold(&mut self, block: &mut Vec<f64>) {
        let (width, given) = (self.order + 1, block.len());
        let rows = given / width;
        block.resize(given + scratch_length(rows, width), 0.0);
        let (given, scratch) = block.split_at_mut(given);
        self.fold_columns(|j| &given[j * rows..][..rows], rows, scratch);
    }

    /// Folds in `rows` more rows of `[J r]`, whose columns are given by their number.
    ///
    /// One sweep through the rows reflects several columns and finds their products with the next pivot, from one copy
    /// of the block to another; what costs time is reading and writing, and the wait for each sum.
    #[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
    #[inline(always)]
    fn fold_columns<'a>(&mut self, given: impl Fn(usize) -> &'a [f64], rows: usize, scratch: &mut [f64]) {
        if rows == 0 {
            return;
        }
        let width = self.order + 1;
        let (products, copies) = scratch.split_at_mut(width);
        let (mut from, mut to) = copies[..2 * rows * width].split_at_mut(rows * width);
        for first in (0..width).step_by(4) {
            let products = &mut products[first..];
            match width - first {
                1 => multiply::<1>(first, &given, products),
                2 => multiply::<2>(first, &given, products),
                3 => multiply::<3>(first, &given, products),
                _ => multiply::<4>(first, &given, products),
            }
        }
        for k in 0..width {
            reflect(&mut self.entries[k * width + k..(k + 1) * width], &mut products[k..]);
            if k + 1 == width {
                break;
            }
            let column = |j: usize| if k == 0 { given(j) } else { &from[j * rows..(j + 1) * rows] };
            let next = products[k + 1];
            // The next pivot is part of every group: its products with the others are wanted.
            for first in (k + 2..width.max(k + 3)).step_by(3) {
                match width - first {
                    0 => sweep::<1>([k, first], next, column, products, to),
                    1 => sweep::<2>([k, first], next, column, products, to),
                    2 => sweep::<3>([k, first], next, column, products, to),
                    _ => sweep::<4>([k, first], next, column, products, to),
                }
            }
            std::mem::swap(&mut from, &mut to);
        }
    }
}

/// Size of the buffer of [`Triangle::fold_columns`].
fn scratch_length(rows: usize, width: usize) -> usize {
    (2 * rows + 1) * width
}

/// Clears a pivot against the diagonal, the first of `line`, and turns the products of the pivot with itself and the
/// columns behind it into the multiples of the pivot to be taken off these.
fn reflect(line: &mut [f64], products: &mut [f64]) {
    let (diagonal, square) = (line[0], products[0]);
    let norm = (diagonal * diagonal + square).sqrt();
    // Of a pivot whose square underflows, as derivatives that have died away do, nothing is left to be cleared.
    if square == 0.0 || norm * norm < f64::MIN_POSITIVE {
        products.fill(0.0);
        return;
    }
    let reflected = if diagonal > 0.0 { -norm } else { norm };
    let lead = diagonal - reflected;
    // 2/‖v‖² of the reflecting vector v = (lead, pivot).
    let factor = 1.0 / (norm * (norm + diagonal.abs()));
    line[0] = reflected;
    for (entry, product) in line[1..].iter_mut().zip(&mut products[1..]) {
        let along = (lead * *entry + *product) * factor;
        *entry -= along * lead;
        *product = along;
    }
}

/// Products of column 0 with `N` columns from `first` on.
#[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
#[inline(always)]
fn multiply<'a, const N: usize>(first: usize, column: impl Fn(usize) -> &'a [f64], products: &mut [f64]) {
    let (pivot, pivot_rest) = column(0).as_chunks::<LANES>();
    let columns: [_; N] = array::from_fn(|n| column(first + n).as_chunks::<LANES>());
    let whole = columns.map(|(whole, _)| &whole[..pivot.len()]);
    let mut sums = [[0.0; LANES]; N];
    for (i, p) in pivot.iter().enumerate() {
        for n in 0..N {
            for lane in 0..LANES {
                sums[n][lane] += p[lane] * whole[n][i][lane];
            }
        }
    }
    for n in 0..N {
        let rest: f64 = pivot_rest.iter().zip(columns[n].1).map(|(p, c)| p * c).sum();
        products[n] = total(&sums[n]) + rest;
    }
}

/// Takes multiples of column `k` off column `k + 1`, `next` times, and off `N − 1` columns from `first` on, as often as
/// `products` says, which then become those of column `k + 1` with all of these.
#[expect(clippy::inline_always, reason = "it must be compiled where it is called, for the vectors there are")]
#[inline(always)]
fn sweep<'a, const N: usize>(
    [k, first]: [usize; 2],
    next: f64,
    column: impl Fn(usize) -> &'a [f64],
    products: &mut [f64],
    to: &mut [f64],
) {
    let number = |n: usize| if n == 0 { k + 1 } else { first + n - 1 };
    let along: [f64; N] = array::from_fn(|n| if n == 0 { next } else { products[number(n)] });
    let (pivot, pivot_rest) = column(k).as_chunks::<LANES>();
    let sources: [_; N] = array::from_fn(|n| column(number(n)).as_chunks::<LANES>());
    let mut all = to.chunks_exact_mut(column(k).len());
    let mut targets: [_; N] = array::from_fn(|n| {
        let skipped = [k + 1, first - k - 2, 0][n.min(2)];
        all.nth(skipped).unwrap_or_default().as_chunks_mut::<LANES>()
    });
    let whole = sources.map(|(whole, _)| &whole[..pivot.len()]);
    let written = targets.each_mut().map(|(whole, _)| &mut whole[..pivot.len()]);
    let mut sums = [[0.0; LANES]; N];
    for (i, p) in pivot.iter().enumerate() {
        let mut reflected = [[0.0; LANES]; N];
        for n in 0..N {
            for lane in 0..LANES {
                reflected[n][lane] = whole[n][i][lane] - along[n] * p[lane];
            }
        }
        for n in 0..N {
            for lane in 0..LANES {
                sums[n][lane] += reflected[0][lane] * reflected[n][lane];
            }
            written[n][i] = reflected[n];
        }
    }
    let mut rests = [0.0; N];
    for (i, p) in pivot_rest.iter().enumerate() {
        let reflected: [f64; N] = array::from_fn(|n| sources[n].1[i] - along[n] * p);
        for n in 0..N {
            rests[n] += reflected[0] * reflected[n];
            targets[n].1[i] = reflected[n];
        }
    }
    for n in 0..N {
        products[number(n)] = total(&sums[n]) + rests[n];
    }
}

/// The sum of interleaved sums. Inlined, it would make the compiler keep them as eight single numbers.
#[inline(never)]
fn total(sums: &[f64; LANES]) -> f64 {
    ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]))
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

    /// The derivative by what the beginning of a record was has died away: 1, 1e-80, 1e-160, … and 1e-160 where nothing
    /// was before.
    #[test]
    fn derivatives_that_have_died_away_are_none() {
        let n = 2500;
        let dying: Vec<f64> = (0..n).map(|i| if i < 1000 { 0.0 } else { 1e-160 * f64::from(i % 7) }).collect();
        let fading: Vec<f64> = (0..n).map(|i| 10f64.powi(-80 * (i / 400))).collect();
        let jacobian = [fading, dying, vec![1.0; n as usize], vec![0.0; n as usize]].concat();
        let mut triangle = Triangle::default();
        triangle.factor(&jacobian, &[0, 1, 2, 3], &vec![0.5; n as usize], &mut Vec::new());
        assert!(triangle.is_finite());
        assert!((triangle.column_norm(0) - 20.0).abs() < 1e-12 && (triangle.column_norm(2) - 50.0).abs() < 1e-12);
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
    fn products_are_as_good_for_columns_at_wide_angles_and_refused_for_others() {
        let (n, columns) = (1501, [0, 1, 2]);
        let size = [1.0, 1e3, 1e6];
        let wave = |j: usize, i: usize| (0.01 * (j + 1) as f64 * i as f64 + j as f64).sin() * size[j];
        let mut jacobian: Vec<f64> = (0..3).flat_map(|j| (0..n).map(move |i| wave(j, i))).collect();
        let residuals: Vec<f64> = (0..n).map(|i| ((i * 7919) % 1009) as f64 / 1009.0 - 0.5).collect();
        // Turns the last column towards the first, to sines on either side of the limit.
        for (sine, is_product) in [(1.0, true), (0.12, true), (0.08, false), (0.01, false)] {
            for i in 0..n {
                jacobian[2 * n + i] = 1e6 * (sine * wave(2, i) * 1e-6 + (1.0 - sine * sine).sqrt() * wave(0, i));
            }
            let mut triangle = Triangle::default();
            triangle.factor(&jacobian, &columns, &residuals, &mut Vec::new());
            let mut reflected = Triangle::default();
            reflected.reset(3);
            reflected.fold(&mut [&jacobian[..], &residuals].concat());
            // Reflections leave negative numbers on the diagonal, roots do not.
            assert_eq!((0..3).all(|k| triangle.r(k, k) > 0.0), is_product, "sine {sine}");
            let (size, rest) = (triangle.column_norm(2), triangle.residual_norm());
            for row in 0..3 {
                let sign = (reflected.r(row, row) * triangle.r(row, row)).signum();
                let (r, q) = (triangle.r(row, 2), triangle.q(row));
                // Two digits of sixteen, and the rounding of 1501 sums.
                assert!((r - sign * reflected.r(row, 2)).abs() < 1e-13 * size, "sine {sine}: R[{row}] = {r}");
                assert!((q - sign * reflected.q(row)).abs() < 1e-12 * rest, "sine {sine}: q[{row}] = {q}");
            }
        }
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
    fn wide_vectors_do_not_change_a_digit() {
        let (jacobian, residuals) = tall();
        // One to seven columns make groups of every size; the lengths leave a rest of some lanes.
        for columns in 0..=6 {
            let columns: Vec<usize> = (0..columns).collect();
            let (mut wide, mut narrow) = (Triangle::default(), Triangle::default());
            widest(
                #[inline(always)]
                || wide.factor_here(&jacobian, &columns, &residuals, &mut Vec::new()),
            );
            narrow.factor_here(&jacobian, &columns, &residuals, &mut Vec::new());
            assert_eq!(wide.entries, narrow.entries);
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
