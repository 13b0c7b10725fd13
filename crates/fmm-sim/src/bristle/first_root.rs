//! The first zero of a polynomial on a step, found without ever stepping over one.

use crate::bristle::radau::STAGES;
use crate::dormand_prince::halves;

/// Number of halvings after which an interval counts as a point; Newton's method on the motion continues from there.
const DEPTH: u32 = 44;

/// Number of secants after which a zero is not improved.
const MOST_SECANTS: usize = 40;

/// The part of a step that begins at zero velocity in which the velocity counts as rising from it.
pub(super) const BEGINNING: f64 = 1.0 / 32.0;

/// The first τ in [0, 1] at which the polynomial with these Bernstein coefficients, positive before, reaches zero.
///
/// The polynomial lies within the convex hull of its coefficients. If all are positive there is no zero; otherwise the
/// halves are searched, the left one first (de Casteljau). A zero at 0 from which the polynomial rises does not count.
///
/// # References
/// G. Farin, *Curves and Surfaces for CAGD*, Morgan Kaufmann 2002, chapter 5.
pub(super) fn first_root<const N: usize>(coefficients: [f64; N]) -> Option<f64> {
    if coefficients[0] < 0.0 {
        return Some(0.0);
    }
    first_in(coefficients, 0.0, 1.0, DEPTH)
}

/// The first zero after one at 0, from which the polynomial rises; 0 if it does not rise.
///
/// With hardly any slope, rounding decides the sign at first. The sign is then that of a small part of the interval.
pub(super) fn next_root<const N: usize>(coefficients: [f64; N]) -> Option<f64> {
    let (mut begin, mut width, mut left) = (0.0, 1.0, coefficients);
    let mut parts = Vec::new();
    while width > BEGINNING {
        let (first, second) = halves(left);
        width *= 0.5;
        parts.push((second, width));
        left = first;
    }
    if left[N - 1] <= 0.0 {
        return Some(begin);
    }
    for (part, width) in parts.into_iter().rev() {
        begin = width;
        if let Some(tau) = if part[0] <= 0.0 { Some(begin) } else { first_in(part, begin, width, DEPTH) } {
            return Some(tau);
        }
    }
    None
}

/// The first zero after one at 0 at which the polynomial has a slope of the sign of `rise`, or none if that is zero.
pub(super) fn root_beyond(coefficients: [f64; STAGES + 1], rise: f64) -> Option<f64> {
    // Bernstein coefficients of the polynomial over τ.
    let mut quotient: [f64; STAGES] =
        std::array::from_fn(|index| coefficients[index + 1] * STAGES as f64 / (index + 1) as f64);
    if rise == 0.0 {
        quotient[0] = 0.0;
    }
    first_root(quotient)
}

fn first_in<const N: usize>(coefficients: [f64; N], begin: f64, width: f64, depth: u32) -> Option<f64> {
    if coefficients[1..].iter().all(|coefficient| *coefficient > 0.0) {
        return None;
    }
    if depth == 0 {
        return Some(begin);
    }
    if let Some(part) = only_root(&coefficients) {
        return Some(begin + width * part);
    }
    let (left, right) = halves(coefficients);
    first_in(left, begin, 0.5 * width, depth - 1).or_else(|| {
        let middle = begin + 0.5 * width;
        if right[0] <= 0.0 { Some(middle) } else { first_in(right, middle, 0.5 * width, depth - 1) }
    })
}

/// The zero of a polynomial that falls through it once: one whose coefficients change their sign once (variation
/// diminishing). It is found by the Illinois rule; `None` if that is slow, as for a zero close to the beginning.
fn only_root<const N: usize>(coefficients: &[f64; N]) -> Option<f64> {
    let changes = coefficients.windows(2).filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0)).count();
    if changes != 1 || !(coefficients[0] > 0.0) {
        return None;
    }
    let (mut low, mut high) = ((0.0, coefficients[0]), (1.0, coefficients[N - 1]));
    let mut side = 0.0f64;
    for _ in 0..MOST_SECANTS {
        let tau = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        if !(tau > low.0 && tau < high.0) {
            // Rounding puts it at one of the ends, next to which it is.
            return Some(if tau > low.0 { high.0 } else { low.0 });
        }
        let value = at(coefficients, tau);
        if value > 0.0 {
            low = (tau, value);
            high.1 *= if side > 0.0 { 0.5 } else { 1.0 };
            side = 1.0;
        } else {
            high = (tau, value);
            low.1 *= if side < 0.0 { 0.5 } else { 1.0 };
            side = -1.0;
        }
        if high.0 - low.0 <= f64::EPSILON || value == 0.0 {
            return Some(high.0);
        }
    }
    None
}

/// The value at `tau` (de Casteljau).
fn at<const N: usize>(coefficients: &[f64; N], tau: f64) -> f64 {
    let mut row = *coefficients;
    for level in 1..N {
        for index in 0..N - level {
            row[index] += tau * (row[index + 1] - row[index]);
        }
    }
    row[0]
}

