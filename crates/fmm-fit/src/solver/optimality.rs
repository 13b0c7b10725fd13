//! Optimality: distance of a point from a minimum.

use crate::solver::evaluation::{Evaluator, Point};
use crate::solver::spectrum::{Spectrum, is_surely_of_full_rank};
use crate::solver::triangle::Triangle;

/// Residuals this small against what the parameters move are rounding noise of the model.
const NOISE: f64 = 1e-12;

/// Whether rounding the parameters would move the residuals by as much as is left of them.
pub(crate) fn is_at_noise_floor(point: &Point, evaluator: &Evaluator) -> bool {
    let influence = |(column, &j): (usize, &usize)| point.values[j].abs() * point.triangle.column_norm(column);
    let reach: f64 = evaluator.free.iter().enumerate().map(influence).sum();
    point.sum_of_squares.sqrt() <= NOISE * reach
}

/// The largest cosine between the residual and a column of the Jacobian that is not held by a bound.
pub(crate) fn largest_cosine(point: &Point, evaluator: &Evaluator) -> f64 {
    let residual = point.triangle.residual_norm();
    let cosine = |column| point.triangle.gradient(column).abs() / (point.triangle.column_norm(column) * residual);
    // A column or a residual of zero gives NaN, which `max` passes over.
    loose(point, evaluator).map(cosine).fold(0.0, f64::max)
}

/// Norm of the part of the residual that the parameters not held by a bound can move.
pub(crate) fn projected_residual(point: &Point, evaluator: &Evaluator) -> f64 {
    let columns: Vec<usize> = loose(point, evaluator).collect();
    let mut face = Triangle::default();
    face.select(&point.triangle, &columns, |row| point.triangle.q(row), &mut Vec::new());
    let threshold = evaluator.scheme.rank_threshold(point.residuals.len());
    if is_surely_of_full_rank(&face, threshold) {
        (0..columns.len()).map(|row| face.q(row).powi(2)).sum::<f64>().sqrt()
    } else {
        let spectrum = Spectrum::of(&face);
        spectrum.along[..spectrum.rank(threshold)].iter().map(|along| along * along).sum::<f64>().sqrt()
    }
}

/// The free parameters, as columns, that do not lie on a bound that the gradient pushes them against.
pub(crate) fn loose<'a>(point: &'a Point, evaluator: &'a Evaluator) -> impl Iterator<Item = usize> + 'a {
    let is_held = |column: usize| {
        let (j, gradient) = (evaluator.free[column], point.triangle.gradient(column));
        (point.values[j] == evaluator.lower[j] && gradient > 0.0)
            || (point.values[j] == evaluator.upper[j] && gradient < 0.0)
    };
    (0..point.triangle.order()).filter(move |&column| !is_held(column))
}
