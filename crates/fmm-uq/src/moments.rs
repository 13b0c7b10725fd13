//! Mean and spread of many values, to the digits that they carry.

use crate::error::UncertaintyError;

/// Values that are summed before their sums are: rounding then grows with the root of the number of blocks.
const BLOCK: usize = 1000;
/// Sums that run side by side in a block, in a fixed order.
const LANES: usize = 8;

/// Number, mean, and second and fourth central moments of a set of values.
///
/// ```text
/// m = Σ x/n,   s² = Σ (x − m)²/(n − 1)
/// ```
///
/// They are taken in two passes, the first with values shifted by the first one, so that values of which
/// only the last digits differ lose none of them.
///
/// ```
/// use fmm_uq::Moments;
///
/// let moments = Moments::of(&[10_000_001.0, 10_000_003.0, 10_000_002.0]).unwrap();
/// assert_eq!((moments.mean(), moments.standard_deviation()), (10_000_002.0, Some(1.0)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    count: usize,
    mean: f64,
    sum_of_squares: f64,
    sum_of_fourths: f64,
}

impl Moments {
    /// The moments of `values`; `None` if there are no values, or the moments are not finite or too small for a number.
    pub fn of(values: &[f64]) -> Option<Self> {
        let moments = Self::of_values(values).if_finite()?;
        (!values.is_empty() && !moments.lost(values)).then_some(moments)
    }

    /// The same if it is finite.
    pub(crate) fn if_finite(self) -> Option<Self> {
        (self.mean.is_finite() && self.sum_of_squares.is_finite()).then_some(self)
    }

    /// True if the values differ, but by so little that their squares have lost digits.
    fn lost(&self, values: &[f64]) -> bool {
        // A square keeps its digits above this, and a mean of them does.
        let smallest = f64::MIN_POSITIVE / f64::EPSILON * self.count as f64;
        self.sum_of_squares < smallest && values.iter().any(|value| *value != values[0])
    }

    /// Refuses values `of` something of which the squares are lost.
    pub(crate) fn require_squares(&self, values: &[f64], of: &str) -> Result<(), UncertaintyError> {
        if self.lost(values) { Err(UncertaintyError::too_small(of)) } else { Ok(()) }
    }

    /// The moments of values of which the caller knows that they are fit for it.
    pub(crate) fn of_values(values: &[f64]) -> Self {
        let (count, first) = (values.len(), values.first().copied().unwrap_or(0.0));
        let n = count as f64;
        let [sum] = sums(values, first, |d| [d]);
        let near = first + sum / n;
        let [sum, squares, fourths] = sums(values, near, |d| [d, d * d, (d * d) * (d * d)]);
        // The rest of the sum by the rounding of the mean is taken out of both moments.
        let mut sum_of_squares = squares - sum * (sum / n);
        if sum_of_squares < 0.0 {
            sum_of_squares = 0.0;
        }
        Self { count, mean: near + sum / n, sum_of_squares, sum_of_fourths: fourths }
    }

    /// n, number of values.
    pub const fn count(&self) -> usize {
        self.count
    }

    /// m, mean (unit of the values).
    pub const fn mean(&self) -> f64 {
        self.mean
    }

    /// s, standard deviation with n − 1 (unit of the values); `None` for a single value.
    pub fn standard_deviation(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.sum_of_squares / (self.count - 1) as f64).sqrt())
    }

    /// Standard error of s (unit of the values), from the fourth moment and so right for any distribution that has
    /// one; `None` for a single value.
    ///
    /// ```text
    /// u(s) = (s/2) √((m₄/m₂² − 1)/n)
    /// ```
    pub fn standard_error_of_deviation(&self) -> Option<f64> {
        let s = self.standard_deviation()?;
        if s == 0.0 {
            return Some(0.0);
        }
        let n = self.count as f64;
        let kurtosis = n * (self.sum_of_fourths / self.sum_of_squares) / self.sum_of_squares;
        Some(0.5 * s * ((kurtosis - 1.0).max(0.0) / n).sqrt())
    }

    /// Σ (x − m)² (square of the unit).
    pub(crate) const fn sum_of_squares(&self) -> f64 {
        self.sum_of_squares
    }
}

/// The sums of some `powers` of x − `origin`.
fn sums<const N: usize>(values: &[f64], origin: f64, powers: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let mut total = [0.0; N];
    for block in values.chunks(BLOCK) {
        let mut lanes = [[0.0; LANES]; N];
        let (whole, rest) = block.as_chunks::<LANES>();
        for chunk in whole {
            for (lane, x) in chunk.iter().enumerate() {
                for (sums, power) in lanes.iter_mut().zip(powers(x - origin)) {
                    sums[lane] += power;
                }
            }
        }
        for x in rest {
            for (sums, power) in lanes.iter_mut().zip(powers(x - origin)) {
                sums[0] += power;
            }
        }
        for (sum, lanes) in total.iter_mut().zip(lanes) {
            *sum += lanes.iter().sum::<f64>();
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_values_and_one_value() {
        assert_eq!(Moments::of(&[]), None);
        assert_eq!(Moments::of(&[1.0, f64::NAN]), None);
        assert_eq!(Moments::of(&[1e300, -1e300, 1e300]), None, "squares overflow");
        let one = Moments::of(&[2.5]).unwrap();
        assert_eq!((one.mean(), one.standard_deviation(), one.count()), (2.5, None, 1));
    }

    #[test]
    fn standard_error_of_the_deviation() {
        // ±1 with equal probability: m₄ = m₂² and no error at all. Equal steps 0 … n − 1: kurtosis near 9/5.
        let flat: Vec<f64> = (0..10_000).map(|i| f64::from(i % 2) * 2.0 - 1.0).collect();
        assert!(Moments::of(&flat).unwrap().standard_error_of_deviation().unwrap() < 1e-9);
        let steps: Vec<f64> = (0..10_000).map(f64::from).collect();
        let moments = Moments::of(&steps).unwrap();
        let expected = 0.5 * moments.standard_deviation().unwrap() * (0.8f64 / 1e4).sqrt();
        // s² carries n − 1 and the kurtosis of steps differs from 9/5 by 1/n².
        assert!((moments.standard_error_of_deviation().unwrap() / expected - 1.0).abs() < 1e-6);
    }
}
