//! Taylor number: a value with its expansion.

use fmm_model::Scalar;

/// Powers (i, j) of the two directions, in the order of their coefficients.
const POWERS: [(usize, usize); 10] = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)];

/// Places of the products of two powers, by the positions of the factors.
const PRODUCTS: [(usize, usize, usize); 35] = products();

/// A value with its Taylor expansion to third order in two directions, exact through every operation.
///
/// ```text
/// f(a + δ) = Σ c_ij ε₁ⁱ ε₂ʲ,   i + j ≤ 3
/// ```
///
/// A model is evaluated in these numbers for its sensitivities, its curvature and the second-order terms of the GUM,
/// pair by pair of inputs. [`Scalar`] holds its functions; the arithmetic is with itself and with `f64`. Its values are
/// those of `f64` to the last bit, and comparisons are those of values.
///
/// ```
/// use fmm_uq::{Scalar, Taylor};
///
/// // x² y at (3, 2): slopes 2xy and x², and of the second order y dx² + 2x dx dy.
/// let (x, y) = (Taylor::variable(3.0, 0), Taylor::variable(2.0, 1));
/// let f = x * x * y;
/// assert_eq!((f.value(), f.partial(0), f.partial(1)), (18.0, 12.0, 9.0));
/// assert_eq!((f.coefficient(2, 0), f.coefficient(1, 1)), (2.0, 6.0));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Taylor {
    coefficients: [f64; 10],
}

impl Taylor {
    /// c_ij, coefficient of the `i`th power of the first direction and the `j`th of the second; 0 beyond the third
    /// order.
    pub fn coefficient(self, i: usize, j: usize) -> f64 {
        POWERS.iter().position(|&power| power == (i, j)).map_or(0.0, |at| self.coefficients[at])
    }

    /// The number `value` + `first` ε₁ + `second` ε₂.
    pub(crate) fn along(value: f64, first: f64, second: f64) -> Self {
        let mut number = Self::from(value);
        (number.coefficients[1], number.coefficients[2]) = (first, second);
        number
    }

    /// A function of it, by the value of the function and the coefficients of its own expansion there.
    fn compose(self, value: f64, series: [f64; 3]) -> Self {
        let mut difference = self;
        difference.coefficients[0] = 0.0;
        let square = difference * difference;
        let cube = square * difference;
        let mut result = Self::from(value);
        for (k, sum) in result.coefficients.iter_mut().enumerate().skip(1) {
            *sum = term(series[0], difference.coefficients[k])
                + term(series[1], square.coefficients[k])
                + term(series[2], cube.coefficients[k]);
        }
        result
    }

    /// xᵖ of this `value`, with the powers p − 1, p − 2 and p − 3.
    fn power(self, value: f64, p: f64, below: [f64; 3]) -> Self {
        let [first, second, third] = below;
        let slopes = [p, p * (p - 1.0) / 2.0, p * (p - 1.0) * (p - 2.0) / 6.0];
        self.compose(value, [term(first, slopes[0]), term(second, slopes[1]), term(third, slopes[2])])
    }

    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self { coefficients: self.coefficients.map(f) }
    }

    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut coefficients = self.coefficients;
        for (a, b) in coefficients.iter_mut().zip(other.coefficients) {
            *a = f(*a, b);
        }
        Self { coefficients }
    }

    /// The same about another value.
    fn raised(mut self, by: f64) -> Self {
        self.coefficients[0] += by;
        self
    }

    fn times(self, other: Self) -> Self {
        let mut coefficients = [0.0; 10];
        for (a, b, to) in PRODUCTS {
            coefficients[to] += self.coefficients[a] * other.coefficients[b];
        }
        Self { coefficients }
    }

    fn over(self, other: Self) -> Self {
        // From q · other = self, order by order: each coefficient of q follows from those before it.
        let mut quotient = self;
        for to in 0..10 {
            let mut rest = self.coefficients[to];
            for (a, b, at) in PRODUCTS {
                if at == to && b != 0 {
                    rest -= quotient.coefficients[a] * other.coefficients[b];
                }
            }
            quotient.coefficients[to] = rest / other.coefficients[0];
        }
        quotient
    }
}

