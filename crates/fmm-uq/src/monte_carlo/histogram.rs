//! The density of an output, as bars.

use crate::{OutputSample, UncertaintyError};

/// Bars of equal width from the smallest to the largest value.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Histogram {
    /// Left edge of the first bar (unit of the output).
    pub start: f64,
    /// Width of a bar (unit of the output).
    pub width: f64,
    /// Values in each bar.
    pub counts: Vec<u64>,
}

impl Histogram {
    /// Probability density of each bar (reciprocal of the unit of the output); the bars have the area 1 together.
    pub fn density(&self) -> Vec<f64> {
        let all: u64 = self.counts.iter().sum();
        self.counts.iter().map(|&count| count as f64 / (all as f64 * self.width)).collect()
    }

    /// Centres of the bars (unit of the output).
    pub fn centres(&self) -> Vec<f64> {
        (0..self.counts.len()).map(|bar| self.start + self.width * (bar as f64 + 0.5)).collect()
    }
}

impl OutputSample {
    /// The histogram of an output with so many bars.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless there are 1 to 1 000 000 bars and
    /// the values differ.
    pub fn histogram(&self, output: usize, bars: usize) -> Result<Histogram, UncertaintyError> {
        let refuse = |option, value, must_be| Err(UncertaintyError::out_of_range(option, value, must_be));
        if !(1..=1_000_000).contains(&bars) {
            return refuse("number of bars", bars as f64, "between 1 and 1000000");
        }
        let values = self.values(output)?;
        let range = |(low, high): (f64, f64), &value: &f64| (low.min(value), high.max(value));
        let (start, end) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), range);
        let width = (end - start) / bars as f64;
        if !(width > 0.0 && width.is_finite()) {
            return refuse("range of the values", end - start, "positive and finite");
        }
        let mut counts = vec![0; bars];
        for value in values {
            counts[(((value - start) / width) as usize).min(bars - 1)] += 1;
        }
        Ok(Histogram { start, width, counts })
    }
}
