//! Changes of the residuals that the parameters of a fit can follow.

use fmm_fit::Fit;

use crate::linear_algebra::inverse_of_products;
use crate::problem::Problem;

/// The derivatives of all residuals by the parameters that a fit determines, those on a bound included.
#[derive(Debug, Clone)]
pub(crate) struct Tangent {
    /// Places of these parameters among all.
    known: Vec<usize>,
    columns: Vec<Vec<f64>>,
    /// (JᵀJ)⁻, row by row.
    inverse: Vec<f64>,
}

impl Tangent {
    /// Tangent of a `fit` to `problem`; `None` if the derivatives cannot be had.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit) -> Option<Self> {
        let known: Vec<usize> = (0..fit.values().len()).filter(|i| fit.relaxed_covariance(*i, *i).is_some()).collect();
        let columns = problem.columns(fit.values(), &known).ok()?;
        let inverse = inverse_of_products(&columns);
        Some(Self { known, columns, inverse })
    }

    /// The change of every parameter, (JᵀJ)⁻¹Jᵀd, that follows a change d of the residuals best.
    fn steps(&self, direction: &[f64]) -> Vec<f64> {
        let product = |column: &Vec<f64>| -> f64 { column.iter().zip(direction).map(|(a, d)| a * d).sum() };
        let products: Vec<f64> = self.columns.iter().map(product).collect();
        let rows = self.inverse.chunks(self.known.len().max(1));
        rows.map(|row| row.iter().zip(&products).map(|(weight, product)| weight * product).sum()).collect()
    }

    /// Change of the parameter at place `index` among all, 0 if the fit does not determine it.
    pub(crate) fn step(&self, index: usize, direction: &[f64]) -> f64 {
        let place = self.known.iter().position(|known| *known == index);
        place.map_or(0.0, |place| self.steps(direction)[place])
    }

    /// Takes out of `direction`, a change of all residuals, what the parameters can follow.
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
        let inverse = inverse_of_products(&columns);
        let known = (0..3).collect();
        let mut direction = vec![0.3, -0.2, 0.7];
        Tangent { known, columns, inverse }.take_out(&mut direction);
        assert!(direction[0].abs() + direction[1].abs() < 1e-9 && (direction[2] - 0.7).abs() < 1e-15, "{direction:?}");
    }
}
