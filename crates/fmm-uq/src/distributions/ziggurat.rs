//! Normal and t-distributed values, many at a time.

use std::sync::{Arc, LazyLock};

use fmm_model::student_quantile;
use rand::{Rng, RngExt};
use statrs::distribution::{Continuous, ContinuousCDF, Normal, StudentsT};

/// Layers, all of the same area.
const LAYERS: usize = 256;
/// Values that are drawn together.
const TOGETHER: usize = 100;
/// Degrees of freedom above which the tail of Student's t is not known exactly enough for a ziggurat (1).
const MOST_DEGREES_OF_FREEDOM: f64 = 1000.0;
/// Steps of the search for the edge of the lowest layer; it needs some fifteen.
const STEPS: usize = 100;

static NORMAL: LazyLock<Arc<Ziggurat>> = LazyLock::new(|| Arc::new(Ziggurat::new(f64::INFINITY)));

/// Student's t of ν degrees of freedom, the normal distribution for ν = ∞, sampled by Marsaglia's ziggurat: the area
/// below the density is cut into layers of equal area, of which one is chosen at random, and a point in it.
///
/// ```text
/// f(x) = (1 + x²/ν)^(−(ν + 1)/2),   x_i (f(x_{i+1}) − f(x_i)) = x₁ f(x₁) + ∫_{x₁}^∞ f dx
/// ```
///
/// All but one in a hundred points lie where the layer is wholly below the density, and such a point costs one random
/// number, a multiplication and a comparison. Of the others some need the density; those beyond x₁ are quantiles.
///
/// # Why not a library
/// rand_distr takes as long for a normal value (4 ns) and 4.2 times as long for one of Student's t (21 ns against 5),
/// which most inputs of a budget have; its values may change from one version to the next, which those here must
/// not. `benches/peers` of the workspace measures it.
///
/// # References
/// G. Marsaglia, W. W. Tsang, J. Stat. Softw. 5 (2000) 8, doi:10.18637/jss.v005.i08; J. A. Doornik, "An improved
/// ziggurat method to generate normal random samples" (2005).
#[derive(Debug)]
pub(crate) struct Ziggurat {
    /// ν.
    degrees_of_freedom: f64,
    /// x_i from the lowest layer to the top; x₀ is the width of a rectangle of the lowest layer's area and
    /// height.
    edges: [f64; LAYERS + 1],
    /// f(x_i).
    heights: [f64; LAYERS + 1],
    /// Probability of a value beyond x₁.
    tail: f64,
}

impl Ziggurat {
    /// The standard normal distribution.
    pub(crate) fn normal() -> Arc<Self> {
        Arc::clone(&NORMAL)
    }

    /// Student's t of ν ≤ 1000.
    pub(crate) fn student_t(degrees_of_freedom: f64) -> Option<Arc<Self>> {
        (degrees_of_freedom <= MOST_DEGREES_OF_FREEDOM).then(|| Arc::new(Self::new(degrees_of_freedom)))
    }

    fn new(nu: f64) -> Self {
        let curve = Curve::new(nu);
        // The edge of the lowest layer by false position between logarithms, with Illinois' halving.
        let (mut near, mut far) = (0.0_f64, 14.0_f64);
        let (mut excess_near, mut excess_far) = (curve.excess(near.exp()), curve.excess(far.exp()));
        for _ in 0..STEPS {
            let next = (near * excess_far - far * excess_near) / (excess_far - excess_near);
            let excess = curve.excess(next.exp());
            if (excess > 0.0) == (excess_far > 0.0) {
                excess_near *= 0.5;
            } else {
                (near, excess_near) = (far, excess_far);
            }
            let step = next - far;
            (far, excess_far) = (next, excess);
            if excess == 0.0 || step.abs() < 1e-15 {
                break;
            }
        }
        let mut ziggurat =
            Self { degrees_of_freedom: nu, edges: [0.0; LAYERS + 1], heights: [1.0; LAYERS + 1], tail: 0.0 };
        let edge = far.exp();
        let area = curve.area(edge);
        ziggurat.tail = curve.tail(edge);
        ziggurat.edges[0] = area / curve.density(edge);
        ziggurat.edges[1] = edge;
        for i in 1..LAYERS {
            ziggurat.heights[i] = curve.density(ziggurat.edges[i]);
            if i + 1 < LAYERS {
                ziggurat.edges[i + 1] = curve.edge(ziggurat.heights[i] + area / ziggurat.edges[i]);
            }
        }
        ziggurat
    }

