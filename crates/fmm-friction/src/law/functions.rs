//! Functions that laws have in common, with derivatives that stay finite.

use fmm_model::Scalar;

/// sliding + (breakaway − sliding) `share`, for a share from 0 (sliding) to 1 (breakaway) and its `rest`, 1 − share.
///
/// A share of exactly 1 gives exactly `breakaway`, no share gives more, and two equal levels give exactly that level:
/// the value is computed from the nearer end. There the derivative in `sliding` is the rest, which keeps its digits
/// only if it is not computed from the share.
pub(crate) fn between<D: Scalar>(sliding: D, breakaway: D, share: D, rest: impl FnOnce() -> D) -> D {
    let excess = breakaway - sliding;
    if share.value() < 0.5 { sliding + excess * share } else { breakaway - excess * rest() }
}

/// The level after a `path` ≥ 0 of exponential fall from `breakaway` to `sliding`, the share being e⁻ᵖ.
pub(crate) fn fallen<D: Scalar>(sliding: D, breakaway: D, path: D) -> D {
    let share = (-path).exp();
    between(sliding, breakaway, share, || (path * 0.5).tanh() * (share + 1.0))
}

/// 1 − e⁻ᵖ with all its digits at a small `path` p ≥ 0.
pub(crate) fn risen<D: Scalar>(path: D) -> D {
    (path * 0.5).tanh() * ((-path).exp() + 1.0)
}

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

/// tanh of a `ratio` ≥ 0 that may be so large that its derivatives overflow, where those of tanh have vanished.
pub(crate) fn saturation<D: Scalar>(ratio: D) -> D {
    // 1/cosh² 400 is zero in f64.
    if ratio.value() > 400.0 { D::from(1.0) } else { ratio.tanh() }
}

/// −1 for a negative velocity, else 1.
pub(crate) fn direction<D: Scalar>(velocity: D) -> f64 {
    if velocity.value() < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    fn mixed<D: Scalar>(sliding: D, breakaway: D, share: D) -> D {
        between(sliding, breakaway, share, || -share + 1.0)
    }

    #[test]
    fn ends_are_exact_and_nothing_lies_above_the_static_level() {
        for step in 0..=1000 {
            let share = f64::from(step) / 1000.0;
            let level = mixed(0.1, 0.3, share);
            // Two roundings of numbers up to 0.3: 1e-16.
            assert!((level - (0.1 + 0.2 * share)).abs() < 1e-16 && level <= 0.3, "share {share}: {level}");
            assert_eq!(mixed(0.1, 0.1, share), 0.1);
        }
        assert_eq!((fallen(0.7, 1.1, 0.0), mixed(0.7, 1.1, 0.0)), (1.1, 0.7));
    }

    /// exp_m1 is right to a unit in the last place; the product to three.
    #[test]
    fn rises_keep_their_digits() {
        for path in [1e-300, 1e-9, 0.01, 0.69, 3.0, 50.0, 800.0] {
            let expected = -f64::exp_m1(-path);
            assert!((risen(path) - expected).abs() <= 4.0 * f64::EPSILON * expected, "path {path}: {}", risen(path));
        }
    }

    #[test]
    fn both_halves_have_the_same_derivatives() {
        for share in [0.25, 0.75] {
            let level = mixed(Dual::<3>::variable(0.1, 0), Dual::variable(0.3, 1), Dual::variable(share, 2));
            assert_eq!((level.partial(0), level.partial(1)), (1.0 - share, share));
            assert!((level.partial(2) - 0.2).abs() < 1e-16);
        }
    }

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
