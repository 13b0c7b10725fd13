//! Smoothing of a record: moving averages with the end rules of MATLAB, and the choice of a filter.

pub(crate) mod integral;
pub(crate) mod savitzky_golay;

use crate::calculus::integral::central_differences;
use crate::calculus::savitzky_golay::sliding;
use crate::error::RecordError;
use crate::numerics::Sum;

/// Rule of a moving average where its window reaches beyond the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndRule {
    /// The window shrinks on both sides, to 1, 3, 5, … samples, and stays centred: MATLAB's `smooth`. It shifts
    /// nothing, but the first and the last sample stay as they are.
    Shrinking,
    /// The window is cut off at the end, and so is one-sided there: MATLAB's `movmean`. It averages over more
    /// samples, but shifts a slope.
    Truncated,
}

impl EndRule {
    /// First and last sample of the window around sample `i` of `length`.
    fn window(self, i: usize, half: usize, length: usize) -> (usize, usize) {
        match self {
            Self::Shrinking => {
                let half = half.min(i).min(length - 1 - i);
                (i - half, i + half)
            }
            Self::Truncated => (i.saturating_sub(half), (i + half).min(length - 1)),
        }
    }
}

/// A window without a centre.
pub(crate) fn even_span(span: usize) -> RecordError {
    let (below, above) = (span.saturating_sub(1).max(1), span + 1);
    RecordError::options(format!("the span of a moving average must be odd, but is {span}; use {below} or {above}"))
}

/// Moving average over `half` samples to either side.
///
/// The time taken does not depend on the span. Sums are made afresh after at most 4096 samples (or a span, if that
/// is longer) and carry their rounding error along, so that nothing drifts in long records.
pub(crate) fn averaged(values: &[f64], half: usize, ends: EndRule) -> Vec<f64> {
    if half == 0 {
        return values.to_vec();
    }
    let refresh = half.saturating_mul(2).saturating_add(1).max(4096);
    let mut sum = Sum::default();
    let (mut first, mut end) = (0, 0);
    (0..values.len())
        .map(|i| {
            let (low, high) = ends.window(i, half, values.len());
            if i % refresh == 0 {
                sum = Sum::default();
                (first, end) = (low, low);
            }
            while end <= high {
                sum.add(values[end]);
                end += 1;
            }
            while first < low {
                sum.add(-values[first]);
                first += 1;
            }
            sum.value() / (high - low + 1) as f64
        })
        .collect()
}

/// Smoothing of a record, if any.
///
/// ```
/// use fmm_record::{EndRule, Smoothing};
///
/// let values = [3.0, 6.0, 0.0, 9.0, 3.0, 6.0];
/// let average = |ends| Smoothing::MovingAverage { span: 5, ends }.apply(&values);
/// assert_eq!(average(EndRule::Shrinking)?, [3.0, 3.0, 4.2, 4.8, 6.0, 6.0]);
/// assert_eq!(average(EndRule::Truncated)?, [3.0, 4.5, 4.2, 4.8, 4.5, 6.0]);
///
/// let cubic: Vec<f64> = (0..50).map(|i| f64::from(i).powi(3) - 20.0 * f64::from(i).powi(2)).collect();
/// let polynomial = Smoothing::SavitzkyGolay { span: 21, degree: 3 };
/// assert!(cubic.iter().zip(polynomial.apply(&cubic)?).all(|(x, y)| (x - y).abs() < 1e-9));
/// let parabola: Vec<f64> = (0..50).map(|i| f64::from(i).powi(2)).collect();
/// let slope = polynomial.slope(&parabola)?;
/// assert!(slope.iter().enumerate().all(|(i, slope)| (slope - 2.0 * i as f64).abs() < 1e-10));
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
///
/// # References
/// A. Savitzky, M. J. E. Golay, "Smoothing and differentiation of data by simplified least squares procedures",
/// Anal. Chem. 36 (1964) 1627, <https://doi.org/10.1021/ac60214a047>; P. A. Gorry, Anal. Chem. 62 (1990) 570,
/// <https://doi.org/10.1021/ac00205a007> (the ends).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Smoothing {
    /// No smoothing.
    #[default]
    None,
    /// Moving average, centred.
    ///
    /// ```text
    /// y_i = (x_{i−h} + … + x_{i+h})/(2h + 1),        h = (span − 1)/2
    /// ```
    MovingAverage {
        /// Samples averaged; odd, since an even window has no centre. (MATLAB's `smooth` takes the odd number below,
        /// `movmean` a window that is shifted by half a sample.)
        span: usize,
        /// Rule at the ends.
        ends: EndRule,
    },
    /// Savitzky and Golay's filter: each sample becomes the value of a polynomial, fitted by least squares to the
    /// samples around it. A polynomial up to the degree passes unchanged, so peaks lose less than under a moving
    /// average of the same span.
    ///
    /// At the ends, where the window would reach beyond the record, the polynomial of the first (last) full window is
    /// evaluated, as MATLAB's `sgolayfilt` and SciPy's `savgol_filter` do.
    SavitzkyGolay {
        /// Samples that a polynomial is fitted to; odd.
        span: usize,
        /// Degree of the polynomial: below the span, and at most 8.
        degree: usize,
    },
}

