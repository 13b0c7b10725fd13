//! The step of a Levenberg–Marquardt method: least squares within a radius and a box.

use crate::algebra::spectrum::{Spectrum, is_surely_of_full_rank};
use crate::algebra::triangle::Triangle;
use crate::solver::box_least_squares::BoxLeastSquares;

/// Values that together move the residuals by less than this share of them are lost in their rounding.
const ROUNDING: f64 = 1e-13;

/// The linear model of the residuals at one point, and how far it is trusted.
///
/// ```text
/// minimise ‖R p + q‖²   subject to   ‖D p‖ ≤ Δ,   lower ≤ p ≤ upper
/// ```
///
/// | symbol | field | meaning |
/// |---|---|---|
/// | R, q | `model` | factor of the Jacobian and the residual |
/// | D | `scaling` | largest norm so far of each column of the Jacobian |
/// | Δ | `radius` | trusted length of `D p`, in the unit of the residuals |
///
/// # References
/// J. J. Moré, "The Levenberg–Marquardt algorithm: implementation and theory", Lect. Notes Math. 630 (1978) 105,
/// <https://doi.org/10.1007/BFb0067700>.
#[derive(Debug, Clone, Default)]
pub(crate) struct TrustRegion {
    pub(crate) radius: f64,
    pub(crate) scaling: Vec<f64>,
    model: Triangle,
    damped: Triangle,
    boxed: BoxLeastSquares,
    block: Vec<f64>,
    slope: Vec<f64>,
}

impl TrustRegion {
    /// Forgets everything; the radius becomes `factor · ‖D x‖` at the point `x`, and of a zero point `factor` times the
    /// norm of the residual.
    ///
    /// This is also the radius of a point that is as good as zero, since its own would be lost in rounding. There the
    /// columns say little of how far their parameters may go, so that each goes no further than its own size or one.
    pub(crate) fn begin(&mut self, triangle: &Triangle, x: impl Iterator<Item = f64> + Clone, factor: f64) {
        self.scaling.clear();
        self.scaling.extend((0..triangle.order()).map(|column| triangle.column_norm(column)));
        let (length, residual) = (self.scaled_length(x.clone()), triangle.residual_norm());
        self.radius = factor * if length > ROUNDING * residual { length } else { residual };
        if 0.0 < length && length <= ROUNDING * residual {
            for (scale, x) in self.scaling.iter_mut().zip(x) {
                *scale = scale.max(residual / x.abs().max(1.0));
            }
        }
    }

    /// `‖D p‖`.
    pub(crate) fn scaled_length(&self, p: impl Iterator<Item = f64>) -> f64 {
        self.scaling.iter().zip(p).map(|(d, p)| (d * p).powi(2)).sum::<f64>().sqrt()
    }

    /// Lets the scaling grow to the column norms of a newly accepted point.
    pub(crate) fn rescale(&mut self, triangle: &Triangle) {
        for (column, scale) in self.scaling.iter_mut().enumerate() {
            *scale = scale.max(triangle.column_norm(column));
        }
    }

    /// Takes `triangle` as the model. Directions whose scaled singular value is below `threshold` times the
    /// largest are not moved along: they are noise. Returns the rank.
    pub(crate) fn set_model(&mut self, triangle: &Triangle, threshold: f64) -> usize {
        if is_surely_of_full_rank(triangle, threshold) {
            self.model.copy_from(triangle);
            return triangle.order();
        }
        let spectrum = Spectrum::of(triangle);
        let rank = spectrum.rank(threshold);
        if rank == triangle.order() {
            self.model.copy_from(triangle);
        } else {
            spectrum.anchor(rank, &mut self.model, &mut self.block);
        }
        rank
    }

    /// The minimiser of the model in the box, however far.
    pub(crate) fn gauss_newton(&mut self, lower: &[f64], upper: &[f64]) -> &BoxLeastSquares {
        self.boxed.solve(&self.model, lower, upper);
        &self.boxed
    }

    /// The minimiser of the model in the box and, within a tenth, in the radius.
    ///
    /// The length of the minimiser of `‖R p + q‖² + λ ‖D p‖²` in the box falls with λ, so that a bracketed Newton
    /// iteration finds λ; its derivative comes from the components that are inside.
    pub(crate) fn propose(&mut self, lower: &[f64], upper: &[f64]) -> &BoxLeastSquares {
        self.boxed.solve(&self.model, lower, upper);
        let mut length = self.scaled_length(self.boxed.step.iter().copied());
        if length <= 1.1 * self.radius {
            return &self.boxed;
        }
        // From the variational inequality at p = 0: λ ‖D p‖ ≤ ‖D⁻¹ Jᵀ r‖.
        let steepest = self.scaling.iter().enumerate().filter(|(_, scale)| **scale > 0.0);
        let steepest: f64 = steepest.map(|(j, scale)| (self.model.gradient(j) / scale).powi(2)).sum();
        let (mut least, mut most) = (0.0, steepest.sqrt() / self.radius);
        let mut lambda = self.newton(0.0, length);
        for _ in 0..40 {
            if !(lambda > least && lambda < most) {
                lambda = (1e-3 * most).max((least * most).sqrt());
            }
            self.solve_damped(lambda, lower, upper);
            length = self.scaled_length(self.boxed.step.iter().copied());
            if (length - self.radius).abs() <= 0.1 * self.radius {
                break;
            }
            if length > self.radius {
                least = lambda;
            } else {
                most = lambda;
            }
            lambda = self.newton(lambda, length);
        }
        &self.boxed
    }

