//! The Dormand-Prince method of order 8 with its interpolant of order 7, for any number of unknowns.
//!
//! # References
//! E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., Springer 1993, section
//! II.10 (DOP853).

mod tableau;

use fmm_model::Scalar;

use crate::dormand_prince::tableau::{
    DENSE_0, DENSE_1, DENSE_2, DENSE_3, ERROR_3, ERROR_5, NODES, STAGE_1, STAGE_2, STAGE_3, STAGE_4, STAGE_5, STAGE_6,
    STAGE_7, STAGE_8, STAGE_9, STAGE_10, STAGE_11, STAGE_13, STAGE_14, STAGE_15, STEP, Weights,
};
use crate::scenario::State;

/// Rates of change of one unknown at all stages; that at 0 is the beginning of the step, and that at [`END`] its end.
pub(crate) type Rates<D> = [D; 16];

/// The stage at the end of the step.
pub(crate) const END: usize = 12;

#[inline]
fn sum<D: Scalar, const N: usize>(weights: &Weights<N>, rates: &Rates<D>) -> D {
    let (first, weight) = weights[0];
    let mut sum = rates[first] * weight;
    for (stage, weight) in &weights[1..] {
        sum += rates[*stage] * *weight;
    }
    sum
}

#[inline]
fn ahead<D: Scalar, const N: usize>(
    weights: &Weights<N>,
    begin: &[D],
    rates: &[Rates<D>],
    length: f64,
    state: &mut [D],
) {
    for ((state, begin), rates) in state.iter_mut().zip(begin).zip(rates) {
        *state = *begin + sum(weights, rates) * length;
    }
}

/// Evaluates stages one after the other, each with its weights.
macro_rules! stages {
    (($begin:ident, $length:ident, $rates:ident, $state:ident, $rate:ident) $($stage:literal: $weights:ident),+) => {$(
        ahead(&$weights, $begin, $rates, $length, $state);
        $rate(NODES[$stage] * $length, $state, $stage, $rates);
    )+};
}

/// Steps from `begin`, whose rates stand in `rates`, over `length` (s).
///
/// `rate` writes the rates at a time, counted from the beginning, and a state into the stage of this index. Afterwards
/// `end` holds the state at the end, and `state` that of the last stage before it, which belongs to the same time.
#[inline]
pub(crate) fn step<D: Scalar>(
    begin: &[D],
    length: f64,
    rates: &mut [Rates<D>],
    state: &mut [D],
    end: &mut [D],
    mut rate: impl FnMut(f64, &[D], usize, &mut [Rates<D>]),
) {
    stages!((begin, length, rates, state, rate) 1: STAGE_1, 2: STAGE_2, 3: STAGE_3, 4: STAGE_4, 5: STAGE_5, 6: STAGE_6);
    stages!((begin, length, rates, state, rate) 7: STAGE_7, 8: STAGE_8, 9: STAGE_9, 10: STAGE_10, 11: STAGE_11);
    ahead(&STEP, begin, rates, length, end);
    rate(length, end, END, rates);
}

/// Adds the stages that the interpolant needs to those of a step; arguments are those of [`step`].
#[inline]
pub(crate) fn dense_stages<D: Scalar>(
    begin: &[D],
    length: f64,
    rates: &mut [Rates<D>],
    state: &mut [D],
    mut rate: impl FnMut(f64, &[D], usize, &mut [Rates<D>]),
) {
    stages!((begin, length, rates, state, rate) 13: STAGE_13, 14: STAGE_14, 15: STAGE_15);
}

/// The terms F₀ to F₆ of the interpolant y + θ (F₀ + (1−θ) (F₁ + θ (F₂ + (1−θ) (F₃ + …)))) of an unknown that grows by
/// `rise` in a step of `length` (s).
#[inline]
pub(crate) fn nested<D: Scalar>(rates: &Rates<D>, rise: D, length: f64) -> [D; 7] {
    let (first, last) = (rates[0] * length, rates[END] * length);
    [
        rise,
        first - rise,
        rise * 2.0 - (last + first),
        sum(&DENSE_0, rates) * length,
        sum(&DENSE_1, rates) * length,
        sum(&DENSE_2, rates) * length,
        sum(&DENSE_3, rates) * length,
    ]
}

/// Mean rate of an unknown over a step (1/s).
#[inline]
pub(crate) fn mean_rate<D: Scalar>(rates: &Rates<D>) -> D {
    sum(&STEP, rates)
}