impl Smoothing {
    /// The smoothed `values`.
    ///
    /// # Errors
    /// [`RecordError::Options`] for an even span, 0 included, and for a degree that is too high;
    /// [`RecordError::TooShort`] for fewer values than the span of a polynomial.
    pub fn apply(&self, values: &[f64]) -> Result<Vec<f64>, RecordError> {
        match *self {
            Self::None => Ok(values.to_vec()),
            Self::MovingAverage { span, .. } if span.is_multiple_of(2) => Err(even_span(span)),
            Self::MovingAverage { span, ends } => Ok(averaged(values, span / 2, ends)),
            Self::SavitzkyGolay { span, degree } => sliding(values, span, degree, |p| &p.value),
        }
    }

    /// The derivative of the smoothed `values` per sample; divide by the sampling interval. Averages are differentiated
    /// by central differences, polynomials as such, which is less noisy.
    ///
    /// # Errors
    /// Those of [`Smoothing::apply`], and [`RecordError::TooShort`] below three values.
    pub fn slope(&self, values: &[f64]) -> Result<Vec<f64>, RecordError> {
        match *self {
            Self::SavitzkyGolay { span, degree } => sliding(values, span, degree, |p| &p.slope),
            _ => central_differences(&self.apply(values)?),
        }
    }

