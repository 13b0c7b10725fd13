//! The number type in which a formula is written once: plain, or carrying derivatives.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What a formula of FMM needs of its number type.
///
/// A law or an engine written over `Scalar` gives its value at `f64` and its exact gradient at [`Dual`](crate::Dual), from
/// the same lines. The trait is deliberately small: the arithmetic, with `f64` on the right, and the functions
/// that friction laws and linear oscillators use. A general trait such as num-dual's `DualNum` would put its
/// forty methods and its version number into every signature of a user's own law, and its division, x·(1/y), does not
/// keep the promise below.
///
/// An implementor promises that `value` of each operation is, to the last bit, the `f64` operation on the `value`s, so
/// that branches taken on values, exact ties among them, are the same for every number type.
///
/// ```
/// use fmm_model::{Dual, Scalar};
///
/// fn kinetic_energy<D: Scalar>(mass: D, velocity: D) -> D {
///     mass * velocity * velocity * 0.5
/// }
/// let energy = kinetic_energy(Dual::<2>::variable(2.0, 0), Dual::variable(3.0, 1));
/// assert_eq!(energy.value(), 9.0);
/// assert_eq!((energy.partial(0), energy.partial(1)), (4.5, 6.0));
/// ```
pub trait Scalar:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// How many directions of derivative the number carries; 0 for `f64`.
    const DIRECTIONS: usize;

    /// The independent variable of the given direction: derivative 1 there, 0 elsewhere.
    /// A direction that the type does not carry gives a constant, so that generic code can seed all it has.
    fn variable(value: f64, direction: usize) -> Self;
    /// The value without derivatives.
    fn value(self) -> f64;
    /// The partial derivative in `direction`, 0 for a direction that the type does not carry.
    fn partial(self, direction: usize) -> f64;
    /// `eˣ`.
    #[must_use]
    fn exp(self) -> Self;
    /// Natural logarithm.
    #[must_use]
    fn ln(self) -> Self;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// Hyperbolic tangent.
    #[must_use]
    fn tanh(self) -> Self;
    /// Power with an exponent that may itself be a parameter, for a positive base.
    #[must_use]
    fn powf(self, exponent: Self) -> Self;
    /// The angle of the point (`x`, `self`) in (−π, π].
    #[must_use]
    fn atan2(self, x: Self) -> Self;
    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
}

impl Scalar for f64 {
    const DIRECTIONS: usize = 0;

    fn variable(value: f64, _direction: usize) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn partial(self, _direction: usize) -> f64 {
        0.0
    }
    fn exp(self) -> Self {
        f64::exp(self)
    }
    fn ln(self) -> Self {
        f64::ln(self)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
    fn tanh(self) -> Self {
        f64::tanh(self)
    }
    fn powf(self, exponent: Self) -> Self {
        f64::powf(self, exponent)
    }
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    fn all_functions<D: Scalar>(x: D, y: D) -> D {
        let (sin, cos) = (x * 0.7).sin_cos();
        x.exp() * sin + (y.ln() - cos) / x.sqrt() + x.powf(y) * y.atan2(x) + (y - 0.3).tanh()
    }

    /// Central differences of step h carry an error of about h² plus ε/h: 1e-9 for h = 1e-5 and slopes near 10.
    fn check<D: Scalar>(directions: usize) {
        let (x, y, h) = (1.3, 2.1, 1e-5);
        let dual = all_functions(D::variable(x, 0), D::variable(y, 1));
        let slopes = [
            (all_functions(x + h, y) - all_functions(x - h, y)) / (2.0 * h),
            (all_functions(x, y + h) - all_functions(x, y - h)) / (2.0 * h),
        ];
        assert!((dual.value() - all_functions(x, y)).abs() < 1e-14);
        for (direction, slope) in slopes.iter().enumerate().take(directions) {
            let derivative = dual.partial(direction);
            assert!((derivative - slope).abs() < 1e-8, "direction {direction}: {derivative} against {slope}");
        }
        assert_eq!(dual.partial(directions), 0.0);
    }

    #[test]
    fn derivatives_agree_with_differences() {
        check::<f64>(0);
        check::<Dual<1>>(1);
        check::<Dual<2>>(2);
    }

    #[test]
    fn the_angle_has_its_derivative_on_the_axis() {
        let angle = Scalar::atan2(Dual::<2>::variable(0.5, 0), Dual::variable(0.0, 1));
        assert_eq!(angle.value(), std::f64::consts::FRAC_PI_2);
        assert_eq!((angle.partial(0), angle.partial(1)), (0.0, -2.0));
    }

    #[test]
    fn directions_beyond_the_type_are_constants() {
        assert_eq!(Dual::<2>::variable(1.0, 2).partial(0), 0.0);
    }
}
