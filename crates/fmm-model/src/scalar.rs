//! The number type in which a formula is written once: plain, or carrying derivatives.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::math;

/// Number type of a formula of FMM.
///
/// A law or an engine written over `Scalar` gives its value at `f64` and its exact gradient at [`Dual`](crate::Dual),
/// from the same lines. The trait is deliberately small: the arithmetic, comparisons of values, and the functions that
/// formulas of mechanics and of budgets use. A general trait such as num-dual's `DualNum` would put its forty methods
/// and its version number into every signature of a user's own law, and its division, x·(1/y), does not keep the
/// promise below.
///
/// Arithmetic takes a plain number on either side: `x * 2.0` everywhere, `2.0 * x` where the type is named, as in a
/// closure over `Dual<2>`. In a function generic in `D: Scalar` the language knows `2.0 * x` only by a bound,
/// `where f64: Mul<D, Output = D>`; a bound of the trait itself would make it take every product of two plain numbers
/// in such a function for one of these.
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
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + AddAssign<f64>
    + SubAssign<f64>
    + MulAssign<f64>
    + DivAssign<f64>
    + PartialOrd
    + PartialOrd<f64>
{
    /// Number of directions of derivative that the number carries; 0 for `f64`.
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
    /// Sine.
    #[must_use]
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    /// Cosine.
    #[must_use]
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    /// Tangent.
    #[must_use]
    fn tan(self) -> Self;
    /// The angle in (−π/2, π/2) with this tangent.
    #[must_use]
    fn atan(self) -> Self;
    /// Decimal logarithm.
    #[must_use]
    fn log10(self) -> Self;
    /// Hyperbolic tangent.
    #[must_use]
    fn tanh(self) -> Self;
    /// Whole power, of a base of either sign.
    #[must_use]
    fn powi(self, exponent: i32) -> Self;
    /// Power with an exponent that is a number or itself a parameter, the latter for a positive base.
    ///
    /// ```
    /// use fmm_model::{Dual, Scalar};
    ///
    /// let x = Dual::<1>::variable(4.0, 0);
    /// assert_eq!((x.powf(1.5).value(), x.powf(1.5).partial(0)), (8.0, 3.0));
    /// assert_eq!(x.powf(x).value(), 256.0);
    /// ```
    #[must_use]
    fn powf(self, exponent: impl Into<Self>) -> Self;
    /// The angle of the point (`x`, `self`) in (−π, π].
    #[must_use]
    fn atan2(self, x: Self) -> Self;
    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
}

/// Implements for a number type the operators of [`Scalar`] by its own arithmetic, each once with a number of the type
/// and once with a plain one on the right; plain numbers on the left, assignments, and comparisons by values follow.
///
/// The type needs `From<f64>`. A parameter of the type follows it, as in `Dual<N>, N: usize`.
///
/// ```text
/// scalar_operators! {
///     Pair;
///     -a => Pair(-a.0, -a.1);
///     a + b => Pair(a.0 + b.0, a.1 + b.1), Pair(a.0 + b, a.1);
///     a - b => Pair(a.0 - b.0, a.1 - b.1), Pair(a.0 - b, a.1);
///     a * b => a.times(b), Pair(a.0 * b, a.1 * b);
///     a / b => a.over(b), Pair(a.0 / b, a.1 / b);
/// }
/// ```
#[macro_export]
macro_rules! scalar_operators {
    (
        $number:ty $(, $parameter:ident: $kind:ty)?;
        -$a:ident => $negative:expr;
        $a1:ident + $b1:ident => $sum:expr, $sum_with_plain:expr;
        $a2:ident - $b2:ident => $difference:expr, $difference_with_plain:expr;
        $a3:ident * $b3:ident => $product:expr, $product_with_plain:expr;
        $a4:ident / $b4:ident => $quotient:expr, $quotient_with_plain:expr;
    ) => {
        impl$(<const $parameter: $kind>)? core::ops::Neg for $number {
            type Output = Self;
            fn neg(self) -> Self {
                let $a = self;
                $negative
            }
        }

        $crate::scalar_operators!(@with $number $(, $parameter: $kind)?; Add add AddAssign add_assign;
            $a1, $b1 => $sum, $sum_with_plain);
        $crate::scalar_operators!(@with $number $(, $parameter: $kind)?; Sub sub SubAssign sub_assign;
            $a2, $b2 => $difference, $difference_with_plain);
        $crate::scalar_operators!(@with $number $(, $parameter: $kind)?; Mul mul MulAssign mul_assign;
            $a3, $b3 => $product, $product_with_plain);
        $crate::scalar_operators!(@with $number $(, $parameter: $kind)?; Div div DivAssign div_assign;
            $a4, $b4 => $quotient, $quotient_with_plain);

        impl$(<const $parameter: $kind>)? PartialEq for $number {
            fn eq(&self, other: &Self) -> bool {
                $crate::Scalar::value(*self) == $crate::Scalar::value(*other)
            }
        }

        impl$(<const $parameter: $kind>)? PartialOrd for $number {
            fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
                $crate::Scalar::value(*self).partial_cmp(&$crate::Scalar::value(*other))
            }
        }

        impl$(<const $parameter: $kind>)? PartialEq<f64> for $number {
            fn eq(&self, other: &f64) -> bool {
                $crate::Scalar::value(*self) == *other
            }
        }

        impl$(<const $parameter: $kind>)? PartialOrd<f64> for $number {
            fn partial_cmp(&self, other: &f64) -> Option<core::cmp::Ordering> {
                $crate::Scalar::value(*self).partial_cmp(other)
            }
        }
    };
    (
        @with $number:ty $(, $parameter:ident: $kind:ty)?; $trait:ident $method:ident $assign:ident $assign_method:ident;
        $a:ident, $b:ident => $own:expr, $with_plain:expr
    ) => {
        impl$(<const $parameter: $kind>)? core::ops::$trait for $number {
            type Output = Self;
            fn $method(self, $b: Self) -> Self {
                let $a = self;
                $own
            }
        }

        impl$(<const $parameter: $kind>)? core::ops::$trait<f64> for $number {
            type Output = Self;
            fn $method(self, $b: f64) -> Self {
                let $a = self;
                $with_plain
            }
        }

        impl$(<const $parameter: $kind>)? core::ops::$trait<$number> for f64 {
            type Output = $number;
            fn $method(self, other: $number) -> $number {
                core::ops::$trait::$method(<$number>::from(self), other)
            }
        }

        impl$(<const $parameter: $kind>)? core::ops::$assign for $number {
            fn $assign_method(&mut self, other: Self) {
                *self = core::ops::$trait::$method(*self, other);
            }
        }

        impl$(<const $parameter: $kind>)? core::ops::$assign<f64> for $number {
            fn $assign_method(&mut self, other: f64) {
                *self = core::ops::$trait::$method(*self, other);
            }
        }
    };
}

