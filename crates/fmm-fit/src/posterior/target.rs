//! Logarithm of a posterior density, and its gradient.

use std::ops::Range;

use fmm_model::Parameter;

use crate::algebra::sums::dot;
use crate::error::FitError;
use crate::posterior::prior::Prior;
use crate::posterior::transform::{Image, Transform};
use crate::problem::block::Structure;
use crate::problem::residuals::Residuals;
use crate::solver::evaluation::{Evaluator, Point};
use crate::solver::outcome::NonFinite;
use crate::uncertainty::profile_interval::ResidualVariance;

/// The density of the parameters and of the correlation of neighbouring residuals, given the data, over coordinates
/// without bounds.
///
/// ```text
/// ln p = −n/2 ln Q + b/2 ln(1 − ρ²) + Σ ln prior(θⱼ) + Σ ln|dθⱼ/dψⱼ|,     Q = rᵀ Λ r            σ integrated out
/// ln p = −Q/2      + …                                                                              σ = 1
/// ```
///
/// Λ σ⁻² is the inverse covariance of b series of autoregressive noise, Λ = 1 for ρ = 0; with Jeffreys' prior 1/σ the
/// integral over σ is closed. Its gradient takes one product Jᵀ Λ r.
pub(super) struct Target<'a, P: ?Sized> {
    problem: &'a P,
    evaluator: Evaluator,
    point: Point,
    /// One per free parameter, in the order of the problem.
    parts: Vec<(Transform, Prior)>,
    images: Vec<Image>,
    variance: ResidualVariance,
    /// The runs of neighbouring residuals, if the correlation of neighbours is a coordinate, the last one.
    series: Option<Vec<Range<usize>>>,
    /// Λ r.
    precise: Vec<f64>,
}

/// ρ of the last coordinate.
const CORRELATION: Transform = Transform::Between(-1.0, 1.0);

impl<P: ?Sized> Clone for Target<'_, P> {
    fn clone(&self) -> Self {
        Self {
            problem: self.problem,
            evaluator: self.evaluator.clone(),
            point: self.point.clone(),
            parts: self.parts.clone(),
            images: self.images.clone(),
            variance: self.variance,
            series: self.series.clone(),
            precise: self.precise.clone(),
        }
    }
}

impl<'a, P: Residuals + ?Sized> Target<'a, P> {
    /// The posterior of `problem` about `values`, with a prior for each of its parameters.
    ///
    /// # Errors
    /// [`FitError`] if the blocks of the problem do not fit it.
    pub(super) fn new(
        problem: &'a P,
        values: &[f64],
        priors: &[Prior],
        variance: ResidualVariance,
        is_correlated: bool,
    ) -> Result<Self, FitError> {
        let parameters = problem.parameters();
        let bounds = |j: usize| {
            let (own, support) = (parameters[j].bounds(), priors[j].support());
            own.at_least(support.lower()).at_most(support.upper())
        };
        let evaluator = Evaluator::of(problem, values)?;
        let parts = evaluator.free.iter().map(|&j| (Transform::of(bounds(j)), priors[j])).collect();
        let series = || {
            let mut first = 0;
            let blocks = problem.blocks().iter().map(|block| {
                first += block.rows();
                first - block.rows()..first
            });
            let series: Vec<Range<usize>> = blocks.filter(|rows| !rows.is_empty()).collect();
            if series.is_empty() { std::iter::once(0..problem.len()).collect() } else { series }
        };
        Ok(Self {
            problem,
            evaluator,
            point: Point { values: values.to_vec(), ..Point::default() },
            parts,
            images: Vec::new(),
            variance,
            series: is_correlated.then(series),
            precise: vec![0.0; problem.len()],
        })
    }

    pub(super) fn dimension(&self) -> usize {
        self.parts.len() + usize::from(self.series.is_some())
    }

    /// Indices of the free parameters.
    pub(super) fn free(&self) -> &[usize] {
        &self.evaluator.free
    }

    /// The transform of each parameter, and of ρ last, from its coordinate.
    pub(super) fn transforms(&self) -> Vec<Transform> {
        (0..self.dimension()).map(|place| self.transform(place)).collect()
    }

    pub(super) fn transform(&self, place: usize) -> Transform {
        self.parts.get(place).map_or(CORRELATION, |(transform, _)| *transform)
    }

    pub(super) fn non_finite(&self) -> Option<&NonFinite> {
        self.evaluator.non_finite.as_ref()
    }

