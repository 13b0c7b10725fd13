//! Dual number: a value with its partial derivatives.

use crate::math;
use crate::scalar::{Scalar, scalar_operators};

/// A value with its partial derivatives in `N` directions, both exact through every operation.
///
/// ```text
/// f(a + Σ aᵢ εᵢ) = f(a) + Σ f′(a) aᵢ εᵢ,     εᵢ εⱼ = 0
/// ```
///
/// The values are bit for bit those of `f64`, and comparisons are those of values. [`Scalar`] holds its functions.
///
/// # References
/// W. K. Clifford, "Preliminary sketch of biquaternions", Proc. London Math. Soc. 4 (1873) 381.
#[derive(Debug, Clone, Copy)]
pub struct Dual<const N: usize> {
    value: f64,
    partials: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The number with the same directions whose value is `value` and whose derivatives are `slope` times these.
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, partials: self.partials.map(|partial| slope * partial) }
    }

    /// The number of this `value` whose derivatives are `slope` times these plus `other_slope` times those of `other`.
    fn chain_with(self, value: f64, slope: f64, other: Self, other_slope: f64) -> Self {
        let mut partials = self.partials;
        for (partial, other) in partials.iter_mut().zip(other.partials) {
            *partial = slope * *partial + other_slope * other;
        }
        Self { value, partials }
    }

    fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        // Not with the reciprocal of the divisor, which may be infinite where the quotient is not.
        let mut partials = self.partials;
        for (partial, other_partial) in partials.iter_mut().zip(other.partials) {
            *partial = (*partial - value * other_partial) / other.value;
        }
        Self { value, partials }
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    fn from(value: f64) -> Self {
        Self { value, partials: [0.0; N] }
    }
}

scalar_operators! {
    Dual<N>, N: usize;
    -a => a.chain(-a.value, -1.0);
    a + b => a.chain_with(a.value + b.value, 1.0, b, 1.0), Self { value: a.value + b, ..a };
    a - b => a.chain_with(a.value - b.value, 1.0, b, -1.0), Self { value: a.value - b, ..a };
    a * b => a.chain_with(a.value * b.value, b.value, b, a.value), a.chain(a.value * b, b);
    a / b => a.over(b), Self { value: a.value / b, partials: a.partials.map(|partial| partial / b) };
}

impl<const N: usize> Scalar for Dual<N> {
    const DIRECTIONS: usize = N;

    fn variable(value: f64, direction: usize) -> Self {
        let mut partials = [0.0; N];
        if let Some(partial) = partials.get_mut(direction) {
            *partial = 1.0;
        }
        Self { value, partials }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn partial(self, direction: usize) -> f64 {
        self.partials.get(direction).copied().unwrap_or(0.0)
    }
    fn exp(self) -> Self {
        let exp = self.value.exp();
        self.chain(exp, exp)
    }
    fn ln(self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }
    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }
    fn tan(self) -> Self {
        let tan = self.value.tan();
        self.chain(tan, 1.0 + tan * tan)
    }
    fn atan(self) -> Self {
        self.chain(self.value.atan(), (1.0 + self.value * self.value).recip())
    }
    fn log10(self) -> Self {
        self.chain(self.value.log10(), (self.value * core::f64::consts::LN_10).recip())
    }
    fn tanh(self) -> Self {
        let tanh = self.value.tanh();
        // 1 − tanh² loses its digits where tanh is close to 1; 1/cosh² does not.
        let cosh = math::cosh(self.value);
        self.chain(tanh, (cosh * cosh).recip())
    }
    fn powi(self, exponent: i32) -> Self {
        let slope = match exponent {
            0 => 0.0,
            _ => f64::from(exponent) * self.value.powi(exponent.saturating_sub(1)),
        };
        self.chain(self.value.powi(exponent), slope)
    }
    fn powf(self, exponent: impl Into<Self>) -> Self {
        let exponent: Self = exponent.into();
        let power = self.value.powf(exponent.value);
        let slope = if exponent.value == 0.0 { 0.0 } else { exponent.value * self.value.powf(exponent.value - 1.0) };
        if exponent.partials.iter().all(|partial| *partial == 0.0) {
            // Without the logarithm, which a base that is not positive has not.
            self.chain(power, slope)
        } else {
            self.chain_with(power, slope, exponent, power * self.value.ln())
        }
    }
    fn atan2(self, x: Self) -> Self {
        // y′ x − x′ y over x² + y², in units of the larger of the two, whose squares neither over- nor underflow.
        let size = self.value.abs().max(x.value.abs());
        let (sin, cos) = (self.value / size, x.value / size);
        let square = (sin * sin + cos * cos) * size;
        self.chain_with(self.value.atan2(x.value), cos / square, x, -sin / square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_plain_numbers_to_the_last_bit() {
        for (a, b) in [(49.0, 49.0), (1.0, 49.0), (0.1, 0.3), (-7.3, 1e-3), (2.0f64.sqrt(), 3.0)] {
            let (x, y) = (Dual::<2>::variable(a, 0), Dual::variable(b, 1));
            assert_eq!((x / y).value(), a / b);
            assert_eq!((x * y - x / 3.0 + y).value(), a * b - a / 3.0 + b);
            assert_eq!(Scalar::atan2(x, y).value(), f64::atan2(a, b));
            assert_eq!(Scalar::tanh(x).value(), a.tanh());
        }
    }

    #[test]
    fn extreme_angles_and_hyperbolic_tangents_keep_their_derivatives() {
        for size in [1e-170, 1.0, 1e160] {
            let angle = Scalar::atan2(Dual::<2>::variable(0.5 * size, 0), Dual::variable(size, 1));
            assert!((angle.partial(0) * size - 0.8).abs() < 1e-15, "size {size}");
            assert!((angle.partial(1) * size + 0.4).abs() < 1e-15, "size {size}");
        }
        // 1/cosh² 20 = 4 e⁻⁴⁰ to 17 digits.
        let slope = Scalar::tanh(Dual::<1>::variable(20.0, 0)).partial(0);
        assert!((slope / (4.0 * (-40.0f64).exp()) - 1.0).abs() < 1e-15);
    }
}