/// A product in which a factor of 0 keeps it 0: an infinite slope does not concern a number that does not vary.
fn term(slope: f64, factor: f64) -> f64 {
    if factor == 0.0 { 0.0 } else { slope * factor }
}

const fn products() -> [(usize, usize, usize); 35] {
    let mut table = [(0, 0, 0); 35];
    let (mut a, mut next) = (0, 0);
    while a < 10 {
        let mut b = 0;
        while b < 10 {
            let (i, j) = (POWERS[a].0 + POWERS[b].0, POWERS[a].1 + POWERS[b].1);
            if i + j <= 3 {
                let order = i + j;
                table[next] = (a, b, order * (order + 1) / 2 + j);
                next += 1;
            }
            b += 1;
        }
        a += 1;
    }
    table
}

impl From<f64> for Taylor {
    fn from(value: f64) -> Self {
        let mut coefficients = [0.0; 10];
        coefficients[0] = value;
        Self { coefficients }
    }
}

fmm_model::scalar_operators! {
    Taylor;
    -a => a.map(|c| -c);
    a + b => a.zip(b, |a, b| a + b), a.raised(b);
    a - b => a.zip(b, |a, b| a - b), a.raised(-b);
    a * b => a.times(b), a.map(|c| c * b);
    a / b => a.over(b), a.map(|c| c / b);
}

impl Scalar for Taylor {
    const DIRECTIONS: usize = 2;