    /// Sets every `stride`th element to `centre` + `scale` z, the first included.
    ///
    /// The order of draws belongs to the results: one random number for each of 100 values, then those that the
    /// rejected ones need.
    pub(crate) fn fill<R: Rng + ?Sized>(
        &self,
        rng: &mut R,
        (centre, scale): (f64, f64),
        values: &mut [f64],
        stride: usize,
    ) {
        let mut bytes = [0; 8 * TOGETHER];
        for values in values.chunks_mut(stride * TOGETHER) {
            let count = values.len().div_ceil(stride);
            let bytes = &mut bytes[..8 * count];
            rng.fill_bytes(bytes);
            for (value, word) in values.iter_mut().step_by(stride).zip(bytes.as_chunks().0) {
                let word = u64::from_le_bytes(*word);
                let z = self.inside(word).unwrap_or_else(|| self.finish(rng, word));
                *value = centre + scale * z;
            }
        }
    }

    /// The value that a random number stands for, if its point lies below the density for certain.
    #[inline]
    fn inside(&self, word: u64) -> Option<f64> {
        let (layer, place) = split(word);
        let x = place * self.edges[layer];
        (x.abs() < self.edges[layer + 1]).then_some(x)
    }

    /// Slow path: the value, for which further random numbers are drawn.
    #[cold]
    fn finish<R: Rng + ?Sized>(&self, rng: &mut R, mut word: u64) -> f64 {
        loop {
            if let Some(x) = self.inside(word) {
                return x;
            }
            let (layer, place) = split(word);
            let uniform: f64 = rng.random();
            if layer == 0 {
                // 1 − u is never zero, which has no quantile.
                return student_quantile(self.tail * (1.0 - uniform), self.degrees_of_freedom).copysign(place);
            }
            let x = place * self.edges[layer];
            let (bottom, top) = (self.heights[layer], self.heights[layer + 1]);
            if top + (bottom - top) * uniform < density(x, self.degrees_of_freedom) {
                return x;
            }
            word = rng.next_u64();
        }
    }
}

/// A layer from the lowest bits, and a place in [−1, 1) from the highest.
#[inline]
fn split(word: u64) -> (usize, f64) {
    // The bits of a number in [2, 4).
    const TWO: u64 = 2f64.to_bits();
    ((word & (LAYERS as u64 - 1)) as usize, f64::from_bits((word >> 12) | TWO) - 3.0)
}

/// f(x).
fn density(x: f64, nu: f64) -> f64 {
    if nu.is_infinite() { (-0.5 * x * x).exp() } else { (-0.5 * (nu + 1.0) * (x * x / nu).ln_1p()).exp() }
}

/// Curve under which the layers lie.
struct Curve {
    nu: f64,
    /// `None` for the normal distribution.
    student: Option<StudentsT>,
}

impl Curve {
    fn new(nu: f64) -> Self {
        Self { nu, student: if nu.is_infinite() { None } else { StudentsT::new(0.0, 1.0, nu).ok() } }
    }

    fn density(&self, x: f64) -> f64 {
        density(x, self.nu)
    }

    /// The x of a density.
    fn edge(&self, height: f64) -> f64 {
        let ln = height.ln();
        match self.student {
            Some(_) => (self.nu * (-2.0 / (self.nu + 1.0) * ln).exp_m1()).sqrt(),
            None => (-2.0 * ln).sqrt(),
        }
    }

    /// The probability beyond x.
    fn tail(&self, x: f64) -> f64 {
        self.student.as_ref().map_or_else(|| Normal::standard().sf(x), |student| student.sf(x))
    }

