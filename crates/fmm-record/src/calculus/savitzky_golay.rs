//! Smoothing by sliding polynomials.

use crate::calculus::even_span;
use crate::error::RecordError;

/// Highest degree: beyond it the polynomials follow noise, and their products lose the digits of a double.
const HIGHEST_DEGREE: usize = 8;

/// The value or the slope at each sample of the polynomials of `degree` that are fitted by least squares to `span`
/// samples.
pub(super) fn sliding(
    values: &[f64],
    span: usize,
    degree: usize,
    of: fn(&Polynomial) -> &[f64],
) -> Result<Vec<f64>, RecordError> {
    if span.is_multiple_of(2) {
        return Err(even_span(span));
    }
    if degree >= span || degree > HIGHEST_DEGREE {
        return Err(RecordError::options(format!(
            "the degree of a smoothing polynomial must be below its span and at most 8, but is {degree} for {span} \
             samples"
        )));
    }
    if values.len() < span {
        let operation = "a Savitzky-Golay filter of this span";
        return Err(RecordError::TooShort { operation, needed: span, length: values.len() });
    }
    let half = span / 2;
    let basis = orthonormal_polynomials(span, degree);
    // At position i of the window: Σ_j kernel(i)_j x_j with kernel(i)_j = Σ_k (value or slope of p_k at i) p_k(j).
    let kernel = |i: usize| -> Vec<f64> {
        let weight = |j: usize| basis.iter().map(|p| of(p)[i] * p.value[j]).sum();
        (0..span).map(weight).collect()
    };
    let apply = |kernel: &[f64], window: &[f64]| -> f64 {
        // Deviations from the middle keep their digits beside a large offset.
        let origin = window[half];
        let sum: f64 = kernel.iter().sum();
        sum * origin + kernel.iter().zip(window).map(|(k, x)| k * (x - origin)).sum::<f64>()
    };
    let (first, last) = (&values[..span], &values[values.len() - span..]);
    let centre = kernel(half);
    let mut smooth: Vec<f64> = (0..half).map(|i| apply(&kernel(i), first)).collect();
    smooth.extend(values.windows(span).map(|window| apply(&centre, window)));
    smooth.extend((half + 1..span).map(|i| apply(&kernel(i), last)));
    Ok(smooth)
}

/// A polynomial and its derivative on the points of a window.
#[derive(Debug, Clone)]
pub(super) struct Polynomial {
    pub(super) value: Vec<f64>,
    /// Per sample.
    pub(super) slope: Vec<f64>,
}

impl Polynomial {
    /// Adds `share` of another one.
    fn add(&mut self, share: f64, other: &Self) {
        self.value.iter_mut().zip(&other.value).for_each(|(a, b)| *a += share * b);
        self.slope.iter_mut().zip(&other.slope).for_each(|(a, b)| *a += share * b);
    }
}

/// Polynomials of degree 0 to `degree` on the points −h … h, orthonormal over them (Gram).
fn orthonormal_polynomials(span: usize, degree: usize) -> Vec<Polynomial> {
    let half = (span / 2) as f64;
    let constant = (span as f64).sqrt().recip();
    let mut basis = vec![Polynomial { value: vec![constant; span], slope: vec![0.0; span] }];
    for k in 1..=degree {
        let last = &basis[k - 1];
        let point = |i: usize| i as f64 - half;
        let value: Vec<f64> = last.value.iter().enumerate().map(|(i, p)| point(i) * p).collect();
        let slope = last.slope.iter().zip(&last.value).enumerate().map(|(i, (d, p))| point(i) * d + p).collect();
        let mut next = Polynomial { value, slope };
        // Twice is enough to leave nothing of the lower degrees but rounding.
        for _ in 0..2 {
            for lower in &basis {
                let share: f64 = next.value.iter().zip(&lower.value).map(|(a, b)| a * b).sum();
                next.add(-share, lower);
            }
        }
        let norm = next.value.iter().map(|a| a * a).sum::<f64>().sqrt();
        let mut unit = Polynomial { value: vec![0.0; span], slope: vec![0.0; span] };
        unit.add(norm.recip(), &next);
        basis.push(unit);
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::says;

    fn savitzky_golay(values: &[f64], span: usize, degree: usize) -> Result<Vec<f64>, RecordError> {
        sliding(values, span, degree, |p| &p.value)
    }

    /// Coefficients of the 1964 paper: (−3, 12, 17, 12, −3)/35 for 5 points and a quadratic or cubic.
    #[test]
    fn impulse_gives_the_published_coefficients() {
        let mut impulse = vec![0.0; 21];
        impulse[10] = 35.0;
        for degree in [2, 3] {
            let smooth = savitzky_golay(&impulse, 5, degree).unwrap();
            for (offset, expected) in [(0, 17.0), (1, 12.0), (2, -3.0), (3, 0.0)] {
                assert!((smooth[10 + offset] - expected).abs() < 1e-12, "{degree}: {}", smooth[10 + offset]);
                assert!((smooth[10 - offset] - expected).abs() < 1e-12, "{degree}: {}", smooth[10 - offset]);
            }
        }
    }

    /// Values of SciPy 1.17: `savgol_filter([1, 4, 2, 8, 5, 7, 1], 5, 2)` in its default mode.
    #[test]
    fn ends_are_those_of_the_last_full_window() {
        let smooth = savitzky_golay(&[1.0, 4.0, 2.0, 8.0, 5.0, 7.0, 1.0], 5, 2).unwrap();
        let thirty_fifths = [36.0, 108.0, 160.0, 187.0, 256.0, 198.0, 45.0];
        for (got, expected) in smooth.iter().zip(thirty_fifths) {
            assert!((35.0 * got - expected).abs() < 1e-12, "{smooth:?}");
        }
    }

    /// Derivative coefficients of the 1964 paper: (−2, −1, 0, 1, 2)/10 for 5 points and a quadratic.
    #[test]
    fn derivative_has_the_published_coefficients() {
        let mut impulse = vec![0.0; 21];
        impulse[10] = 10.0;
        let slope = sliding(&impulse, 5, 2, |p| &p.slope).unwrap();
        for (offset, expected) in [(0, 0.0), (1, -1.0), (2, -2.0), (3, 0.0)] {
            assert!((slope[10 + offset] - expected).abs() < 1e-12, "{}", slope[10 + offset]);
            assert!((slope[10 - offset] + expected).abs() < 1e-12, "{}", slope[10 - offset]);
        }
    }

    #[test]
    fn impossible_windows_are_refused() {
        let values = [0.0; 10];
        assert!(says(&savitzky_golay(&values, 4, 2), "must be odd, but is 4; use 3 or 5"));
        assert!(says(&savitzky_golay(&values, 5, 5), "at most 8, but is 5 for 5 samples"));
        assert!(says(&savitzky_golay(&values, 99, 9), "at most 8, but is 9 for 99 samples"));
        assert!(matches!(savitzky_golay(&values, 11, 3), Err(RecordError::TooShort { needed: 11, length: 10, .. })));
    }
}