    fn variable(value: f64, direction: usize) -> Self {
        Self::along(value, f64::from(u8::from(direction == 0)), f64::from(u8::from(direction == 1)))
    }
    fn value(self) -> f64 {
        self.coefficients[0]
    }
    fn partial(self, direction: usize) -> f64 {
        if direction < 2 { self.coefficients[1 + direction] } else { 0.0 }
    }
    fn exp(self) -> Self {
        let exp = self.value().exp();
        self.compose(exp, [exp, exp / 2.0, exp / 6.0])
    }
    fn ln(self) -> Self {
        let r = self.value().recip();
        self.compose(self.value().ln(), [r, -r * r / 2.0, r * r * r / 3.0])
    }
    fn sqrt(self) -> Self {
        let (x, root) = (self.value(), self.value().sqrt());
        self.compose(root, [0.5 / root, -0.125 / (x * root), 0.0625 / (x * x * root)])
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value().sin_cos();
        (self.compose(sin, [cos, -sin / 2.0, -cos / 6.0]), self.compose(cos, [-sin, -cos / 2.0, sin / 6.0]))
    }
    fn tan(self) -> Self {
        let t = self.value().tan();
        let slope = 1.0 + t * t;
        self.compose(t, [slope, t * slope, slope * (1.0 + 3.0 * t * t) / 3.0])
    }
    fn atan(self) -> Self {
        let x = self.value();
        let slope = (1.0 + x * x).recip();
        self.compose(x.atan(), [slope, -x * slope * slope, (3.0 * x * x - 1.0) * slope * slope * slope / 3.0])
    }
    fn log10(self) -> Self {
        let mut logarithm = self.ln() / std::f64::consts::LN_10;
        logarithm.coefficients[0] = self.value().log10();
        logarithm
    }
    fn tanh(self) -> Self {
        let t = self.value().tanh();
        let cosh = self.value().cosh();
        let slope = (cosh * cosh).recip();
        self.compose(t, [slope, -t * slope, slope * (3.0 * t * t - 1.0) / 3.0])
    }
    fn powi(self, exponent: i32) -> Self {
        // Down from the exponent, of which none is left where the factor is zero.
        let power = |less: i32| self.value().powi(exponent.saturating_sub(less));
        self.power(power(0), f64::from(exponent), [power(1), power(2), power(3)])
    }
    fn powf(self, exponent: impl Into<Self>) -> Self {
        let exponent: Self = exponent.into();
        let (x, p) = (self.value(), exponent.value());
        let value = x.powf(p);
        if exponent.coefficients[1..].iter().all(|&c| c == 0.0) {
            return self.power(value, p, [x.powf(p - 1.0), x.powf(p - 2.0), x.powf(p - 3.0)]);
        }
        let mut power = (self.ln() * exponent).exp();
        power.coefficients[0] = value;
        power
    }
    fn atan2(self, x: Self) -> Self {
        // The expansion of the angle turned to the axis, where the quotient of the turned point is small and its
        // arc tangent is that quotient less a third of its cube.
        let radius = self.value().hypot(x.value());
        let (sin, cos) = (self.value() / radius, x.value() / radius);
        let mut turned = (self * cos - x * sin) / (x * cos + self * sin);
        turned.coefficients[0] = 0.0;
        turned.compose(self.value().atan2(x.value()), [1.0, 0.0, -1.0 / 3.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function<D: Scalar>(x: D, y: D) -> D {
        let (sin, cos) = (x * 0.7).sin_cos();
        let powers = x.powf(y) + y.powf(D::from(2.5)) * 0.1;
        let mut sum =
            x.exp() * sin + (y.ln() - cos) / x.sqrt() + powers * y.atan2(x) + (y - 0.3).tanh() - (-x) / (y + 1.0);
        sum += x.sin() * y.cos() + (x * 0.3).tan() - y.atan();
        sum += y.powf(1.5) * 0.1;
        sum -= x.log10() + y.powi(3) * 0.1;
        sum *= y.powi(-2);
        sum /= 0.5;
        sum
    }

    #[test]
    fn values_and_slopes_are_those_of_other_numbers() {
        let (x, y) = (1.3, 2.1);
        let taylor = function(Taylor::variable(x, 0), Taylor::variable(y, 1));
        let dual = function(fmm_model::Dual::<2>::variable(x, 0), fmm_model::Dual::variable(y, 1));
        assert_eq!(taylor.value(), function(x, y));
        for direction in 0..2 {
            let error = taylor.partial(direction) / dual.partial(direction) - 1.0;
            assert!(error.abs() < 1e-14, "direction {direction}: {error}");
        }
    }

    /// The polynomial meets the function at a distance h up to the fourth order, of coefficients near 1.
    #[test]
    fn the_expansion_meets_the_function() {
        let (x, y) = (1.3, 2.1);
        let taylor = function(Taylor::variable(x, 0), Taylor::variable(y, 1));
        let power = |x: f64, n: usize| x.powi(i32::try_from(n).unwrap());
        for h in [1e-2_f64, 3e-3] {
            for (dx, dy) in [(h, 0.0_f64), (0.0, h), (h, h), (-h, 0.5 * h)] {
                let term = |(i, j): (usize, usize)| taylor.coefficient(i, j) * power(dx, i) * power(dy, j);
                let expanded: f64 = POWERS.map(term).iter().sum();
                let error = expanded - function(x + dx, y + dy);
                assert!(error.abs() < 10.0 * h.powi(4) + 1e-14, "h = {h}: {error}");
            }
        }
    }

    #[test]
    fn plain_numbers_stand_on_either_side_and_whole_powers_take_any_base() {
        let x = Taylor::variable(4.0, 0);
        let all = [2.0 + x, 2.0 - x, 2.0 * x, 2.0 / x];
        assert_eq!(all.map(Scalar::value), [6.0, -2.0, 8.0, 0.5]);
        assert_eq!(all.map(|y| y.partial(0)), [1.0, -1.0, 2.0, -0.125]);
        assert!(x > 3.0 && x == 4.0 && x < Taylor::from(5.0));
        // (−2 + d)³ = −8 + 12 d − 6 d² + d³, and 0² has d² alone.
        let cube = Taylor::variable(-2.0, 0).powi(3);
        assert_eq!([0, 1, 2, 3].map(|i| cube.coefficient(i, 0)), [-8.0, 12.0, -6.0, 1.0]);
        let square = Taylor::variable(0.0, 0).powi(2);
        assert_eq!([0, 1, 2, 3].map(|i| square.coefficient(i, 0)), [0.0, 0.0, 1.0, 0.0]);
    }

    #[test]
    fn constants_do_not_meet_infinite_slopes() {
        assert_eq!(Taylor::from(0.0).sqrt().coefficients, Taylor::from(0.0).coefficients);
        assert!(!Taylor::variable(0.0, 0).sqrt().partial(0).is_finite());
    }
}