pub(crate) use scalar_operators;

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
        math::exp(self)
    }
    fn ln(self) -> Self {
        math::ln(self)
    }
    fn sqrt(self) -> Self {
        math::sqrt(self)
    }
    fn sin_cos(self) -> (Self, Self) {
        math::sin_cos(self)
    }
    fn sin(self) -> Self {
        math::sin(self)
    }
    fn cos(self) -> Self {
        math::cos(self)
    }
    fn tan(self) -> Self {
        math::tan(self)
    }
    fn atan(self) -> Self {
        math::atan(self)
    }
    fn log10(self) -> Self {
        math::log10(self)
    }
    fn tanh(self) -> Self {
        math::tanh(self)
    }
    fn powi(self, exponent: i32) -> Self {
        math::powi(self, exponent)
    }
    fn powf(self, exponent: impl Into<Self>) -> Self {
        math::powf(self, exponent.into())
    }
    fn atan2(self, x: Self) -> Self {
        math::atan2(self, x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::Dual;

    fn all_functions<D: Scalar>(x: D, y: D) -> D {
        let (sin, cos) = (x * 0.7).sin_cos();
        let mut sum = x.exp() * sin + (y.ln() - cos) / x.sqrt() + x.powf(y) * y.atan2(x) + (y - 0.3).tanh();
        sum += x.sin() * y.cos() - (x * 0.4).tan();
        sum += 0.5;
        sum -= y.atan() / x.log10();
        sum -= x.powf(2.5);
        sum *= (x - y).powi(3);
        sum *= 0.125;
        sum /= y.powi(-2);
        sum /= 3.0;
        sum
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

    fn doubled<D: Scalar>(x: D) -> D
    where
        f64: Mul<D, Output = D>,
    {
        2.0 * x
    }

    #[test]
    fn plain_numbers_stand_on_either_side() {
        let x = Dual::<1>::variable(4.0, 0);
        let all = [2.0 + x, 2.0 - x, 2.0 * x, 2.0 / x];
        assert_eq!(all.map(Scalar::value), [6.0, -2.0, 8.0, 0.5]);
        assert_eq!(all.map(|y| y.partial(0)), [1.0, -1.0, 2.0, -0.125]);
        assert!(x > 3.0 && x <= 4.0 && x == 4.0 && x < Dual::from(5.0) && x == Dual::from(4.0));
        assert_eq!(doubled(x).partial(0), doubled(1.0));
    }

    #[test]
    fn powers_of_numbers_that_are_not_positive_have_their_derivatives() {
        let at = |value| Dual::<1>::variable(value, 0);
        assert_eq!((at(-3.0).powi(3).value(), at(-3.0).powi(3).partial(0)), (-27.0, 27.0));
        assert_eq!(
            (at(0.0).powi(0).partial(0), at(0.0).powi(1).partial(0), at(0.0).powi(2).partial(0)),
            (0.0, 1.0, 0.0)
        );
        assert_eq!((at(0.0).powf(2.0).value(), at(0.0).powf(2.0).partial(0)), (0.0, 0.0));
        assert_eq!((at(-2.0).powf(2.0).value(), at(-2.0).powf(2.0).partial(0)), (4.0, -4.0));
        assert_eq!(at(0.0).powf(0.0).partial(0), 0.0);
        assert_eq!(at(-2.0).powi(i32::MIN).value(), f64::powi(-2.0, i32::MIN));
    }

    #[test]
    fn the_angle_has_its_derivative_on_the_axis() {
        let angle = Scalar::atan2(Dual::<2>::variable(0.5, 0), Dual::variable(0.0, 1));
        assert_eq!(angle.value(), core::f64::consts::FRAC_PI_2);
        assert_eq!((angle.partial(0), angle.partial(1)), (0.0, -2.0));
    }

    #[test]
    fn directions_beyond_the_type_are_constants() {
        assert_eq!(Dual::<2>::variable(1.0, 2).partial(0), 0.0);
    }
}
