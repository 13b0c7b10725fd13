//! Quantiles and random values of all distributions.

use rand::{Rng, RngExt};
use rand_distr::{Distribution as _, Exp1, StandardNormal};
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::gamma::gamma_ur;

use super::{Distribution, Shape};
use crate::UncertaintyError;
use crate::distributions::gamma::gamma_quantile;
use crate::distributions::student;

impl Distribution {
    /// The value that the quantity does not exceed with the given probability.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless the probability lies between 0 and 1.
    pub fn quantile(&self, probability: f64) -> Result<f64, UncertaintyError> {
        Ok(self.quantile_at(crate::gum::coverage::valid_level(probability)?))
    }

    /// The quantile of a probability in (0, 1).
    pub(crate) fn quantile_at(&self, probability: f64) -> f64 {
        match &self.shape {
            Shape::Constant(value) => *value,
            Shape::Rectangular { lower, upper } => lower + (upper - lower) * probability,
            Shape::CurvilinearTrapezoid(shape) => shape.quantile(probability),
            Shape::Trapezoid(shape) => shape.quantile(probability),
            Shape::ArcSine(shape) => shape.quantile(probability),
            Shape::Normal { mean, standard_deviation } => {
                mean + standard_deviation * Normal::standard().inverse_cdf(probability)
            }
            Shape::StudentT { mean, scale, degrees_of_freedom, .. } => {
                mean + scale * student::quantile(probability, *degrees_of_freedom)
            }
            Shape::Exponential { mean } => -mean * (-probability).ln_1p(),
            Shape::Gamma { shape, scale, .. } => scale * gamma_quantile(*shape, probability),
            Shape::Triangle(shape) => shape.quantile(probability),
            Shape::Beta(shape) => shape.quantile(probability),
            Shape::TruncatedNormal(shape) => shape.quantile(probability),
            Shape::LogNormal { median, deviation } => {
                median * (deviation * Normal::standard().inverse_cdf(probability)).exp()
            }
            Shape::Poisson { mean, .. } => poisson_quantile(*mean, probability),
            Shape::Empirical(shape) => shape.quantile(probability),
        }
    }

    /// A random value.
    pub fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        let mut value = [0.0];
        self.fill(rng, &mut value, 1);
        value[0]
    }

    /// Random values for every `stride`th element, the first included. One choice of distribution serves them all.
    pub(crate) fn fill<R: Rng + ?Sized>(&self, rng: &mut R, values: &mut [f64], stride: usize) {
        match &self.shape {
            Shape::Constant(value) => each(values, stride, || *value),
            Shape::Rectangular { lower, upper } => {
                each(values, stride, || lower + (upper - lower) * rng.random::<f64>());
            }
            Shape::CurvilinearTrapezoid(shape) => each(values, stride, || shape.sample(rng)),
            Shape::Trapezoid(shape) => each(values, stride, || shape.sample(rng)),
            Shape::ArcSine(shape) => each(values, stride, || shape.sample(rng)),
            Shape::Normal { mean, standard_deviation } => each(values, stride, || {
                let z: f64 = StandardNormal.sample(rng);
                mean + standard_deviation * z
            }),
            Shape::StudentT { mean, scale, unit, .. } => each(values, stride, || mean + scale * unit.sample(rng)),
            Shape::Exponential { mean } => each(values, stride, || {
                let e: f64 = Exp1.sample(rng);
                mean * e
            }),
            Shape::Gamma { sampler, .. } => each(values, stride, || sampler.sample(rng)),
            Shape::Triangle(shape) => each(values, stride, || shape.sample(rng)),
            Shape::Beta(shape) => each(values, stride, || shape.sample(rng)),
            Shape::TruncatedNormal(shape) => each(values, stride, || shape.sample(rng)),
            Shape::LogNormal { median, deviation } => each(values, stride, || {
                let z: f64 = StandardNormal.sample(rng);
                median * (deviation * z).exp()
            }),
            Shape::Poisson { sampler, .. } => each(values, stride, || sampler.sample(rng)),
            Shape::Empirical(shape) => each(values, stride, || shape.sample(rng)),
        }
    }
}

/// Draws every `stride`th element. Each distribution has this loop to itself, so that its sampler is inlined there.
fn each(values: &mut [f64], stride: usize, mut draw: impl FnMut() -> f64) {
    for value in values.iter_mut().step_by(stride) {
        *value = draw();
    }
}

/// The smallest number of events of which as many or fewer have at least the given probability, Q(k + 1, λ).
fn poisson_quantile(mean: f64, probability: f64) -> f64 {
    let reaches = |count: f64| gamma_ur(count + 1.0, mean) >= probability;
    // Twice as far from the mean each time, until it is between, and then halves.
    let (mut below, mut above, mut step) = (mean.floor(), mean.floor(), mean.sqrt().ceil());
    while !reaches(above) {
        (below, above, step) = (above, above + step, 2.0 * step);
    }
    while below >= 0.0 && reaches(below) {
        (above, below, step) = (below, below - step, 2.0 * step);
    }
    let mut below = below.max(-1.0);
    while above - below > 1.0 {
        let middle = (0.5 * (below + above)).floor();
        if reaches(middle) {
            above = middle;
        } else {
            below = middle;
        }
    }
    above
}
