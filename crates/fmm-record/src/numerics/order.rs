//! Order statistics.

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
