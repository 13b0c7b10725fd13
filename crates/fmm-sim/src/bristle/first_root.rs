//! The first zero of a polynomial on a step, found without ever stepping over one.

use super::radau::STAGES;

/// Halvings after which an interval counts as a point; Newton's method on the motion itself takes over.
const DEPTH: u32 = 44;

/// The first τ in [0, 1] at which the polynomial with these Bernstein coefficients, positive before, reaches zero.
///
/// The polynomial lies within the convex hull of its coefficients: where all are positive there is no zero, and where some
/// are not, halves are looked at, the left one first (de Casteljau). A zero at 0 from which it rises is none.
///
/// # References
/// G. Farin, *Curves and Surfaces for CAGD*, Morgan Kaufmann 2002, chapter 5.
pub(super) fn first_root(coefficients: [f64; STAGES + 1]) -> Option<f64> {
    if coefficients[0] < 0.0 {
        return Some(0.0);
    }
    first_in(coefficients, 0.0, 1.0, DEPTH)
}

fn first_in(coefficients: [f64; STAGES + 1], begin: f64, width: f64, depth: u32) -> Option<f64> {
    if coefficients[1..].iter().all(|coefficient| *coefficient > 0.0) {
        return None;
    }
    if depth == 0 {
        return Some(begin);
    }
    let (left, right) = halves(coefficients);
    first_in(left, begin, 0.5 * width, depth - 1).or_else(|| {
        let middle = begin + 0.5 * width;
        if right[0] <= 0.0 { Some(middle) } else { first_in(right, middle, 0.5 * width, depth - 1) }
    })
}

/// The coefficients on both halves of the interval.
fn halves(mut right: [f64; STAGES + 1]) -> ([f64; STAGES + 1], [f64; STAGES + 1]) {
    let mut left = right;
    for level in 1..=STAGES {
        for index in 0..=STAGES - level {
            right[index] = 0.5 * (right[index] + right[index + 1]);
        }
        left[level] = right[0];
    }
    (left, right)
}

/// The magnitude of the Legendre coefficient of degree s, relative to the greatest Bernstein coefficient.
pub(super) fn last_coefficient(coefficients: [f64; STAGES + 1]) -> f64 {
    let size = coefficients.iter().fold(f64::MIN_POSITIVE, |size, coefficient| size.max(coefficient.abs()));
    // The s-th difference is the coefficient of τˢ, and that is (2s)!/(s!)² times the one sought.
    let (mut differences, mut central) = (coefficients, 1.0);
    for level in 1..=STAGES {
        for index in 0..=STAGES - level {
            differences[index] = differences[index + 1] - differences[index];
        }
        central *= (4 * level - 2) as f64 / level as f64;
    }
    differences[0].abs() / (central * size)
}

/// The slope at 1, per unit of the step.
pub(super) fn end_slope(coefficients: [f64; STAGES + 1]) -> f64 {
    STAGES as f64 * (coefficients[STAGES] - coefficients[STAGES - 1])
}