    pub(super) fn parameters(&self) -> &[Parameter] {
        self.problem.parameters()
    }

    pub(super) fn residual_count(&self) -> usize {
        self.point.residuals.len()
    }

    /// True if the coordinate is that of an interval with an end.
    pub(super) fn is_bounded(&self, place: usize) -> bool {
        self.transform(place) != Transform::Identity
    }

    /// The values of all parameters last looked at.
    pub(super) fn values(&self) -> &[f64] {
        &self.point.values
    }

    /// Sets the parameters to those of the coordinates, and returns ρ with its image.
    fn place(&mut self, psi: &[f64]) -> Option<Image> {
        self.images.clear();
        self.images.extend(self.parts.iter().zip(psi).map(|((transform, _), psi)| transform.at(*psi)));
        for (&j, image) in self.evaluator.free.iter().zip(&self.images) {
            // Rounding may put a value on its bound, where the logarithm of a prior may end.
            self.point.values[j] = image.value;
        }
        self.series.as_ref().map(|_| CORRELATION.at(psi[psi.len() - 1]))
    }

    /// ln p at `psi`, a constant aside; `None` where the model has no finite value.
    pub(super) fn log_density(&mut self, psi: &[f64]) -> Option<f64> {
        let correlation = self.place(psi);
        let is_finite = self.evaluator.residuals(self.problem, &mut self.point);
        is_finite.then(|| self.of_residuals(correlation)).filter(|density| density.is_finite())
    }

    /// ln p at `psi` with its gradient; `None` where the model has no finite value.
    pub(super) fn log_density_and_gradient(&mut self, psi: &[f64], gradient: &mut [f64]) -> Option<f64> {
        let correlation = self.place(psi);
        if !self.evaluator.residuals_and_derivatives(self.problem, &mut self.point) {
            return None;
        }
        let density = self.of_residuals(correlation);
        let by_square = self.by_square(correlation);
        for (place, slope) in gradient[..self.parts.len()].iter_mut().enumerate() {
            let (image, prior) = (self.images[place], self.parts[place].1);
            let along = self.evaluator.product(self.evaluator.free[place], &self.precise);
            *slope = (2.0 * by_square * along + prior.at(image.value).slope) * image.slope + image.log_slope_by;
        }
        if let (Some(rho), Some(series)) = (correlation, &self.series) {
            let [_, by_rho] = square(&self.point.residuals, series, rho.value);
            let log_determinant = -(series.len() as f64) * rho.value / (1.0 - rho.value * rho.value);
            gradient[self.parts.len()] = (by_square * by_rho + log_determinant) * rho.slope + rho.log_slope_by;
        }
        (density.is_finite() && gradient.iter().all(|slope| slope.is_finite())).then_some(density)
    }

    /// ∂ ln p/∂Q.
    fn by_square(&self, correlation: Option<Image>) -> f64 {
        match self.variance {
            ResidualVariance::Unit => -0.5,
            ResidualVariance::Effective { variance, .. } => -0.5 / variance,
            ResidualVariance::Estimated => -0.5 * self.point.residuals.len() as f64 / self.square(correlation),
        }
    }

    /// Sum of squares Q of the residuals that were evaluated last.
    fn square(&self, correlation: Option<Image>) -> f64 {
        match (correlation, &self.series) {
            (Some(rho), Some(series)) => square(&self.point.residuals, series, rho.value)[0],
            _ => self.point.sum_of_squares,
        }
    }

    /// ln p of the residuals last evaluated; leaves Λ r behind.
    fn of_residuals(&mut self, correlation: Option<Image>) -> f64 {
        let square = self.square(correlation);
        let mut density = match self.variance {
            ResidualVariance::Unit => -0.5 * square,
            ResidualVariance::Effective { variance, .. } => -0.5 * square / variance,
            ResidualVariance::Estimated => -0.5 * self.point.residuals.len() as f64 * square.ln(),
        };
        match (correlation, &self.series) {
            (Some(rho), Some(series)) => {
                multiply_precision(&self.point.residuals, series, rho.value, &mut self.precise);
                density += 0.5 * series.len() as f64 * (-rho.value * rho.value).ln_1p() + rho.log_slope;
            }
            _ => self.precise.copy_from_slice(&self.point.residuals),
        }
        let parts = self.images.iter().zip(&self.parts);
        density + parts.map(|(image, (_, prior))| prior.at(image.value).value + image.log_slope).sum::<f64>()
    }

