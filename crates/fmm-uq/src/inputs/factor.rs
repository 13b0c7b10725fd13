//! The triangular root of a correlation matrix.

use crate::Inputs;

/// L with L Lᵀ = R for the correlation matrix R of some `members` of `inputs`, lower triangular, row by row.
///
/// R may be singular: a column whose pivot is zero to rounding is left zero, as Cholesky's method would have it in
/// exact numbers; nalgebra's refuses such a matrix.
pub(crate) fn correlation_root(inputs: &Inputs, members: &[usize]) -> Vec<Vec<f64>> {
    let n = members.len();
    let mut root = vec![vec![0.0; n]; n];
    for j in 0..n {
        let pivot = 1.0 - root[j][..j].iter().map(|l| l * l).sum::<f64>();
        if pivot <= inputs.rounding() {
            continue;
        }
        root[j][j] = pivot.sqrt();
        for i in j + 1..n {
            let known: f64 = root[i][..j].iter().zip(&root[j][..j]).map(|(a, b)| a * b).sum();
            root[i][j] = (inputs.correlation_at(members[i], members[j]) - known) / root[j][j];
        }
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Input;

    #[test]
    fn roots_of_regular_and_singular_matrices() {
        let inputs = Inputs::new(["a", "b", "c"].map(|name| Input::new(name, 0.0, 1.0, "m").unwrap())).unwrap();
        for coefficients in [[0.9, 0.3, 0.5], [1.0, -1.0, -1.0], [1.0, 0.2, 0.2], [0.0, 0.0, 0.0]] {
            let pairs = [("a", "b", coefficients[0]), ("a", "c", coefficients[1]), ("b", "c", coefficients[2])];
            let correlated = inputs.clone().with_correlations(&pairs).unwrap();
            let root = correlation_root(&correlated, &[0, 1, 2]);
            for i in 0..3 {
                for j in 0..3 {
                    let product: f64 = (0..3).map(|k| root[i][k] * root[j][k]).sum();
                    // A pivot dropped at 1e-14 may leave its root, 1e-7, in the matrix; these leave nothing.
                    let error = product - correlated.correlation_at(i, j);
                    assert!(error.abs() < 1e-15, "{coefficients:?}: {error} at {i}, {j}");
                }
            }
        }
    }
}
