//! Linear least squares to the last digit that the data allow.

use crate::algebra::spectrum::Spectrum;
use crate::algebra::triangle::Triangle;
use crate::regression::double_double::DoubleDouble;

/// The solution of `min ‖y − X β‖²`.
#[derive(Debug, Clone)]
pub(crate) struct RefinedLeastSquares {
    /// β; the shortest of all solutions, in columns of unit length, if the rank is not full.
    pub(crate) solution: Vec<DoubleDouble>,
    /// y − X β.
    pub(crate) residuals: Vec<f64>,
    /// Singular values of the columns scaled to unit length, and these lengths.
    pub(crate) spectrum: Spectrum,
    pub(crate) rank: usize,
}

/// Corrections after which nothing is gained: each brings as many digits as the condition number leaves of sixteen.
const CORRECTIONS: usize = 12;

/// Corrections smaller than this, relative to the solution, do not change the sixteen digits of anything computed
/// from it, cancellation of ten digits included.
const NEGLIGIBLE: f64 = 1e-27;

/// Solves `min ‖y − X β‖²` by QR factorisation and iterative refinement; `None` if the numbers overflow.
///
/// ```text
/// β ← β + R⁻¹ R⁻ᵀ Xᵀ (y − X β)
/// ```
///
/// with the residual and its products in twice the precision. As the gradient is right to the last digit, the
/// corrections end at the solution for the columns as they are, not for columns perturbed by the rounding of the
/// factorisation. Columns are given in twice the precision too: a weight or a power of an abscissa is then not rounded
/// first.
///
/// # References
/// Å. Björck, "Stability analysis of the method of seminormal equations for linear least squares problems", Linear
/// Algebra Appl. 88/89 (1987) 31, <https://doi.org/10.1016/0024-3795(87)90101-7>.
pub(crate) fn refined_least_squares(
    mut columns: Vec<Vec<DoubleDouble>>,
    y: &[DoubleDouble],
) -> Option<RefinedLeastSquares> {
    let (order, rows) = (columns.len(), y.len());
    // Powers of two change no digit, and keep squares from overflowing.
    let factors: Vec<f64> = columns.iter().map(|column| unit_factor(column)).collect();
    for (column, factor) in columns.iter_mut().zip(&factors) {
        for element in column {
            *element = element.scaled(*factor);
        }
    }
    let y_factor = unit_factor(y);
    let y: Vec<DoubleDouble> = y.iter().map(|element| element.scaled(y_factor)).collect();

    let flat: Vec<f64> = columns.iter().flatten().map(|element| element.value()).collect();
    let right: Vec<f64> = y.iter().map(|element| -element.value()).collect();
    let all: Vec<usize> = (0..order).collect();
    let mut triangle = Triangle::default();
    triangle.factor(&flat, &all, &right, &mut Vec::new());
    if !triangle.is_finite() {
        return None;
    }
    let mut spectrum = Spectrum::of(&triangle);
    let rank = spectrum.rank(rows as f64 * f64::EPSILON);
    let mut solution: Vec<DoubleDouble> = (0..order)
        .map(|j| {
            let directions = spectrum.right.iter().zip(&spectrum.along).zip(&spectrum.singular).take(rank);
            let sum: f64 = directions.map(|((right, along), singular)| right[j] * along / singular).sum();
            DoubleDouble::from(-sum / spectrum.scales[j])
        })
        .collect();
    let mut residuals = residuals_of(&columns, &y, &solution);
    if rank == order {
        refine(&triangle, &spectrum.scales, &columns, &y, &mut solution, &mut residuals);
    }
    for ((value, factor), scale) in solution.iter_mut().zip(&factors).zip(&mut spectrum.scales) {
        *value = value.scaled(*factor).scaled(1.0 / y_factor);
        *scale /= factor;
    }
    let residuals: Vec<f64> = residuals.iter().map(|r| r.value() / y_factor).collect();
    let is_finite = solution.iter().map(|value| value.value()).chain(residuals.iter().copied()).all(f64::is_finite);
    is_finite.then_some(RefinedLeastSquares { solution, residuals, spectrum, rank })
}