    /// Standard deviation of the [`slope`](Self::slope) of white noise of standard deviation 1.
    ///
    /// # Errors
    /// Those of [`Smoothing::apply`].
    pub fn slope_noise_gain(&self) -> Result<f64, RecordError> {
        let span = match *self {
            Self::None => 1,
            Self::MovingAverage { span, .. } | Self::SavitzkyGolay { span, .. } => span,
        };
        // A unit impulse, so far from both ends that nothing one-sided there sees it.
        let reach = span + 3;
        let mut impulse = vec![0.0; 2 * reach + 1];
        impulse[reach] = 1.0;
        Ok(self.slope(&impulse)?.iter().map(|slope| slope * slope).sum::<f64>().sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::mean;
    use crate::record::Record;
    use crate::tests::synthetic::Noise;

    fn moving_average(values: &[f64], span: usize, ends: EndRule) -> Result<Vec<f64>, RecordError> {
        Smoothing::MovingAverage { span, ends }.apply(values)
    }

    /// Both rules, written as their definitions, agree with the running sum to rounding.
    #[test]
    fn running_sum_is_the_definition() {
        let mut random = Noise::new(3);
        let values: Vec<f64> = (0..10_000).map(|_| 1e3 + random.normal()).collect();
        for length in [1, 2, 3, 7, 10_000] {
            let values = &values[..length];
            for span in [1, 3, 5, 15, 4095, 20_001] {
                for ends in [EndRule::Shrinking, EndRule::Truncated] {
                    let fast = moving_average(values, span, ends).unwrap();
                    for i in (0..length).step_by(length / 50 + 1) {
                        let (low, high) = ends.window(i, span / 2, length);
                        let slow = mean(&values[low..=high]);
                        // Values near 1e3 carry 1e-13; a handful of roundings remain.
                        assert!((fast[i] - slow).abs() < 1e-12, "{ends:?} {span} at {i}: {} {slow}", fast[i]);
                    }
                }
            }
        }
    }

    #[test]
    fn ends_follow_matlab() {
        let values: Vec<f64> = (0..8).map(|i| f64::from(i * i)).collect();
        let smooth = moving_average(&values, 5, EndRule::Shrinking).unwrap();
        assert_eq!(smooth[..3], [0.0, (0.0 + 1.0 + 4.0) / 3.0, (0.0 + 1.0 + 4.0 + 9.0 + 16.0) / 5.0]);
        assert_eq!(smooth[6..], [(25.0 + 36.0 + 49.0) / 3.0, 49.0]);
        let movmean = moving_average(&values, 5, EndRule::Truncated).unwrap();
        assert_eq!(movmean[..2], [5.0 / 3.0, 14.0 / 4.0]);
        assert_eq!(movmean[7], (25.0 + 36.0 + 49.0) / 3.0);
    }

    #[test]
    fn a_giant_among_small_numbers_leaves_no_trace() {
        let mut values = vec![0.1; 3_000];
        values[1_000] = 1e15;
        let average = moving_average(&values, 5, EndRule::Truncated).unwrap();
        assert!((average[1_500] - 0.1).abs() < 1e-15, "{}", average[1_500]);
    }

    #[test]
    fn even_spans_are_refused() {
        let error = moving_average(&[1.0], 4, EndRule::Shrinking).unwrap_err();
        assert_eq!(error.to_string(), "the span of a moving average must be odd, but is 4; use 3 or 5");
        assert!(moving_average(&[1.0], 0, EndRule::Truncated).is_err());
        assert!(moving_average(&[], 3, EndRule::Truncated).unwrap().is_empty());
    }

    #[test]
    fn gains_are_those_of_the_weights() {
        let mean = Smoothing::MovingAverage { span: 5, ends: EndRule::Truncated };
        // A difference of two averages over five keeps two samples at either end: 4 · (0.2/2)².
        assert!((mean.slope_noise_gain().unwrap().powi(2) - 0.04).abs() < 1e-15);
        assert!((Smoothing::None.slope_noise_gain().unwrap().powi(2) - 0.5).abs() < 1e-15);
        let polynomial = Smoothing::SavitzkyGolay { span: 5, degree: 2 };
        // Weights of −2, −1, 0, 1 and 2 tenths: (4 + 1 + 1 + 4)/100.
        assert!((polynomial.slope_noise_gain().unwrap().powi(2) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn slopes_make_a_record_of_the_derivative() {
        let values = (0..30).map(|i| 0.5 * f64::from(i)).collect();
        let record = Record::new(1.0, 0.5, values, crate::units::Quantity::Velocity, "m/s").unwrap();
        for smoothing in [Smoothing::None, Smoothing::SavitzkyGolay { span: 7, degree: 3 }] {
            let slope = record.differentiate_smoothed_by(&smoothing).unwrap();
            assert_eq!((slope.quantity(), slope.unit()), (crate::units::Quantity::Acceleration, "m/s²"));
            assert!(slope.values().iter().all(|slope| (slope - 1.0).abs() < 1e-12), "{slope:?}");
        }
        assert_eq!(record.differentiate_smoothed_by(&Smoothing::None).unwrap(), record.differentiate().unwrap());
        let force = record.with_quantity(crate::units::Quantity::Force);
        assert!(force.differentiate_smoothed_by(&Smoothing::None).is_err());
    }

    #[test]
    fn a_record_keeps_what_it_is() {
        let record = Record::new(1.0, 0.5, vec![3.0, 6.0, 0.0], crate::units::Quantity::Velocity, "m/s").unwrap();
        assert_eq!(record.smoothed_by(&Smoothing::None).unwrap(), record);
        let mean = Smoothing::MovingAverage { span: 3, ends: EndRule::Shrinking };
        assert_eq!(record.smoothed_by(&mean).unwrap().values(), [3.0, 3.0, 0.0]);
        assert!(record.smoothed_by(&Smoothing::SavitzkyGolay { span: 5, degree: 3 }).is_err());
    }
}
