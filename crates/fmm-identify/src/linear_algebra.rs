//! Linear algebra of a few columns: the inverse of their products, and the part of a direction that they can follow.

use nalgebra::DMatrix;

/// JᵀJ of the columns of J, which are equally long.
///
/// Rows are taken in blocks that stay in the cache for all pairs of columns, and each pair once: as scalar products of
/// whole columns, these sums were two fifths of the time of a fit to a million samples.
pub(crate) fn products(columns: &[&[f64]]) -> DMatrix<f64> {
    /// Rows of a block: twenty columns of it are 160 kB.
    const BLOCK: usize = 1024;
    let order = columns.len();
    let rows = columns.first().map_or(0, |column| column.len());
    let mut sums = DMatrix::zeros(order, order);
    fmm_model::widest(
        #[inline(always)]
        || {
            for start in (0..rows).step_by(BLOCK) {
                let block = start..rows.min(start + BLOCK);
                for (j, b) in columns.iter().enumerate() {
                    for (i, a) in columns[..=j].iter().enumerate() {
                        sums[(i, j)] += product(&a[block.clone()], &b[block.clone()]);
                    }
                }
            }
        },
    );
    sums.fill_lower_triangle_with_upper_triangle();
    sums
}

/// Scalar product of two columns, in the order in which vectors sum.
#[inline(always)]
fn product(a: &[f64], b: &[f64]) -> f64 {
    /// Sums side by side: one addition need not wait for the one before.
    const LANES: usize = 32;
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// (JᵀJ)⁻ of the columns of J, row by row: J (JᵀJ)⁻ Jᵀ takes what the columns can follow and nothing else, however
/// alike they are.
pub(crate) fn inverse_of_products(columns: &[Vec<f64>]) -> Vec<f64> {
    inverse(&products(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>()))
}

/// The same of these [`products`].
pub(crate) fn inverse(products: &DMatrix<f64>) -> Vec<f64> {
    /// Square of the length of a combination of unit columns below which it is rounding.
    const ROUNDING: f64 = 1e-10;
    let order = products.nrows();
    // An empty matrix has no eigenvalues to ask for.
    if order == 0 {
        return Vec::new();
    }
    let length = |i: usize| Some(products[(i, i)].sqrt().recip()).filter(|scale| scale.is_finite()).unwrap_or(0.0);
    let scales: Vec<f64> = (0..order).map(length).collect();
    let eigen = DMatrix::from_fn(order, order, |i, j| products[(i, j)] * scales[i] * scales[j]).symmetric_eigen();
    let inverse = eigen.eigenvalues.map(|square| if square > ROUNDING { square.recip() } else { 0.0 });
    let scaled = &eigen.eigenvectors * DMatrix::from_diagonal(&inverse) * eigen.eigenvectors.transpose();
    (0..order * order).map(|at| (at / order, at % order)).map(|(i, j)| scaled[(i, j)] * scales[i] * scales[j]).collect()
}

/// L with L Lᵀ = A, of a covariance A of this `order` that is positive but for rounding, row by row.
pub(crate) fn root_of_covariance(elements: &[f64], order: usize) -> Vec<f64> {
    let deviations: Vec<f64> = (0..order).map(|i| elements[i * (order + 1)].max(0.0).sqrt()).collect();
    let correlation = |i: usize, j: usize| {
        let scale = deviations[i] * deviations[j];
        if scale > 0.0 { elements[i * order + j] / scale } else { 0.0 }
    };
    if order == 0 {
        return Vec::new();
    }
    let eigen = DMatrix::from_fn(order, order, correlation).symmetric_eigen();
    let root = eigen.eigenvectors * DMatrix::from_diagonal(&eigen.eigenvalues.map(|square| square.max(0.0).sqrt()));
    (0..order * order).map(|at| root[(at / order, at % order)] * deviations[at / order]).collect()
}

/// Columns of J with (JᵀJ)⁻.
#[derive(Debug, Clone)]
pub(crate) struct Span {
    pub(crate) columns: Vec<Vec<f64>>,
    inverse: Vec<f64>,
}

impl Span {
    pub(crate) fn of(columns: Vec<Vec<f64>>) -> Self {
        Self { inverse: inverse_of_products(&columns), columns }
    }

    /// The steps (JᵀJ)⁻Jᵀd that follow a direction d best.
    pub(crate) fn steps(&self, direction: &[f64]) -> Vec<f64> {
        let product = |column: &Vec<f64>| -> f64 { column.iter().zip(direction).map(|(a, d)| a * d).sum() };
        let products: Vec<f64> = self.columns.iter().map(product).collect();
        let rows = self.inverse.chunks(self.columns.len().max(1));
        rows.map(|row| row.iter().zip(&products).map(|(weight, product)| weight * product).sum()).collect()
    }

    /// Takes out of `direction` what the columns can follow.
    pub(crate) fn take_out(&self, direction: &mut [f64]) {
        for (step, column) in self.steps(direction).iter().zip(&self.columns) {
            direction.iter_mut().zip(column).for_each(|(d, a)| *d -= step * a);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More rows than a block, and no multiple of its vectors: integers have exact sums.
    #[test]
    fn products_count_every_row_once() {
        let column = |step: u32| (0..2_105_u32).map(|row| f64::from(row * step % 7) - 3.0).collect::<Vec<_>>();
        let columns = [column(1), column(2), column(3)];
        let found = products(&columns.each_ref().map(Vec::as_slice));
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns.iter().enumerate() {
                let expected: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                assert_eq!(found[(i, j)], expected, "{i}, {j}");
            }
        }
    }

    #[test]
    fn no_columns_have_no_inverse() {
        assert!(inverse_of_products(&[]).is_empty() && root_of_covariance(&[], 0).is_empty());
    }

    /// Three columns in a plane: what they take of a direction is its part in the plane.
    #[test]
    fn columns_that_are_alike_take_no_more_than_one() {
        let columns = vec![vec![1.0, 0.0, 0.0], vec![1e6, 1e6, 0.0], vec![1e6, 1e6 + 1e-3, 0.0]];
        let mut direction = vec![0.3, -0.2, 0.7];
        Span::of(columns).take_out(&mut direction);
        assert!(direction[0].abs() + direction[1].abs() < 1e-9 && (direction[2] - 0.7).abs() < 1e-15, "{direction:?}");
    }

    /// A covariance of numbers 1e8 apart, two of which change together: its root gives it back, and no variance that
    /// follows is negative.
    #[test]
    fn a_root_gives_back_the_covariance() {
        let deviations = [1e8, 1e8 * (1.0 + 1e-12), 1e-3];
        let correlation = [[1.0, -1.0, 0.5], [-1.0, 1.0, -0.5], [0.5, -0.5, 1.0]];
        let element = |at: usize| correlation[at / 3][at % 3] * deviations[at / 3] * deviations[at % 3];
        let covariance: Vec<f64> = (0..9).map(element).collect();
        let root = root_of_covariance(&covariance, 3);
        for (at, expected) in covariance.iter().enumerate() {
            let found: f64 = (0..3).map(|k| root[at / 3 * 3 + k] * root[at % 3 * 3 + k]).sum();
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} in place of {expected}");
        }
    }

    #[test]
    fn of_independent_columns_it_is_the_inverse() {
        let columns = [vec![2.0, 0.0, 1.0], vec![1.0, 3.0, 0.0], vec![0.0, 1.0, -4.0]];
        let inverse = inverse_of_products(&columns);
        let product = |i: usize, j: usize| -> f64 { columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum() };
        for i in 0..3 {
            for j in 0..3 {
                let unit: f64 = (0..3).map(|k| inverse[3 * i + k] * product(k, j)).sum();
                assert!((unit - f64::from(u8::from(i == j))).abs() < 1e-13, "{unit}");
            }
        }
    }
}
