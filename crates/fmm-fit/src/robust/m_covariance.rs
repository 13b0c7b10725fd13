//! Covariance of robust estimates.

use crate::algebra::definite::{add_square, inverse, quadratic_form};
use crate::algebra::spectrum::Spectrum;
use crate::algebra::triangle::Triangle;
use crate::problem::block::{ByRow, Scratch};
use crate::problem::residuals::Residuals;
use crate::result::fit::Fit;
use crate::robust::problem::Robust;
use crate::solver::evaluation::{Evaluator, Linearised};

/// The covariance of the estimates of `fit` to `problem`, as a square matrix over all parameters; `None` where a
/// parameter is fixed, at a bound or not determined, or where the residuals cannot tell.
///
/// ```text
/// V = B⁻¹ C B⁻¹,     B = Σ ψ′ᵢ Jᵢ Jᵢᵀ,     C = Σ (ψᵢ/(1 − hᵢ))² Jᵢ Jᵢᵀ,     hᵢ = ψ′ᵢ Jᵢᵀ B⁻¹ Jᵢ
/// ```
///
/// Everything is computed in the coordinates in which `Σ (∂r̃/∂θ)(∂r̃/∂θ)ᵀ` is the identity, so that the conditioning
/// of the Jacobian is not squared.
pub(crate) fn m_covariance<P: Residuals>(problem: &Robust<P>, fit: &Fit) -> Vec<Option<f64>> {
    let count = fit.values().len();
    let mut covariance = vec![None; count * count];
    let elements = || {
        let linearised = Evaluator::linearise(problem.problem(), fit.values())?;
        Coordinates::of(problem, fit, &linearised).covariance(problem, &linearised, count)
    };
    if let Some((columns, matrix)) = elements() {
        let is_determined = |j: usize| fit.unit_covariance(j, j).is_some();
        for (a, &i) in columns.iter().enumerate().filter(|(_, i)| is_determined(**i)) {
            for (b, &j) in columns.iter().enumerate().filter(|(_, j)| is_determined(**j)) {
                covariance[i * count + j] = Some(matrix[a * columns.len() + b]);
            }
        }
    }
    covariance
}

/// Coordinates along the directions that the residuals determine: `θ = T c`.
struct Coordinates {
    /// Parameters neither fixed nor at a bound.
    columns: Vec<usize>,
    rank: usize,
    /// T, row after row, one per column.
    transform: Vec<f64>,
}

impl Coordinates {
    fn of<P: Residuals>(problem: &Robust<P>, fit: &Fit, linearised: &Linearised) -> Self {
        let Linearised { residuals, structure, jacobian, scheme } = linearised;
        let estimates = fit.estimates().iter().enumerate();
        let is_inside = |estimate: &crate::result::estimate::Estimate| {
            !estimate.status().is_at_bound() && estimate.status() != crate::result::estimate::EstimateStatus::Fixed
        };
        let columns: Vec<usize> = estimates.filter(|(_, estimate)| is_inside(estimate)).map(|(j, _)| j).collect();
        let mut replaced = jacobian.clone();
        problem.replace(&mut residuals.clone(), Some(&mut replaced));
        let mut triangle = Triangle::default();
        structure.factor(&replaced, &columns, residuals, &mut triangle, &mut Scratch::default());
        let spectrum = Spectrum::of(&triangle);
        let rank = spectrum.rank(scheme.rank_threshold(residuals.len()));
        let along = |j: usize, k: usize| spectrum.right[k][j] / (spectrum.singular[k] * spectrum.scales[j]);
        let transform = (0..columns.len()).flat_map(|j| (0..rank).map(move |k| (j, k))).map(|(j, k)| along(j, k));
        Self { rank, transform: transform.collect(), columns }
    }

    /// One row of the Jacobian in these coordinates.
    fn row(&self, derivatives: &ByRow, jacobian: &[f64], i: usize, row: &mut [f64]) {
        row.fill(0.0);
        for (column, transform) in self.columns.iter().zip(self.transform.chunks_exact(self.rank)) {
            let derivative = derivatives.element(jacobian, i, *column);
            for (element, t) in row.iter_mut().zip(transform) {
                *element += derivative * t;
            }
        }
    }

    /// The covariance over the columns; `None` if the point is not a minimum or a residual has no freedom.
    fn covariance<P: Residuals>(
        self,
        problem: &Robust<P>,
        linearised: &Linearised,
        count: usize,
    ) -> Option<(Vec<usize>, Vec<f64>)> {
        let Linearised { residuals, structure, jacobian, .. } = linearised;
        let (rank, loss, derivatives) = (self.rank, problem.loss(), structure.by_row(count));
        if rank == 0 || residuals.len() <= rank {
            return None;
        }
        let mut row = vec![0.0; rank];
        let mut bread = vec![0.0; rank * rank];
        for (i, r) in residuals.iter().enumerate() {
            self.row(&derivatives, jacobian, i, &mut row);
            add_square(&mut bread, &row, loss.slope(problem.square(*r)));
        }
        let inverse = inverse(&bread, rank)?;
        let mut meat = vec![0.0; rank * rank];
        for (i, r) in residuals.iter().enumerate() {
            self.row(&derivatives, jacobian, i, &mut row);
            let z = problem.square(*r);
            let leverage = loss.slope(z) * quadratic_form(&inverse, &row, &row);
            let (score, freedom) = (r * loss.weight(z), 1.0 - leverage);
            // A residual that its own parameter makes zero says nothing about its scatter.
            if freedom < 1e-9 {
                return None;
            }
            add_square(&mut meat, &row, (score / freedom).powi(2));
        }
        // Rows of T B⁻¹.
        let half: Vec<f64> = self
            .transform
            .chunks_exact(rank)
            .flat_map(|t| {
                inverse.chunks_exact(rank).map(|column| t.iter().zip(column).map(|(a, b)| a * b).sum::<f64>())
            })
            .collect();
        let width = self.columns.len();
        let mut covariance = vec![0.0; width * width];
        for (a, left) in half.chunks_exact(rank).enumerate() {
            for (b, right) in half.chunks_exact(rank).enumerate() {
                covariance[a * width + b] = quadratic_form(&meat, left, right);
            }
        }
        Some((self.columns, covariance))
    }
}
