//! Statistics of samples: order statistics, mean, and a sum that carries its rounding error.

pub(crate) mod least_squares;
pub(crate) mod line_search;
pub(crate) mod spectrum;

/// Median of `values`, which it reorders; the lower one of two; 0 if there are none.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// The value below which a fraction of `values` lies, which it reorders; 0 if there are none.
pub(crate) fn quantile(values: &mut [f64], fraction: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    let index = (fraction * last as f64).floor() as usize;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

/// Smallest and largest of `values`; (0, 0) if there are none.
pub(crate) fn range(values: &[f64]) -> (f64, f64) {
    let first = values.first().copied().unwrap_or(0.0);
    values.iter().fold((first, first), |(low, high), value| (low.min(*value), high.max(*value)))
}

/// Arithmetic mean of `values`, 0 if there are none. Deviations from the first value are summed, so that a large
/// offset costs no digits.
pub(crate) fn mean(values: &[f64]) -> f64 {
    let first = values.first().copied().unwrap_or(0.0);
    first + values.iter().map(|value| value - first).sum::<f64>() / values.len().max(1) as f64
}

/// A sum that carries its rounding error (Neumaier).
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sum {
    sum: f64,
    error: f64,
}

impl Sum {
    pub(crate) fn add(&mut self, value: f64) {
        let sum = self.sum + value;
        let lost = if self.sum.abs() >= value.abs() { (self.sum - sum) + value } else { (value - sum) + self.sum };
        self.error += lost;
        self.sum = sum;
    }

    pub(crate) fn value(self) -> f64 {
        self.sum + self.error
    }
}
