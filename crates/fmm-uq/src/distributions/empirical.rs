//! Empirical distribution of a sample.

use std::sync::Arc;

use rand::{Rng, RngExt};

/// Equal probability for each of some values, which may repeat: earlier trials of a Monte Carlo, or observations
/// taken as they are. Copies share the values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Empirical {
    sorted: Arc<[f64]>,
    mean: f64,
    standard_deviation: f64,
}

impl Empirical {
    /// The caller has seen to it that there are values and that all are finite.
    pub(crate) fn new(mut values: Vec<f64>) -> Self {
        values.sort_unstable_by(f64::total_cmp);
        let count = values.len() as f64;
        let moments = crate::Moments::of_values(&values);
        // The values are the whole distribution here and no sample of it: n, not n − 1.
        let standard_deviation = (moments.sum_of_squares() / count).sqrt();
        Self { sorted: values.into(), mean: moments.mean(), standard_deviation }
    }

    pub(crate) fn mean(&self) -> f64 {
        self.mean
    }

    pub(crate) fn standard_deviation(&self) -> f64 {
        self.standard_deviation
    }

    pub(crate) fn count(&self) -> usize {
        self.sorted.len()
    }

    /// The smallest and the largest value.
    pub(crate) fn limits(&self) -> (f64, f64) {
        (self.sorted[0], self.sorted[self.sorted.len() - 1])
    }

    pub(crate) fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.sorted[rng.random_range(0..self.sorted.len())]
    }

    /// The smallest value of which a share of at least `probability` is not larger.
    pub(crate) fn quantile(&self, probability: f64) -> f64 {
        let rank = (probability * self.sorted.len() as f64).ceil() as usize;
        self.sorted[rank.clamp(1, self.sorted.len()) - 1]
    }
}
