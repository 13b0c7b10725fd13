//! Numbers of twice the precision, for the sums that decide how many digits of a regression are right.

use std::ops::{Add, Mul, Neg, Sub};

/// A number as the unevaluated sum of two floating-point numbers, good to about 31 digits.
///
/// # Why not a library
/// Sums and products are all that is needed of it; a crate for such numbers (twofloat) comes with their elementary
/// functions.
///
/// # References
/// T. J. Dekker, "A floating-point technique for extending the available precision", Numer. Math. 18 (1971) 224,
/// <https://doi.org/10.1007/BF01397083>.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// The product of two numbers, exact unless it underflows.
    pub(crate) fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        Self { high, low: a.mul_add(b, -high) }
    }

    /// The difference of two numbers, exact.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low }
    }

    /// The nearest floating-point number.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    /// Both parts times a power of two, which is exact.
    pub(crate) fn scaled(self, power_of_two: f64) -> Self {
        Self { high: self.high * power_of_two, low: self.low * power_of_two }
    }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, rest) = two_sum(self.low, other.low);
        let (high, low) = quick_two_sum(high, error + low);
        let (high, low) = quick_two_sum(high, low + rest);
        Self { high, low }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        let low = product.low + (self.high * other.low + self.low * other.high);
        let (high, low) = quick_two_sum(product.high, low);
        Self { high, low }
    }
}

impl std::iter::Sum for DoubleDouble {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::default(), |sum, term| sum + term)
    }
}

/// A sum and its rounding error.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// `two_sum` for `|a| ≥ |b|`.
fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cancels_in_one_number_survives_in_two() {
        let third = DoubleDouble::product(1.0 / 3.0, 3.0) - DoubleDouble::from(1.0);
        // 1/3 is rounded by ε/12 = 2⁻⁵⁴/3, three times that is exact.
        assert_eq!(third.value(), -(-54f64).exp2());
        let tiny = DoubleDouble::from(1.0) + DoubleDouble::from(1e-25) - DoubleDouble::from(1.0);
        assert!((tiny.value() - 1e-25).abs() < 1e-32, "{tiny:?}");
    }

    #[test]
    fn powers_of_a_tenth_keep_thirty_digits() {
        let tenth = DoubleDouble::difference(0.1, 0.0);
        let power = (0..5).fold(DoubleDouble::from(1.0), |power, _| power * tenth);
        // 0.1 = 3602879701896397/2⁵⁵, so that 10⁵ (0.1)⁵ = (1 + δ)⁵ with δ = 2⁻⁵⁴, of which 5δ + 10δ² is left.
        let delta = (-54f64).exp2();
        let rest = power * DoubleDouble::from(1e5) - DoubleDouble::from(1.0);
        assert!((rest.value() - 5.0 * delta).abs() < 1e-30, "{} against {}", rest.value(), 5.0 * delta);
    }
}
