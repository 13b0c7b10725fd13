//! A low-pass filter as instruments have it.

use std::f64::consts::{PI, SQRT_2};

/// `values`, sampled `rate` times a second, behind a causal Butterworth filter of second order with its corner at
/// `corner` (Hz), by the bilinear transform with the corner where it should be. The filter has been at rest before.
pub(crate) fn low_passed(values: &[f64], rate: f64, corner: f64) -> Vec<f64> {
    let w = (PI * corner / rate).tan();
    let norm = 1.0 / (1.0 + SQRT_2 * w + w * w);
    let (b, a1, a2) = (w * w * norm, 2.0 * (w * w - 1.0) * norm, (1.0 - SQRT_2 * w + w * w) * norm);
    let (mut x1, mut x2, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0);
    let step = |&x: &f64| {
        let y = b * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
        (x2, x1, y2, y1) = (x1, x, y1, y);
        y
    };
    values.iter().map(step).collect()
}

/// `values`, `count` samples late; before that, zero.
pub(crate) fn delayed(values: &[f64], count: usize) -> Vec<f64> {
    std::iter::repeat_n(0.0, count).chain(values.iter().copied()).take(values.len()).collect()
}
