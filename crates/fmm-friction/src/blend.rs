//! The passage from a static level to a sliding one.

use fmm_model::Scalar;

/// sliding + (breakaway − sliding) `share`, for a share from 0 (sliding) to 1 (breakaway) and its `rest`, 1 − share.
///
/// A share of exactly 1 gives exactly `breakaway`, no share gives more, and equal levels give exactly themselves:
/// the same line is measured from the end that it is nearer to. There the derivative in `sliding` is the rest, which
/// keeps its digits only if it is not computed from the share.
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
}