/// The magnitude of the greater of the Legendre coefficients of degrees s − 1 and s, relative to the greatest Bernstein
/// coefficient. That of degree s alone would not do: the polynomial of an explicit step has none.
pub(super) fn last_coefficient(coefficients: [f64; STAGES + 1]) -> f64 {
    let size = coefficients.iter().fold(f64::MIN_POSITIVE, |size, coefficient| size.max(coefficient.abs()));
    let (mut differences, mut central) = (coefficients, 1.0);
    for level in 1..STAGES {
        for index in 0..=STAGES - level {
            differences[index] = differences[index + 1] - differences[index];
        }
        central *= (4 * level - 2) as f64 / level as f64;
    }
    // With n for s − 1: the n-th derivative over n! is s times the n-th difference, which goes in a line from one end
    // to the other. In the middle it is that of the polynomial of degree n alone, (2n)!/(n!)² times the coefficient
    // wanted; its slope is that of degree s.
    let [begin, end, ..] = differences;
    let before = STAGES as f64 * 0.5 * (begin + end) / central;
    let last = (end - begin) / (central * (4 * STAGES - 2) as f64 / STAGES as f64);
    before.abs().max(last.abs()) / size
}

/// The slope at 1, per unit of the step.
pub(super) fn end_slope(coefficients: [f64; STAGES + 1]) -> f64 {
    STAGES as f64 * (coefficients[STAGES] - coefficients[STAGES - 1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bristle::radau::{BERNSTEIN, NODES};

    fn bernstein(polynomial: impl Fn(f64) -> f64) -> [f64; STAGES + 1] {
        let mut nodal = [polynomial(0.0); STAGES + 1];
        for (nodal, node) in nodal[1..].iter_mut().zip(NODES) {
            *nodal = polynomial(node);
        }
        BERNSTEIN.map(|row| row.iter().zip(nodal).map(|(factor, value)| factor * value).sum())
    }

    #[test]
    fn finds_the_first_of_two_close_zeros_and_none_that_is_not_there() {
        for gap in [1e-2, 1e-4, 1e-6] {
            let first = first_root(bernstein(|tau| (tau - 0.6).powi(2) - gap * gap)).expect("two zeros");
            // Coefficients up to 1 carry rounding of about 1e-14, over a slope of 2 gap.
            assert!((first - (0.6 - gap)).abs() < 1e-14 / gap + 1e-12, "gap {gap}: {first}");
            assert_eq!(first_root(bernstein(|tau| (tau - 0.6).powi(2) + gap * gap)), None, "gap {gap}");
        }
        assert_eq!(first_root(bernstein(|tau| tau - 0.1)), Some(0.0));
    }

    #[test]
    fn leaves_a_zero_at_the_start_behind() {
        for power in 1..=3 {
            let rises = |tau: f64| tau.powi(power) * (0.5 - tau);
            let next = next_root(bernstein(rises)).expect("the zero at 0.5");
            assert!((next - 0.5).abs() < 1e-12, "power {power}: {next}");
            assert_eq!(next_root(bernstein(|tau| -rises(tau))), Some(0.0), "power {power}");
            assert_eq!(next_root(bernstein(|tau| tau.powi(power))), None, "power {power}");
        }
    }

    /// A swing that has come back after a small part of the step is seen, as it is not by the rule for the speed.
    #[test]
    fn finds_a_zero_however_near_to_that_at_the_start() {
        for part in [0.5, 1e-2, 1e-6, 1e-12] {
            let found = root_beyond(bernstein(|tau| tau * (part - tau)), part).expect("two zeros");
            assert!((found / part - 1.0).abs() < 1e-14 / part, "{part}: {found}");
            assert_eq!(root_beyond(bernstein(|tau| tau * (part + tau)), part), None, "{part}");
        }
        assert_eq!(root_beyond(bernstein(|tau| tau * tau), 0.0), None);
        assert!((root_beyond(bernstein(|tau| tau * tau * (0.25 - tau)), 0.0).expect("another") - 0.25).abs() < 1e-12);
    }

    #[test]
    fn the_last_coefficient_is_that_of_the_legendre_polynomials() {
        // On [0, 1] the leading coefficients of P₇ and P₈ are 14!/7!² = 3432 and 16!/8!² = 12870.
        for (power, central) in [(7, 3432.0), (8, 12870.0)] {
            let coefficients = bernstein(|tau| 1.0 + (2.0 * tau - 1.0).powi(power));
            let size = coefficients.iter().fold(0.0f64, |size, value| size.max(value.abs()));
            let expected = 2f64.powi(power) / central;
            assert!((last_coefficient(coefficients) * size / expected - 1.0).abs() < 1e-9, "degree {power}");
            assert!((end_slope(coefficients) - 2.0 * f64::from(power)).abs() < 1e-11, "degree {power}");
        }
    }
}
