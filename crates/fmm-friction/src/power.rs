//! Powers with an exponent that may itself be a parameter.

use fmm_model::Scalar;

/// `base` to the power `exponent` > 0, for a base ≥ 0.
///
/// Exponents of exactly 1 and 2, the usual ones, cost a multiplication. At a base of zero the derivative in the base
/// is left out where it is infinite; that in the exponent is zero there.
pub(crate) fn power<D: Scalar>(base: D, exponent: D) -> D {
    let whole = if exponent.value() == 1.0 {
        base
    } else if exponent.value() == 2.0 {
        base * base
    } else if base.value() == 0.0 {
        return D::from(0.0);
    } else {
        return base.powf(exponent);
    };
    // The derivative in the exponent, bᵉ ln b, has the limit 0 at b = 0.
    let slope = if base.value() > 0.0 { whole.value() * base.value().ln() } else { 0.0 };
    if D::DIRECTIONS > 0 && slope.is_finite() { whole + (exponent - exponent.value()) * slope } else { whole }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    fn gradient(base: f64, exponent: f64) -> (f64, [f64; 2]) {
        let power = power(Dual::<2>::variable(base, 0), Dual::variable(exponent, 1));
        (power.value(), [power.partial(0), power.partial(1)])
    }

    #[test]
    fn whole_exponents_are_products_with_the_derivatives_of_powers() {
        for base in [1e-200, 1e-3, 0.7, 1.0, 30.0, 1e160] {
            for exponent in [1.0, 2.0] {
                let (value, slopes) = gradient(base, exponent);
                assert_eq!(value, power(base, exponent), "{base}^{exponent} is the same for every number type");
                assert!((value - base.powf(exponent)).abs() <= 1e-15 * value || value.is_infinite());
                if value.is_finite() && value > 0.0 {
                    assert!((slopes[0] / (exponent * base.powf(exponent - 1.0)) - 1.0).abs() < 1e-14);
                    assert!((slopes[1] - value * base.ln()).abs() <= 1e-14 * (value * base.ln()).abs());
                }
            }
        }
    }

    #[test]
    fn nothing_to_any_power_is_nothing_with_finite_derivatives() {
        assert_eq!(gradient(0.0, 1.0), (0.0, [1.0, 0.0]));
        assert_eq!(gradient(0.0, 2.0), (0.0, [0.0, 0.0]));
        assert_eq!(gradient(0.0, 0.5), (0.0, [0.0, 0.0]));
        assert_eq!(gradient(0.0, 1.5), (0.0, [0.0, 0.0]));
    }
}