/// Step less the embedded formulas of orders 5 and 3, both per second.
#[inline]
pub(crate) fn errors<D: Scalar>(rates: &Rates<D>) -> (D, D) {
    (sum(&ERROR_5, rates), sum(&ERROR_3, rates))
}

/// The local error of a step of `length` (s) from the squares of the norms of its [`errors`].
///
/// ```text
/// err = h |e₅|² / √(|e₅|² + 0.01 |e₃|²)                    (Hairer, Nørsett, Wanner, eq. II.10.17)
/// ```
#[inline]
pub(crate) fn error(length: f64, fifth: f64, third: f64) -> f64 {
    if fifth == 0.0 { 0.0 } else { length * fifth / (fifth + 0.01 * third).sqrt() }
}

/// Degree of the polynomial within a step, plus one.
pub(crate) const COEFFICIENTS: usize = 8;

/// x and v as polynomials in the part θ ∈ [0, 1] of a step: y + θ (F₀ + (1−θ) (F₁ + θ (F₂ + (1−θ) (F₃ + …)))).
#[derive(Clone, Copy)]
pub(crate) struct Within<D> {
    pub(crate) begin: [D; 2],
    /// F₀ to F₆.
    pub(crate) nested: [[D; 7]; 2],
}

impl<D: Scalar> Within<D> {
    /// Σ cᵢ θⁱ for the position.
    pub(crate) fn position(&self) -> [D; COEFFICIENTS] {
        expand(self.begin[0], self.nested[0])
    }

    /// Σ cᵢ θⁱ for the velocity.
    pub(crate) fn velocity(&self) -> [D; COEFFICIENTS] {
        expand(self.begin[1], self.nested[1])
    }

    /// The state at the part `theta` of the step.
    pub(crate) fn at(&self, theta: f64) -> State<D> {
        let [position, velocity] =
            [0, 1].map(|unknown| interpolated(self.begin[unknown], &self.nested[unknown], theta));
        State { position, velocity }
    }
}

/// y + θ (F₀ + (1−θ) (F₁ + θ (F₂ + (1−θ) (F₃ + …)))) for `begin` y, `nested` F₀ to F₆ and `theta` θ.
pub(crate) fn interpolated<D: Scalar>(begin: D, nested: &[D; 7], theta: f64) -> D {
    // Times θ for even, times 1 − θ for odd terms.
    let weigh = |sum: D, (index, term): (usize, &D)| (sum + *term) * if index % 2 == 0 { theta } else { 1.0 - theta };
    begin + nested.iter().enumerate().rev().fold(D::from(0.0), weigh)
}

/// Powers of θ out of y + θ (F₀ + (1−θ) (F₁ + θ (F₂ + (1−θ) (F₃ + …)))).
fn expand<D: Scalar>(start: D, nested: [D; 7]) -> [D; COEFFICIENTS] {
    let zero = D::from(0.0);
    let mut powers = [zero; COEFFICIENTS];
    for (index, term) in nested.into_iter().enumerate().rev() {
        powers[0] += term;
        // Times θ for even, times 1 − θ for odd terms.
        for i in (0..COEFFICIENTS).rev() {
            let shifted = if i > 0 { powers[i - 1] } else { zero };
            powers[i] = if index % 2 == 0 { shifted } else { powers[i] - shifted };
        }
    }
    powers[0] += start;
    powers
}

/// Bernstein coefficients of a polynomial on the two halves of its interval (de Casteljau).
pub(crate) fn halves<const N: usize>(mut right: [f64; N]) -> ([f64; N], [f64; N]) {
    let mut left = right;
    for (level, left) in left.iter_mut().enumerate().skip(1) {
        for index in 0..N - level {
            right[index] = 0.5 * (right[index] + right[index + 1]);
        }
        *left = right[0];
    }
    (left, right)
}

/// The Bernstein coefficients on [0, 1] of Σ cᵢ τⁱ.
pub(crate) fn bernstein<const N: usize>(mut coefficients: [f64; N]) -> [f64; N] {
    let mut binomial = 1.0;
    for (order, coefficient) in coefficients.iter_mut().enumerate() {
        *coefficient /= binomial;
        binomial *= (N - 1 - order) as f64 / (order + 1) as f64;
    }
    // Bⱼ = Σᵢ C(j, i) cᵢ/C(n, i), by Pascal's triangle.
    for level in 1..N {
        for index in (level..N).rev() {
            coefficients[index] += coefficients[index - 1];
        }
    }
    coefficients
}
