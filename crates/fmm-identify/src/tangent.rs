//! Changes of the residuals that the parameters of a fit can follow.

use fmm_fit::Fit;

use crate::problem::RingDownProblem;

/// The derivatives of all residuals by the parameters that a fit determines, those on a bound included.
#[derive(Debug, Clone)]
pub(crate) struct Tangent {
    /// Places of these parameters among all.
    known: Vec<usize>,
    columns: Vec<Vec<f64>>,
    /// (JᵀJ)⁻¹, row by row.
    inverse: Vec<f64>,
}

impl Tangent {
    /// That of `fit`, which is one to `problem`; none if the derivatives cannot be had.
    pub(crate) fn of(problem: &RingDownProblem<'_>, fit: &Fit) -> Option<Self> {
        let variance = fit.residual_standard_deviation()?.powi(2);
        let known: Vec<usize> = (0..fit.values().len()).filter(|i| fit.relaxed_covariance(*i, *i).is_some()).collect();
        let columns = problem.columns(fit.values(), &known).ok()?;
        let pairs = known.iter().flat_map(|i| known.iter().map(move |j| (*i, *j)));
        let inverse = pairs.map(|(i, j)| fit.relaxed_covariance(i, j).unwrap_or(0.0) / variance).collect();
        Some(Self { known, columns, inverse })
    }

    /// The change of every parameter, (JᵀJ)⁻¹Jᵀd, that follows a change d of the residuals best.
    fn steps(&self, direction: &[f64]) -> Vec<f64> {
        let product = |column: &Vec<f64>| -> f64 { column.iter().zip(direction).map(|(a, d)| a * d).sum() };
        let products: Vec<f64> = self.columns.iter().map(product).collect();
        let rows = self.inverse.chunks(self.known.len().max(1));
        rows.map(|row| row.iter().zip(&products).map(|(weight, product)| weight * product).sum()).collect()
    }

    /// That of the parameter at place `index` among all, 0 if the fit does not determine it.
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