    /// The area of the lowest layer, if it ends at x.
    fn area(&self, x: f64) -> f64 {
        let peak = self.student.as_ref().map_or_else(|| Normal::standard().pdf(0.0), |student| student.pdf(0.0));
        x * self.density(x) + self.tail(x) / peak
    }

    /// Height by which the layers reach above the peak of the density, if the lowest ends at x; the number of layers that
    /// are too many, if there are.
    fn excess(&self, x: f64) -> f64 {
        let area = self.area(x);
        let (mut edge, mut height) = (x, self.density(x));
        for layer in 1..LAYERS {
            height += area / edge;
            if layer + 1 < LAYERS {
                if height >= 1.0 {
                    return (LAYERS - layer) as f64;
                }
                edge = self.edge(height);
            }
        }
        height - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Stream;

    #[test]
    fn layers_of_the_normal_distribution_are_those_of_the_literature() {
        // Doornik's table for 256 layers ends at 3.6541528853610088; areas here agree to 1e-11.
        let normal = Ziggurat::normal();
        assert!((normal.edges[1] - 3.654_152_885_361_009).abs() < 1e-11, "{}", normal.edges[1]);
    }

    #[test]
    fn layers_have_equal_areas_and_end_at_the_peak() {
        for nu in [1.0, 1.5, 2.0, 5.0, 50.0, 1000.0, f64::INFINITY] {
            let ziggurat = Ziggurat::new(nu);
            let area = ziggurat.edges[0] * ziggurat.heights[1];
            for i in 1..LAYERS {
                let layer = ziggurat.edges[i] * (ziggurat.heights[i + 1] - ziggurat.heights[i]);
                // Heights near 1 differ by little; what that loses is a share of 1e-12 of one in 256 values.
                assert!((layer / area - 1.0).abs() < 1e-11, "ν {nu}, layer {i}: {}", layer / area - 1.0);
            }
        }
    }

    /// Values by their probabilities in 64 bins, five bins of them in the tails beyond the lowest layer.
    #[test]
    fn values_have_their_distribution() {
        const COUNT: usize = 2_000_000;
        for nu in [1.0, 3.0, 18.0, f64::INFINITY] {
            let ziggurat = Ziggurat::new(nu);
            let cdf = |x: f64| match StudentsT::new(0.0, 1.0, nu) {
                Ok(student) if nu.is_finite() => student.cdf(x),
                _ => Normal::standard().cdf(x),
            };
            let mut values = vec![0.0; COUNT];
            ziggurat.fill(&mut Stream::new(11, 0), (0.0, 1.0), &mut values, 1);
            let (bins, tail) = (64.0, ziggurat.tail);
            let mut counts = [0_usize; 64];
            let mut beyond = [0_usize; 4];
            for &x in &values {
                let p = cdf(x);
                counts[((p * bins) as usize).min(63)] += 1;
                // Each tail in two halves of equal probability.
                let rank = p.min(1.0 - p) / tail;
                if rank < 1.0 {
                    beyond[2 * usize::from(x > 0.0) + usize::from(rank > 0.5)] += 1;
                }
            }
            let chi = |counts: &[usize], expected: f64| {
                counts.iter().map(|&n| (n as f64 - expected).powi(2) / expected).sum::<f64>()
            };
            // 63 degrees of freedom: mean 63, standard deviation 11.2, five of them.
            let square = chi(&counts, COUNT as f64 / bins);
            assert!(square < 63.0 + 5.0 * 11.2, "ν {nu}: χ² {square}");
            // 4 degrees of freedom; 5e-7 of all seeds exceed 36.
            let square = chi(&beyond, 0.5 * tail * COUNT as f64);
            assert!(square < 36.0, "ν {nu}: {beyond:?}, χ² {square}");
        }
    }

    #[test]
    fn strides_and_odd_numbers_are_filled() {
        let mut values = [f64::NAN; 3 * 65];
        Ziggurat::normal().fill(&mut Stream::new(1, 2), (5.0, 0.0), &mut values, 3);
        assert!(values.iter().enumerate().all(|(i, x)| if i % 3 == 0 { *x == 5.0 } else { x.is_nan() }));
    }
}
