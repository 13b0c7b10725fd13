//! Prior and posterior of a friction curve: mixtures of the shapes of laws with a smooth remainder.

use nalgebra::{Cholesky, DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::friction_curve::levels::{KNOTS, LEVELS};
use crate::friction_curve::rules::{
    AMPLITUDES, FALL_SPEEDS, LEAST_WEIGHT, LEVEL_AND_LINE, REMAINDERS, SHAPELESS, SMOOTH_FROM,
};

/// Families of falling friction, from 1 at rest towards 0, over the speed in fall speeds: those of the catalogue.
const SHAPES: [fn(f64) -> f64; 4] = [|x| (-x * x).exp(), |x| (-x).exp(), |x| 1.0 / (1.0 + x * x), |x| 1.0 / (1.0 + x)];

/// Knowledge of a friction curve before a record, relative to a scale of friction.
///
/// ```text
/// b = α 1 + β s + a f_j(s) + r,     α, β ~ N(0, A²),   a ~ N(0, σ_a²) or none,   r ~ N(0, τ² K)
/// ```
///
/// f_j is one of the falling shapes of the catalogue at one fall speed. The remainder r is an integrated random walk
/// over u = ln(1 + s/s₀), which begins at the top speed with value and slope zero: its second differences over u have
/// the variance τ². Each choice of shape, σ_a and τ is one component.
#[derive(Debug, Clone)]
pub(super) struct Prior {
    /// Factors L of the covariances L Lᵀ without a shape, one a τ.
    bases: Vec<DMatrix<f64>>,
    shapes: Vec<Shape>,
}

/// Falling friction at the speeds of the levels.
#[derive(Debug, Clone)]
struct Shape {
    values: DVector<f64>,
    /// Square of each σ_a and its weight.
    sizes: Vec<(f64, f64)>,
}

impl Prior {
    pub(super) fn new() -> Self {
        let u = KNOTS.map(|s| (1.0 + s / SMOOTH_FROM).ln());
        let distance = u.map(|at| u[LEVELS - 1] - at);
        let walk = |i: usize, j: usize| {
            let (near, far) = (distance[i].min(distance[j]), distance[i].max(distance[j]));
            near * near * (3.0 * far - near) / 6.0
        };
        let base = |deviation: f64| {
            let covariance = DMatrix::from_fn(LEVELS, LEVELS, |i, j| {
                let line = 1.0 + KNOTS[i] * KNOTS[j];
                LEVEL_AND_LINE.powi(2) * line + deviation * deviation * walk(i, j)
            });
            factor(&covariance)
        };
        let count = (SHAPES.len() * FALL_SPEEDS.len() * AMPLITUDES.len()) as f64;
        let mut shapes = vec![Shape { values: DVector::zeros(LEVELS), sizes: vec![(0.0, SHAPELESS)] }];
        for shape in SHAPES {
            for fall in FALL_SPEEDS {
                let values = DVector::from_iterator(LEVELS, KNOTS.map(|s| shape(s / fall)));
                let weight = (1.0 - SHAPELESS) / count;
                let sizes = AMPLITUDES.map(|deviation| (deviation * deviation, weight)).to_vec();
                shapes.push(Shape { values, sizes });
            }
        }
        Self { bases: REMAINDERS.map(base).to_vec(), shapes }
    }

    /// The posterior by a likelihood ηᵀb − ½ bᵀΛb, with `precision` Λ and `information` η.
    ///
    /// ```text
    /// no shape:  C = L (1 + LᵀΛL)⁻¹ Lᵀ,   m = C η,   ln Z = ½ ηᵀ m − ½ ln det(1 + LᵀΛL)
    /// shape f:   g = f − C Λ f,   q = fᵀΛg,   t = fᵀ(η − Λm),   d = 1 + σ_a² q
    ///            b = m + a g,   a ~ N(σ_a² t/d, σ_a²/d),   ln Z + ½ σ_a² t²/d − ½ ln d
    /// ```
    pub(super) fn posterior(&self, precision: &DMatrix<f64>, information: &DVector<f64>) -> Posterior {
        let by_shapes: Vec<DVector<f64>> = self.shapes.iter().map(|shape| precision * &shape.values).collect();
        let (mut bases, mut parts, mut evidences) = (Vec::with_capacity(self.bases.len()), Vec::new(), Vec::new());
        for root in &self.bases {
            let inner = DMatrix::identity(LEVELS, LEVELS) + root.transpose() * precision * root;
            let Some(inner) = Cholesky::new(inner) else { continue };
            let log_determinant = 2.0 * inner.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
            // C = (L U)(L U)ᵀ with U Uᵀ the inverse: T = L W⁻ᵀ of 1 + LᵀΛL = W Wᵀ.
            let Some(whitened) = inner.l().solve_lower_triangular(&root.transpose()) else { continue };
            let spread = whitened.transpose();
            let mean = &spread * (&whitened * information);
            let evidence = 0.5 * information.dot(&mean) - 0.5 * log_determinant;
            let left = information - precision * &mean;
            for (Shape { values, sizes }, by_shape) in self.shapes.iter().zip(&by_shapes) {
                let direction = values - &spread * (&whitened * by_shape);
                let (curvature, along) = (by_shape.dot(&direction).max(0.0), values.dot(&left));
                for (square, weight) in sizes {
                    let divisor = 1.0 + square * curvature;
                    let (amplitude, direction) = (square * along / divisor, direction.clone());
                    evidences.push(weight.ln() + evidence + 0.5 * amplitude * along - 0.5 * divisor.ln());
                    let variance = square / divisor;
                    parts.push(Part { weight: 0.0, base: bases.len(), amplitude, variance, direction });
                }
            }
            bases.push(Base { mean, spread });
        }
        let best = evidences.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (part, evidence) in parts.iter_mut().zip(&evidences) {
            part.weight = (evidence - best).exp();
        }
        parts.retain(|part| part.weight > LEAST_WEIGHT);
        let sum: f64 = parts.iter().map(|part| part.weight).sum();
        for part in &mut parts {
            part.weight /= sum;
        }
        Posterior { bases, parts }
    }
}

/// L of a covariance L Lᵀ that may be singular but for rounding.
fn factor(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = covariance.clone().symmetric_eigen();
    let roots = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
    eigen.eigenvectors * DMatrix::from_diagonal(&roots)
}

/// Posterior of a friction curve, relative to a scale of friction: a mixture of Gaussians.
#[derive(Debug, Clone)]
pub(super) struct Posterior {
    bases: Vec<Base>,
    parts: Vec<Part>,
}

#[derive(Debug, Clone)]
struct Base {
    mean: DVector<f64>,
    /// T of the covariance T Tᵀ.
    spread: DMatrix<f64>,
}

#[derive(Debug, Clone)]
struct Part {
    weight: f64,
    base: usize,
    amplitude: f64,
    variance: f64,
    direction: DVector<f64>,
}

impl Posterior {
    /// True if there is a mean, and it is a number.
    pub(super) fn is_finite(&self) -> bool {
        !self.parts.is_empty() && self.mean().iter().all(|level| level.is_finite())
    }

    /// Mean curve.
    pub(super) fn mean(&self) -> DVector<f64> {
        let mut mean = DVector::zeros(LEVELS);
        for part in &self.parts {
            mean += (&self.bases[part.base].mean + &part.direction * part.amplitude) * part.weight;
        }
        mean
    }

    /// Covariance of the levels.
    pub(super) fn covariance(&self) -> DMatrix<f64> {
        let mean = self.mean();
        let mut covariance = DMatrix::zeros(LEVELS, LEVELS);
        for part in &self.parts {
            let base = &self.bases[part.base];
            let off = &base.mean + &part.direction * part.amplitude - &mean;
            let own = &base.spread * base.spread.transpose();
            let along = &part.direction * part.direction.transpose() * part.variance;
            covariance += (own + along + &off * off.transpose()) * part.weight;
        }
        covariance
    }

    /// Weight, mean and variance in each part of what has these weights over the levels.
    pub(super) fn marginal(&self, weights: &[f64; LEVELS]) -> Vec<(f64, f64, f64)> {
        let weights = DVector::from_column_slice(weights);
        let bases: Vec<(f64, f64)> = self
            .bases
            .iter()
            .map(|base| (weights.dot(&base.mean), base.spread.tr_mul(&weights).norm_squared()))
            .collect();
        let part = |part: &Part| {
            let ((mean, variance), along) = (bases[part.base], weights.dot(&part.direction));
            (part.weight, mean + along * part.amplitude, variance + along * along * part.variance)
        };
        self.parts.iter().map(part).collect()
    }

    /// Standard deviation of each level.
    pub(super) fn deviations(&self) -> [f64; LEVELS] {
        std::array::from_fn(|level| {
            let parts = self.marginal(&std::array::from_fn(|i| if i == level { 1.0 } else { 0.0 }));
            moments(&parts).1
        })
    }

    /// `count` draws of the curve, the same each time.
    pub(super) fn draws(&self, count: usize) -> Vec<DVector<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let (mut before, mut draws) = (0.0, Vec::with_capacity(count));
        for part in &self.parts {
            // As many of each part as its weight says.
            let next = before + part.weight * count as f64;
            for _ in (before.round() as usize)..(next.round() as usize) {
                let base = &self.bases[part.base];
                let independent = DVector::from_fn(LEVELS, |_, _| normal());
                let amplitude = part.amplitude + part.variance.sqrt() * normal();
                draws.push(&base.mean + &base.spread * independent + &part.direction * amplitude);
            }
            before = next;
        }
        draws
    }
}

/// Mean and standard deviation of a mixture of these parts: weight, mean and variance of each.
pub(super) fn moments(parts: &[(f64, f64, f64)]) -> (f64, f64) {
    let mean: f64 = parts.iter().map(|(weight, mean, _)| weight * mean).sum();
    let variance: f64 = parts.iter().map(|(weight, own, variance)| weight * (variance + (own - mean).powi(2))).sum();
    (mean, variance.sqrt())
}
