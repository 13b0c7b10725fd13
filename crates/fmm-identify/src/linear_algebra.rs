//! Linear algebra of a few columns: the inverse of their products, and the part of a direction that they can follow.

/// (JᵀJ)⁻ of the columns of J, row by row: J (JᵀJ)⁻ Jᵀ takes what the columns can follow and nothing else, however
/// alike they are.
///
/// Of columns that are alike but for rounding, one is left. The normal matrix of at most a dozen columns is swept here,
/// column by column (Beaton): a matrix crate would be nine more to build.
pub(crate) fn inverse_of_products(columns: &[Vec<f64>]) -> Vec<f64> {
    /// Of a column of unit length, what is left below this square beside the others is rounding.
    const ROUNDING: f64 = 1e-10;
    let order = columns.len();
    let product = |i: usize, j: usize| -> f64 { columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum() };
    let scales: Vec<f64> = (0..order).map(|i| product(i, i).sqrt().recip()).collect();
    let mut swept = vec![0.0; order * order];
    for i in (0..order).filter(|i| scales[*i].is_finite()) {
        for j in (i..order).filter(|j| scales[*j].is_finite()) {
            swept[i * order + j] = product(i, j) * scales[i] * scales[j];
            swept[j * order + i] = swept[i * order + j];
        }
    }
    let mut left: Vec<usize> = (0..order).collect();
    while let Some(place) =
        (0..left.len()).max_by(|a, b| swept[left[*a] * (order + 1)].total_cmp(&swept[left[*b] * (order + 1)]))
    {
        let pivot = left[place];
        let square = swept[pivot * (order + 1)];
        if !(square > ROUNDING) {
            break;
        }
        left.swap_remove(place);
        let row: Vec<f64> = swept[pivot * order..(pivot + 1) * order].iter().map(|element| element / square).collect();
        for i in (0..order).filter(|i| *i != pivot) {
            let factor = swept[i * order + pivot];
            for j in (0..order).filter(|j| *j != pivot) {
                swept[i * order + j] -= factor * row[j];
            }
        }
        for i in 0..order {
            swept[i * order + pivot] = row[i];
            swept[pivot * order + i] = row[i];
        }
        swept[pivot * (order + 1)] = -square.recip();
    }
    let element = |i: usize, j: usize| {
        let is_left = left.contains(&i) || left.contains(&j);
        if is_left { 0.0 } else { -swept[i * order + j] * scales[i] * scales[j] }
    };
    (0..order * order).map(|at| element(at / order, at % order)).collect()
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

    /// Three columns in a plane: what they take of a direction is its part in the plane.
    #[test]
    fn columns_that_are_alike_take_no_more_than_one() {
        let columns = vec![vec![1.0, 0.0, 0.0], vec![1e6, 1e6, 0.0], vec![1e6, 1e6 + 1e-3, 0.0]];
        let mut direction = vec![0.3, -0.2, 0.7];
        Span::of(columns).take_out(&mut direction);
        assert!(direction[0].abs() + direction[1].abs() < 1e-9 && (direction[2] - 0.7).abs() < 1e-15, "{direction:?}");
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