    fn solve_damped(&mut self, lambda: f64, lower: &[f64], upper: &[f64]) {
        let order = self.model.order();
        self.block.clear();
        self.block.resize(order * (order + 1), 0.0);
        for (j, scale) in self.scaling.iter().enumerate() {
            self.block[j * order + j] = lambda.sqrt() * scale;
        }
        self.damped.copy_from(&self.model);
        self.damped.fold(&mut self.block);
        self.boxed.solve(&self.damped, lower, upper);
    }

    /// Newton's next λ for `1/‖D p(λ)‖ = 1/Δ`, in which the length is nearly linear.
    fn newton(&mut self, lambda: f64, length: f64) -> f64 {
        let boxed = &self.boxed;
        self.slope.clear();
        self.slope.extend(boxed.inside.iter().map(|&j| self.scaling[j].powi(2) * boxed.step[j]));
        boxed.face.solve_transposed(&mut self.slope);
        let square: f64 = self.slope.iter().map(|z| z * z).sum();
        lambda + (length / self.radius) * (length - self.radius) * length / square
    }

    /// The reduction of `½ ‖r‖²` that `triangle` predicts for the step last proposed.
    pub(crate) fn predicted_reduction(&self, triangle: &Triangle) -> f64 {
        let along = |row| triangle.row_times(row, &self.boxed.step);
        -(0..triangle.order()).map(|row| along(row) * (triangle.q(row) + 0.5 * along(row))).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(radius: f64) -> (TrustRegion, Triangle) {
        let mut triangle = Triangle::default();
        triangle.reset(3);
        // Columns of very different length, as parameters in different units have.
        let mut block = vec![1.0, 2.0, -1.0, 0.5, 30.0, 10.0, 20.0, -40.0, 1e-3, 3e-3, 0.0, 2e-3, 5.0, -3.0, 2.0, 1.0];
        triangle.fold(&mut block);
        let mut region = TrustRegion::default();
        region.begin(&triangle, [1.0, 1.0, 1.0].into_iter(), 1.0);
        region.radius = radius;
        assert_eq!(region.set_model(&triangle, 1e-12), 3);
        (region, triangle)
    }

    #[test]
    fn a_step_fills_the_radius_or_is_the_full_one() {
        let (lower, upper) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        let (mut unlimited, _) = region(1e9);
        let full = unlimited.propose(&lower, &upper).step.clone();
        assert_eq!(full, unlimited.gauss_newton(&lower, &upper).step);
        for radius in [1e-9, 1e-3, 0.1, 1.0] {
            let (mut region, triangle) = region(radius);
            let step = region.propose(&lower, &upper).step.clone();
            let length = region.scaled_length(step.iter().copied());
            assert!((length / radius - 1.0).abs() < 0.1 + 1e-12, "length {length} for a radius of {radius}");
            // The prediction is that of the linear model.
            let misfit = |p: &[f64]| -> f64 {
                0.5 * (0..3).map(|row| (triangle.row_times(row, p) + triangle.q(row)).powi(2)).sum::<f64>()
            };
            let expected = misfit(&[0.0; 3]) - misfit(&step);
            // The difference of two numbers of order ten.
            assert!((region.predicted_reduction(&triangle) - expected).abs() < 1e-14 * 10.0);
        }
    }

    /// The second and third parameter do the same, and a bound holds the third. The second then moves with a part along
    /// the direction that the residuals do not see, and here across one that they hardly see.
    #[test]
    fn a_step_along_a_bound_gains_what_it_would_without_the_parameter_that_is_held() {
        let measured: Vec<f64> = (0..6).map(|i| -(1.0 + 7.0 * f64::from(i)).sin()).collect();
        let level: Vec<f64> = (0..6).map(|i| 1.0 + 0.01 * f64::from(i)).collect();
        let gain = |columns: &[Vec<f64>], lower: &[f64]| {
            let mut triangle = Triangle::default();
            triangle.reset(columns.len());
            triangle.fold(&mut columns.iter().chain([&measured]).flatten().copied().collect::<Vec<_>>());
            let mut region = TrustRegion::default();
            region.begin(&triangle, columns.iter().map(|_| 1.0), 1.0);
            assert_eq!(region.set_model(&triangle, 1e-12), 2);
            region.gauss_newton(lower, &[f64::INFINITY; 3][..columns.len()]);
            (region.predicted_reduction(&triangle), region.boxed.step.clone())
        };
        let ones = vec![1.0; 6];
        let (alone, step) = gain(&[ones.clone(), level.clone()], &[f64::NEG_INFINITY; 2]);
        assert!(step[1] < 0.0, "the bound would not hold: {step:?}");
        let (held, step) = gain(&[ones, level.clone(), level], &[f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0]);
        assert_eq!(step[2], 0.0);
        assert!(held > (1.0 - 1e-5) * alone, "{held} of {alone}");
    }

    #[test]
    fn a_step_keeps_to_box_and_radius_together() {
        let (lower, upper) = ([-1e-3, f64::NEG_INFINITY, 0.0], [1.0, f64::INFINITY, 10.0]);
        for radius in [1e-3, 0.1, 1.0, 1e3] {
            let (mut region, _) = region(radius);
            let step = region.propose(&lower, &upper).step.clone();
            let length = region.scaled_length(step.iter().copied());
            assert!(length <= 1.1 * radius, "length {length} for a radius of {radius}");
            for j in 0..3 {
                assert!(lower[j] <= step[j] && step[j] <= upper[j], "component {j} is {}", step[j]);
            }
        }
    }
}
