//! Singular values of a triangle whose columns are scaled to unit length: the directions that data determine.

use crate::algebra::sums::{dot, sum_of_squares};
use crate::algebra::triangle::Triangle;

/// Weight of the wish not to move along a direction that the residuals do not see, as a share of what a parameter moves
/// them by (1): less than what they see of any direction that matters, and more than rounding.
const WISH: f64 = 1e-6;

/// Singular value decomposition `R S⁻¹ = U Σ Vᵀ` with `S` the column norms of `R`, by one-sided Jacobi rotations,
/// which find small singular values to high relative accuracy.
///
/// # Why not a library
/// nalgebra's decomposition by bidiagonal form is the quicker one, 0.7 µs against 0.8 at 3 columns, 9 against 26 at 12.
/// A fit decomposes once, at its end, where a single evaluation takes longer; what counts there is that the smallest
/// value, which says what the data cannot tell, keeps its digits. `benches/peers` of the workspace measures it.
///
/// # References
/// J. Demmel, K. Veselić, "Jacobi's method is more accurate than QR", SIAM J. Matrix Anal. Appl. 13 (1992) 1204,
/// <https://doi.org/10.1137/0613074>.
#[derive(Debug, Clone)]
pub(crate) struct Spectrum {
    /// Column norms of `R`; 1 for a column of zeros.
    pub(crate) scales: Vec<f64>,
    /// Singular values, descending.
    pub(crate) singular: Vec<f64>,
    /// Right singular vectors, in the order of their values.
    pub(crate) right: Vec<Vec<f64>>,
    /// `Uᵀ q`, in the same order; 0 where the singular value is.
    pub(crate) along: Vec<f64>,
}

impl Spectrum {
    pub(crate) fn of(triangle: &Triangle) -> Self {
        let order = triangle.order();
        let scales: Vec<f64> = (0..order)
            .map(|column| triangle.column_norm(column))
            .map(|norm| if norm > 0.0 { norm } else { 1.0 })
            .collect();
        let element = |row: usize, j: usize| if row > j { 0.0 } else { triangle.r(row, j) / scales[j] };
        let triples = singular_triples(order, element);
        let mut spectrum = Self { scales, singular: vec![], right: vec![], along: vec![] };
        for (value, left, right) in triples {
            let along: f64 = left.iter().enumerate().map(|(row, l)| l * triangle.q(row)).sum();
            spectrum.singular.push(value);
            spectrum.along.push(if value > 0.0 { along / value } else { 0.0 });
            spectrum.right.push(right);
        }
        spectrum
    }

    /// Number of singular values that exceed `threshold` times the largest.
    pub(crate) fn rank(&self, threshold: f64) -> usize {
        let largest = self.singular.first().copied().unwrap_or(0.0);
        self.singular.iter().filter(|&&value| value > threshold * largest).count()
    }

    /// The triangle in which the directions beyond `rank` are replaced by the wish not to move along them.
    ///
    /// If a bound holds one of two parameters with the same effect, the other one only moves with a part along such a
    /// direction: the wish has to be weaker than what the residuals say of any other.
    pub(crate) fn anchor(&self, rank: usize, anchored: &mut Triangle, block: &mut Vec<f64>) {
        let order = self.scales.len();
        block.clear();
        for j in 0..order {
            for (i, right) in self.right.iter().enumerate() {
                let weight = if i < rank { self.singular[i] } else { WISH };
                block.push(weight * right[j] * self.scales[j]);
            }
        }
        block.extend(self.along.iter().enumerate().map(|(i, along)| if i < rank { *along } else { 0.0 }));
        anchored.reset(order);
        anchored.fold(block);
    }
}

/// True if all scaled singular values exceed `threshold` times the largest, by a bound that costs next to nothing;
/// `false` only means that a decomposition has to decide.
///
/// ```text
/// σ_min ≥ det(R S⁻¹) / (σ₁ ⋯ σ_{p−1}) ≥ ∏ |Rⱼⱼ|/‖Rⱼ‖ / √e,     σ_max ≤ √p
/// ```
pub(crate) fn is_surely_of_full_rank(triangle: &Triangle, threshold: f64) -> bool {
    let order = triangle.order();
    let determinant: f64 = (0..order).map(|j| triangle.r(j, j).abs() / triangle.column_norm(j)).product();
    // A column of zeros gives NaN, which compares as false.
    determinant > threshold * (std::f64::consts::E * order as f64).sqrt()
}