    /// Q and ρ at the coordinates last looked at, by which the noise of a draw is found.
    pub(super) fn square_and_correlation(&self, psi: &[f64]) -> (f64, f64) {
        let correlation = self.series.as_ref().map(|_| CORRELATION.at(psi[psi.len() - 1]));
        (self.square(correlation), correlation.map_or(0.0, |rho| rho.value))
    }

    /// The curvature of −ln p over the parameters, each in units of its dθ/dψ, and over the coordinates, with the bends
    /// of the model left out as Gauss and Newton do, after an evaluation with the gradient. Both by rows.
    pub(super) fn curvatures(&self, psi: &[f64]) -> [Vec<f64>; 2] {
        let (order, count) = (self.dimension(), self.parts.len());
        let correlation = self.series.as_ref().map(|_| CORRELATION.at(psi[psi.len() - 1]));
        let scale = -2.0 * self.by_square(correlation);
        let mut matrix = vec![0.0; order * order];
        let (mut column, mut weighted) = (vec![0.0; self.precise.len()], vec![0.0; self.precise.len()]);
        for b in 0..count {
            column.fill(0.0);
            for part in self.structure().columns_of(self.free()[b]) {
                column[part.rows].copy_from_slice(&self.evaluator.jacobian[part.elements]);
            }
            match (correlation, &self.series) {
                (Some(rho), Some(series)) => multiply_precision(&column, series, rho.value, &mut weighted),
                _ => weighted.copy_from_slice(&column),
            }
            for a in 0..=b {
                let sum = scale * self.evaluator.product(self.free()[a], &weighted);
                let element = sum * self.images[a].slope * self.images[b].slope;
                matrix[a * order + b] = element;
                matrix[b * order + a] = element;
            }
        }
        if let Some(rho) = correlation {
            // n/(1 − ρ²) of a long series.
            let information = self.precise.len() as f64 / (1.0 - rho.value * rho.value);
            matrix[order * order - 1] = information * rho.slope * rho.slope;
        }
        for place in 0..count {
            let (image, prior) = (self.images[place], self.parts[place].1.at(self.images[place].value));
            matrix[place * order + place] += prior.curvature * image.slope * image.slope;
        }
        let mut bent = matrix.clone();
        for place in 0..count {
            let (image, prior) = (self.images[place], self.parts[place].1.at(self.images[place].value));
            let downhill = scale * self.evaluator.product(self.free()[place], &self.precise) - prior.slope;
            bent[place * order + place] += (downhill * image.bend).max(0.0) + image.log_slope_curvature;
        }
        [matrix, bent]
    }

    /// ‖∂r/∂θ‖ for one of the free parameters, at the point last evaluated with its gradient.
    pub(super) fn column_norm(&self, place: usize) -> f64 {
        self.structure().square(&self.evaluator.jacobian, self.free()[place]).sqrt()
    }

    fn structure(&self) -> &Structure {
        &self.evaluator.structure
    }
}

/// rᵀ Λ r and its derivative by ρ. Λ of a series is tridiagonal: 1 at its ends, 1 + ρ² between, −ρ beside.
fn square(residuals: &[f64], series: &[Range<usize>], rho: f64) -> [f64; 2] {
    let (mut value, mut slope) = (0.0, 0.0);
    for rows in series {
        let run = &residuals[rows.clone()];
        let all = dot(run, run);
        let inner = if run.len() > 2 { dot(&run[1..run.len() - 1], &run[1..run.len() - 1]) } else { 0.0 };
        let lagged = dot(&run[1..], &run[..run.len() - 1]);
        if run.len() == 1 {
            // A residual by itself has the variance σ²/(1 − ρ²).
            value += (1.0 - rho * rho) * all;
            slope -= 2.0 * rho * all;
        } else {
            value += all + rho * rho * inner - 2.0 * rho * lagged;
            slope += 2.0 * rho * inner - 2.0 * lagged;
        }
    }
    [value, slope]
}

/// Λ times `column`.
fn multiply_precision(column: &[f64], series: &[Range<usize>], rho: f64, product: &mut [f64]) {
    for rows in series {
        let (run, out) = (&column[rows.clone()], &mut product[rows.clone()]);
        let last = run.len() - 1;
        if last == 0 {
            out[0] = (1.0 - rho * rho) * run[0];
            continue;
        }
        out[0] = run[0] - rho * run[1];
        out[last] = run[last] - rho * run[last - 1];
        for i in 1..last {
            out[i] = (1.0 + rho * rho) * run[i] - rho * (run[i - 1] + run[i + 1]);
        }
    }
}
