//! Coherence: the share of a response that comes from the force.

use std::sync::Arc;

/// γ² at each line, with the number of averages without which it means nothing.
///
/// Of n averages with no connection between the channels, γ² is 1/n in the mean; of one, it is 1 whatever was measured.
/// Low coherence has many causes: noise, leakage, a second input, or a machine that is not linear, such as one with
/// friction hit with different impulses.
#[derive(Debug, Clone, PartialEq)]
pub struct Coherence {
    frequencies: Arc<[f64]>,
    values: Vec<f64>,
    averages: f64,
}

impl Coherence {
    pub(crate) fn new(frequencies: Arc<[f64]>, values: Vec<f64>, averages: f64) -> Self {
        Self { frequencies, values, averages }
    }

    /// Frequencies (Hz), increasing.
    pub fn frequencies(&self) -> &[f64] {
        &self.frequencies
    }

    /// γ², one for each frequency, from 0 to 1.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Number of trials of equal weight that the average is worth.
    pub fn averages(&self) -> f64 {
        self.averages
    }

    /// Whether there are two averages at least, as without them γ² is 1 by construction.
    pub fn is_meaningful(&self) -> bool {
        self.averages > 1.0
    }

    /// The median of γ² over the lines from `low` to `high` (Hz), both ends included; `None` if no line lies there.
    pub fn median(&self, low: f64, high: f64) -> Option<f64> {
        let lines = self.frequencies.iter().zip(&self.values);
        let inside = lines.filter(|(frequency, _)| (low..=high).contains(*frequency));
        let mut values: Vec<f64> = inside.map(|(_, value)| *value).collect();
        values.sort_by(f64::total_cmp);
        let (below, above) = (values.get(values.len().checked_sub(1)? / 2)?, values.get(values.len() / 2)?);
        Some(0.5 * (below + above))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_of_a_band() {
        let coherence = Coherence::new(vec![0.0, 1.0, 2.0, 3.0].into(), vec![0.1, 0.9, 0.5, 0.7], 3.0);
        assert_eq!(coherence.median(1.0, 3.0), Some(0.7));
        assert_eq!(coherence.median(0.0, 1.0), Some(0.5));
        assert_eq!(coherence.median(4.0, 5.0), None);
        assert!(coherence.is_meaningful() && !Coherence::new(vec![].into(), vec![], 1.0).is_meaningful());
    }
}