/// Singular values of a square matrix, descending, each with the image of its right vector and the vector itself.
pub(crate) fn singular_triples(order: usize, element: impl Fn(usize, usize) -> f64) -> Vec<(f64, Vec<f64>, Vec<f64>)> {
    // Each column is one of A V above one of V.
    let both = |row: usize, j: usize| if row < order { element(row, j) } else { f64::from(row - order == j) };
    let mut columns: Vec<Vec<f64>> = (0..order).map(|j| (0..2 * order).map(|row| both(row, j)).collect()).collect();
    orthogonalise(&mut columns, order);
    let triple = |column: &Vec<f64>| {
        let (image, vector) = column.split_at(order);
        (sum_of_squares(image).sqrt(), image.to_vec(), vector.to_vec())
    };
    let mut triples: Vec<_> = columns.iter().map(triple).collect();
    triples.sort_by(|a, b| b.0.total_cmp(&a.0));
    triples
}

/// Rotates pairs of columns until the first `order` elements of all are orthogonal.
fn orthogonalise(columns: &mut [Vec<f64>], order: usize) {
    // Columns of unit length shrink to this only when nothing but rounding is left of them.
    const NOTHING: f64 = 1e-36;
    // Convergence is quadratic and takes six to ten sweeps; the limit is for rounding at the last digit.
    for _sweep in 0..40 {
        let mut rotated = false;
        for j in 1..columns.len() {
            let (head, tail) = columns.split_at_mut(j);
            let second = &mut tail[0];
            for first in head {
                let alpha = sum_of_squares(&first[..order]);
                let beta = sum_of_squares(&second[..order]);
                let gamma = dot(&first[..order], &second[..order]);
                if alpha.min(beta) < NOTHING || gamma.abs() <= f64::EPSILON * (alpha * beta).sqrt() {
                    continue;
                }
                rotated = true;
                let zeta = (beta - alpha) / (2.0 * gamma);
                let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                let cosine = 1.0 / tangent.hypot(1.0);
                let sine = cosine * tangent;
                for (a, b) in first.iter_mut().zip(second.iter_mut()) {
                    (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
                }
            }
        }
        if !rotated {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(rows: &[[f64; 4]]) -> Triangle {
        let mut triangle = Triangle::default();
        triangle.reset(3);
        let mut block: Vec<f64> = (0..4).flat_map(|column| rows.iter().map(move |row| row[column])).collect();
        triangle.fold(&mut block);
        triangle
    }

    #[test]
    fn values_are_those_of_a_dense_decomposition() {
        let rows = [[1.0, 0.9, 3.0, 1.0], [2.0, 2.1, -1.0, 0.5], [0.5, 0.4, 2.0, -1.0], [1.0, 1.2, 0.0, 2.0]];
        let factor = triangle(&rows);
        let spectrum = Spectrum::of(&factor);
        let scaled = nalgebra::DMatrix::from_fn(4, 3, |i, j| rows[i][j] / spectrum.scales[j]);
        let expected = scaled.singular_values();
        for (value, reference) in spectrum.singular.iter().zip(expected.iter()) {
            // Backward error of both: a few eps.
            assert!((value - reference).abs() < 1e-14, "{value} against {reference}");
        }
        assert_eq!(spectrum.rank(1e-12), 3);
        assert!(is_surely_of_full_rank(&factor, 1e-3));
    }

    #[test]
    fn dependent_columns_are_found_and_anchored() {
        // Third column = first + second.
        let rows = [[1.0, 2.0, 3.0, 1.0], [2.0, -1.0, 1.0, 0.5], [0.5, 0.25, 0.75, -1.0], [1.0, 0.0, 1.0, 2.0]];
        let factor = triangle(&rows);
        assert!(!is_surely_of_full_rank(&factor, 1e-13));
        let spectrum = Spectrum::of(&factor);
        assert_eq!(spectrum.rank(1e-13), 2, "singular values {:?}", spectrum.singular);
        let null: Vec<f64> = spectrum.right[2].iter().zip(&spectrum.scales).map(|(v, s)| v / s).collect();
        assert!((null[0] / null[2] + 1.0).abs() < 1e-12 && (null[1] / null[2] + 1.0).abs() < 1e-12, "{null:?}");
        let mut anchored = Triangle::default();
        spectrum.anchor(2, &mut anchored, &mut Vec::new());
        let mut step = [0.0; 3];
        anchored.solve(&mut step);
        // The step solves the problem and has no component along the null vector, in scaled coordinates.
        let along: f64 = (0..3).map(|j| spectrum.right[2][j] * step[j] * spectrum.scales[j]).sum();
        assert!(along.abs() < 1e-13, "step {step:?} moves {along} along the null vector");
        for column in 0..3 {
            let gradient: f64 =
                (0..=column).map(|row| factor.r(row, column) * (factor.row_times(row, &step) + factor.q(row))).sum();
            assert!(gradient.abs() < 1e-13, "gradient {gradient} is left in column {column}");
        }
    }
}