/// Corrects the solution until it no longer changes.
fn refine(
    triangle: &Triangle,
    scales: &[f64],
    columns: &[Vec<DoubleDouble>],
    y: &[DoubleDouble],
    solution: &mut [DoubleDouble],
    residuals: &mut Vec<DoubleDouble>,
) {
    let order = columns.len();
    let norm = |values: &mut dyn Iterator<Item = f64>| {
        values.zip(scales).map(|(value, scale)| (value * scale).powi(2)).sum::<f64>().sqrt()
    };
    let mut last = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let mut step: Vec<f64> = columns
            .iter()
            .map(|column| column.iter().zip(residuals.iter()).map(|(x, r)| *x * *r).sum::<DoubleDouble>().value())
            .collect();
        triangle.solve_transposed(&mut step);
        for row in (0..order).rev() {
            let sum: f64 = (row + 1..order).map(|column| triangle.r(row, column) * step[column]).sum();
            step[row] = (step[row] - sum) / triangle.r(row, row);
        }
        let length = norm(&mut step.iter().copied());
        // A correction that is no smaller than the one before is rounding noise; so is one that is not a number.
        if !(length < 0.5 * last) {
            return;
        }
        last = length;
        for (value, step) in solution.iter_mut().zip(&step) {
            *value = *value + DoubleDouble::from(*step);
        }
        *residuals = residuals_of(columns, y, solution);
        if length <= NEGLIGIBLE * norm(&mut solution.iter().map(|value| value.value())) {
            return;
        }
    }
}

/// `y − X β`.
fn residuals_of(columns: &[Vec<DoubleDouble>], y: &[DoubleDouble], solution: &[DoubleDouble]) -> Vec<DoubleDouble> {
    let mut residuals = y.to_vec();
    for (column, value) in columns.iter().zip(solution) {
        for (residual, x) in residuals.iter_mut().zip(column) {
            *residual = *residual - *x * *value;
        }
    }
    residuals
}

/// The power of two that brings the largest magnitude near 1.
fn unit_factor(values: &[DoubleDouble]) -> f64 {
    let largest = values.iter().fold(0.0f64, |largest, value| largest.max(value.value().abs()));
    if largest > 0.0 && largest.is_finite() { (-largest.log2().floor()).clamp(-1000.0, 1000.0).exp2() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hilbert_matrix_is_solved_to_the_last_digit() {
        // Columns 1/(i + j + 1) of twelve rows and eight columns, condition about 1e9, y = X·(1, …, 1) + residual: the
        // residual is orthogonal to nothing, so that the solution is compared with one at twice the precision by the
        // gradient that it leaves.
        let columns: Vec<Vec<DoubleDouble>> =
            (0..8).map(|j| (0..12).map(|i| DoubleDouble::from(1.0 / f64::from(i + j + 1))).collect()).collect();
        let y: Vec<DoubleDouble> = (0..12).map(|i| DoubleDouble::from(f64::from((i * 7) % 5))).collect();
        let found = refined_least_squares(columns.clone(), &y).unwrap();
        assert_eq!(found.rank, 8);
        let residuals = residuals_of(&columns, &y, &found.solution);
        for column in &columns {
            let gradient: DoubleDouble = column.iter().zip(&residuals).map(|(x, r)| *x * *r).sum();
            // ε² times the largest term of the residual, a coefficient of 1e9.
            assert!(gradient.value().abs() < 1e-20, "gradient {}", gradient.value());
        }
    }

    #[test]
    fn extreme_units_do_not_overflow() {
        let columns = vec![vec![DoubleDouble::from(1e200), DoubleDouble::from(2e200), DoubleDouble::from(3e200)]];
        let y = [1e-200, 2e-200, 3.3e-200].map(DoubleDouble::from);
        let found = refined_least_squares(columns, &y);
        // The slope would be 1e-400.
        assert!(found.is_none_or(|found| found.solution[0].value() == 0.0));
        let columns = vec![vec![DoubleDouble::from(1e200), DoubleDouble::from(2e200), DoubleDouble::from(3e200)]];
        let y = [1e190, 2e190, 3e190].map(DoubleDouble::from);
        let slope = refined_least_squares(columns, &y).unwrap().solution[0].value();
        assert!((slope / 1e-10 - 1.0).abs() < 1e-15, "slope {slope}");
    }
}
