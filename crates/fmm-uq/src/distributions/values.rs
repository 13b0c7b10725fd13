//! Quantiles and random values of all distributions.

use std::f64::consts::PI;

use fmm_model::student_quantile;
use rand::{Rng, RngExt};
use rand_distr::{Distribution as _, Exp1, StandardNormal};
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::beta::beta_reg;

use crate::distributions::{Distribution, Shape, quantiles};
use crate::error::UncertaintyError;

impl Distribution {
    /// The value that the quantity does not exceed with the given probability.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless the probability lies between 0 and 1.
    pub fn quantile(&self, probability: f64) -> Result<f64, UncertaintyError> {
        Ok(self.quantile_at(UncertaintyError::require_level(probability)?))
    }

    /// The quantile of a probability in (0, 1).
    pub(crate) fn quantile_at(&self, probability: f64) -> f64 {
        let (mean, (low, high)) = (self.mean, self.limits);
        // From the centre of a symmetric distribution, by the distance of the smaller tail.
        let symmetric = |distance: f64| if probability < 0.5 { mean - distance } else { mean + distance };
        let tail = probability.min(1.0 - probability);
        match &self.shape {
            Shape::StudentT { scale, degrees_of_freedom, .. } if probability != 0.5 => {
                symmetric(scale * student_quantile(tail, *degrees_of_freedom))
            }
            // A Student distribution at its centre, or a number without one.
            Shape::Constant | Shape::StudentT { .. } => mean,
            Shape::Rectangular => low + (high - low) * probability,
            Shape::CurvilinearTrapezoid { half_width, inexactness } => {
                symmetric(quantiles::curvilinear_trapezoid(*half_width, *inexactness, tail))
            }
            Shape::Trapezoid { base, top } => {
                let (slope_width, plateau) = (base - top, base + top);
                symmetric(if tail < 0.5 * slope_width / plateau {
                    base - (2.0 * tail * slope_width * plateau).sqrt()
                } else {
                    (0.5 - tail) * plateau
                })
            }
            // The sine keeps the centre exact, where the cosine of π/2 would not be zero.
            Shape::ArcSine { amplitude } => mean + amplitude * (PI * (probability - 0.5)).sin(),
            Shape::Normal => mean + self.standard_deviation * Normal::standard().inverse_cdf(probability),
            Shape::Exponential => -mean * (-probability).ln_1p(),
            Shape::Gamma { shape, scale, .. } => scale * quantiles::gamma(*shape, probability),
            Shape::Triangle { mode } => triangle(low, *mode, high, probability),
            // From the nearer limit, where the distance keeps its digits.
            Shape::Beta { shapes: (a, b), .. } if probability <= beta_reg(*a, *b, 0.5) => {
                low + (high - low) * quantiles::beta(*a, *b, probability)
            }
            Shape::Beta { shapes: (a, b), .. } => high - (high - low) * quantiles::beta(*b, *a, 1.0 - probability),
            Shape::LogNormal { median, deviation } => {
                median * (deviation * Normal::standard().inverse_cdf(probability)).exp()
            }
            // The smallest value of which a share of at least `probability` is not larger.
            Shape::Empirical(sorted) => {
                let rank = (probability * sorted.len() as f64).ceil() as usize;
                sorted[rank.clamp(1, sorted.len()) - 1]
            }
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
        let (mean, deviation, (low, high)) = (self.mean, self.standard_deviation, self.limits);
        match &self.shape {
            Shape::Constant => each(values, stride, || mean),
            Shape::Rectangular => many(values, stride, rng, |[u]| (low + (high - low) * u, true)),
            // The half width is drawn first, then the place within it (JCGM 101:2008, 6.4.3.4).
            Shape::CurvilinearTrapezoid { half_width, inexactness } => many(values, stride, rng, |[first, second]| {
                let half_width = half_width + inexactness * (2.0 * first - 1.0);
                (mean + half_width * (2.0 * second - 1.0), true)
            }),
            Shape::Trapezoid { base, top } => many(values, stride, rng, |[first, second]| {
                (mean + (base + top) * (first - 0.5) + (base - top) * (second - 0.5), true)
            }),
            // A point of the unit disc has a random phase, and the cosine of twice that needs no cosine.
            Shape::ArcSine { amplitude } => many(values, stride, rng, |[x, y]| {
                let (xx, yy) = (x * x, y * y);
                let square = xx + yy;
                (mean + amplitude * ((xx - yy) / square), square <= 1.0 && square > 0.0)
            }),
            Shape::Normal => each(values, stride, || {
                let z: f64 = StandardNormal.sample(rng);
                mean + deviation * z
            }),
            Shape::StudentT { scale, unit, .. } => each(values, stride, || mean + scale * unit.sample(rng)),
            Shape::Exponential => each(values, stride, || {
                let e: f64 = Exp1.sample(rng);
                mean * e
            }),
            Shape::Gamma { sampler, .. } => each(values, stride, || sampler.sample(rng)),
            Shape::Triangle { mode } => many(values, stride, rng, |[u]| (triangle(low, *mode, high, u), true)),
            Shape::Beta { sampler, .. } => each(values, stride, || low + (high - low) * sampler.sample(rng)),
            Shape::LogNormal { median, deviation } => each(values, stride, || {
                let z: f64 = StandardNormal.sample(rng);
                median * (deviation * z).exp()
            }),
            Shape::Empirical(sorted) => each(values, stride, || sorted[rng.random_range(0..sorted.len())]),
        }
    }
}

/// Quantile of the triangle with its top at `mode`.
fn triangle(low: f64, mode: f64, high: f64, probability: f64) -> f64 {
    let (p, q) = (mode - low, high - mode);
    if probability * (p + q) < p {
        low + (probability * (p + q) * p).sqrt()
    } else {
        high - ((1.0 - probability) * (p + q) * q).sqrt()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Stream;

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
