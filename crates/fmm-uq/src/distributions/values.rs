//! Quantiles and random values of all distributions.

use fmm_model::student_quantile;
use rand::Rng;
use rand_distr::{Distribution as _, Exp1, StandardNormal};
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::gamma::gamma_ur;

use super::{Distribution, Shape};
use crate::UncertaintyError;
use crate::distributions::gamma::gamma_quantile;

impl Distribution {
    /// The value that the quantity does not exceed with the given probability.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless the probability lies between 0 and 1.
    pub fn quantile(&self, probability: f64) -> Result<f64, UncertaintyError> {
        Ok(self.quantile_at(UncertaintyError::require_level(probability)?))
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
                mean + scale * t_quantile(probability, *degrees_of_freedom)
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
                many(values, stride, rng, |[u]| (lower + (upper - lower) * u, true));
            }
            Shape::CurvilinearTrapezoid(shape) => many(values, stride, rng, |u| (shape.of(u), true)),
            Shape::Trapezoid(shape) => many(values, stride, rng, |u| (shape.of(u), true)),
            Shape::ArcSine(shape) => many(values, stride, rng, |u| shape.of(u)),
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
            Shape::Triangle(shape) => many(values, stride, rng, |[u]| (shape.quantile(u), true)),
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

/// Numbers that are drawn together by [`many`].
const TOGETHER: usize = 25;

/// Draws every `stride`th element by a rule that makes a value of N uniform numbers, or refuses them and takes others.
///
/// Numbers are drawn many at a time, and never more than are needed: they are those that one draw after the other has.
fn many<const N: usize, R: Rng + ?Sized>(
    values: &mut [f64],
    stride: usize,
    rng: &mut R,
    rule: impl Fn([f64; N]) -> (f64, bool),
) {
    let count = values.len().div_ceil(stride);
    let mut words = [[[0; 8]; N]; TOGETHER];
    let mut done = 0;
    while done < count {
        let words = &mut words[..TOGETHER.min(count - done)];
        rng.fill_bytes(words.as_flattened_mut().as_flattened_mut());
        for &word in words.iter() {
            // Written always and counted if accepted, since a branch could not be guessed.
            let (value, accepted) = rule(word.map(uniform));
            values[done * stride] = value;
            done += usize::from(accepted);
        }
    }
}

/// A number in [0, 1) from the 53 highest bits of a word.
#[inline]
fn uniform(word: [u8; 8]) -> f64 {
    (u64::from_le_bytes(word) >> 11) as f64 * (0.5 * f64::EPSILON)
}

/// The quantile of Student's t for a probability in (0, 1).
fn t_quantile(probability: f64, degrees_of_freedom: f64) -> f64 {
    if probability == 0.5 {
        0.0
    } else if probability < 0.5 {
        -student_quantile(probability, degrees_of_freedom)
    } else {
        student_quantile(1.0 - probability, degrees_of_freedom)
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

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::random::stream::Stream;

    /// Values of a sampler that takes a number at a time, and numbers left in the stream as it leaves them.
    #[test]
    fn values_drawn_together_are_those_drawn_one_by_one() {
        for distribution in [
            Distribution::rectangular(-1.0, 3.0),
            Distribution::curvilinear_trapezoid(-1.0, 1.0, 0.1),
            Distribution::trapezoid(0.0, 2.0, 0.3),
            Distribution::arc_sine(-0.5, 0.5),
            Distribution::asymmetric_triangle(0.0, 0.2, 1.0),
        ] {
            let distribution = distribution.unwrap();
            let (mut together, mut single) = (Stream::new(5, 1), Stream::new(5, 1));
            let mut values = [f64::NAN; 3 * 211];
            distribution.fill(&mut together, &mut values, 3);
            for (i, value) in values.iter().enumerate() {
                if i % 3 == 0 {
                    assert_eq!(*value, distribution.sample(&mut single), "{distribution}, {i}");
                } else {
                    assert!(value.is_nan());
                }
            }
            assert_eq!(together.next_u64(), single.next_u64(), "{distribution}");
        }
    }

    #[test]
    fn uniform_numbers_are_those_of_rand() {
        let (mut stream, mut plain) = (Stream::new(5, 1), Stream::new(5, 1));
        let unit = Distribution::rectangular(0.0, 1.0).unwrap();
        for _ in 0..100 {
            assert_eq!(unit.sample(&mut stream), plain.random::<f64>());
        }
    }
}
