//! Standard normal variate.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

pub(super) fn standard_normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}
