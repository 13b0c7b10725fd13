//! Small symmetric matrices, by rows, and Cholesky's factors of those that are positive definite.
//!
//! # Why not a library
//! nalgebra takes 1.3, 1.5 and 0.85 times as long at 3, 6 and 12 rows, and would be a dependency of the crate for this
//! alone; pivots are compared with a limit of their own here. `benches/peers` of the workspace measures it.

/// Adds `weight · row rowᵀ`.
pub(crate) fn add_square(matrix: &mut [f64], row: &[f64], weight: f64) {
    for (line, a) in matrix.chunks_exact_mut(row.len()).zip(row) {
        for (element, b) in line.iter_mut().zip(row) {
            *element += weight * a * b;
        }
    }
}

/// `leftᵀ M right`.
pub(crate) fn quadratic_form(matrix: &[f64], left: &[f64], right: &[f64]) -> f64 {
    let lines = matrix.chunks_exact(right.len());
    lines.zip(left).map(|(line, a)| a * line.iter().zip(right).map(|(m, b)| m * b).sum::<f64>()).sum()
}

/// Overwrites the lower half of a matrix of `order` rows by its factor; false if the square of diagonal element j of
/// the factor does not exceed `least(j)`.
pub(crate) fn factor(matrix: &mut [f64], order: usize, least: impl Fn(usize) -> f64) -> bool {
    for i in 0..order {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| matrix[i * order + k] * matrix[j * order + k]).sum();
            let rest = matrix[i * order + j] - known;
            matrix[i * order + j] = if i > j { rest / matrix[j * order + j] } else { rest.sqrt() };
            if i == j && !(rest > least(j)) {
                return false;
            }
        }
    }
    true
}

/// Overwrites `right` with the solution, given the factor in the lower half of `factored`.
pub(crate) fn solve(factored: &[f64], right: &mut [f64]) {
    let order = right.len();
    for i in 0..order {
        let known: f64 = (0..i).map(|k| factored[i * order + k] * right[k]).sum();
        right[i] = (right[i] - known) / factored[i * order + i];
    }
    for i in (0..order).rev() {
        let known: f64 = (i + 1..order).map(|k| factored[k * order + i] * right[k]).sum();
        right[i] = (right[i] - known) / factored[i * order + i];
    }
}

/// The inverse; `None` unless the matrix is positive definite by more than rounding.
pub(crate) fn inverse(matrix: &[f64], order: usize) -> Option<Vec<f64>> {
    let mut factored = matrix.to_vec();
    factor(&mut factored, order, |j| 1e-12 * matrix[j * order + j].abs()).then(|| {
        let mut inverse = vec![0.0; order * order];
        for (column, unit) in inverse.chunks_exact_mut(order).enumerate() {
            unit[column] = 1.0;
            solve(&factored, unit);
        }
        inverse
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_are_inverses_and_indefinite_matrices_have_none() {
        let matrix = [2.0, 0.5, -0.3, 0.5, 1.0, 0.2, -0.3, 0.2, 0.7];
        let inverted = inverse(&matrix, 3).unwrap();
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| matrix[3 * i + k] * inverted[3 * k + j]).sum();
                // A few operations on numbers of order one.
                assert!((product - f64::from(i == j)).abs() < 1e-15 * 16.0, "element ({i}, {j}): {product}");
            }
        }
        assert_eq!(inverse(&[1.0, 2.0, 2.0, 1.0], 2), None);
        assert_eq!(inverse(&[0.0], 1), None);
        assert_eq!(inverse(&[f64::NAN], 1), None);
    }
}
