//! Taylor series of a law along a motion, order by order.

use fmm_model::Scalar;

use crate::power::power;

/// One Taylor coefficient an order, from 0 on.
pub(crate) type Terms<D> = [D; Expansion::<f64>::TERMS];

/// Taylor coefficients, in any unit of time, of a [`BristleLaw`](crate::BristleLaw) of one state along a motion.
///
/// [`BristleLaw::expand`](crate::BristleLaw::expand) works out those of one order after the other, as the coefficients of the motion of one
/// order need those of the law of the order before.
///
/// ```text
/// (a b)ₖ = Σⱼ aⱼ bₖ₋ⱼ,     k a₀ (aᵉ)ₖ = Σⱼ (e (k − j) − j) aₖ₋ⱼ (aᵉ)ⱼ,     k (eᵃ)ₖ = Σⱼ j aⱼ (eᵃ)ₖ₋ⱼ
/// ```
///
/// # References
/// A. Griewank, A. Walther, *Evaluating Derivatives*, 2nd ed., SIAM 2008, section 13.2, doi 10.1137/1.9780898717761.
#[derive(Debug, Clone)]
pub struct Expansion<D> {
    /// Coefficients of the relative velocity (m/s), which must not be negative, as far as they are known.
    pub velocity: Terms<D>,
    /// Coefficients of the state, as far as they are known.
    pub state: Terms<D>,
    /// Coefficients of dz/dt (unit of the state per second).
    pub rate: Terms<D>,
    /// Coefficients of the friction coefficient (1).
    pub coefficient: Terms<D>,
    /// Whether the state stays where it is, as one does that has reached its bound.
    pub held: bool,
    /// What laws need on the way.
    pub(crate) room: [Terms<D>; 4],
}

impl<D: Scalar> Expansion<D> {
    /// How many coefficients there are: orders 0 to 24.
    pub const TERMS: usize = 25;

    /// Room for the coefficients, all zero.
    pub fn new() -> Self {
        let zeros = [D::from(0.0); Expansion::<f64>::TERMS];
        Self { velocity: zeros, state: zeros, rate: zeros, coefficient: zeros, held: false, room: [zeros; 4] }
    }
}

impl<D: Scalar> Default for Expansion<D> {
    fn default() -> Self {
        Self::new()
    }
}

/// The coefficient of `order` of a product.
#[inline]
pub(crate) fn product<D: Scalar>(a: &Terms<D>, b: &Terms<D>, order: usize) -> D {
    dot(a[..=order].iter().zip(b[..=order].iter().rev()).map(|(a, b)| *a * *b))
}

/// The sum of some terms, even and odd ones apart: one sum waits for the other.
#[inline]
pub(crate) fn dot<D: Scalar>(mut terms: impl Iterator<Item = D>) -> D {
    let (mut even, mut odd) = (D::from(0.0), D::from(0.0));
    while let Some(term) = terms.next() {
        even += term;
        match terms.next() {
            Some(term) => odd += term,
            None => break,
        }
    }
    even + odd
}

/// Whether an exponent is 1 or 2 and a parameter with derivatives all the same: at a base of zero, the coefficients of these exist and
/// those of their derivatives do not.
pub(crate) fn is_whole_with_derivatives<D: Scalar>(exponent: D) -> bool {
    is_whole(exponent) && (0..D::DIRECTIONS).any(|direction| exponent.partial(direction) != 0.0)
}

/// Whether an exponent is 1 or 2, whose powers have a series at a base of zero as well.
pub(crate) fn is_whole<D: Scalar>(exponent: D) -> bool {
    exponent.value() == 1.0 || exponent.value() == 2.0
}

/// Writes the coefficient of `order` of `base` to the power `exponent` into `power_of`. `logarithm` is room.
///
/// The base must not begin at zero, unless the exponent [is whole](is_whole) and without derivatives.
pub(crate) fn raise<D: Scalar>(
    base: &Terms<D>,
    exponent: D,
    power_of: &mut Terms<D>,
    logarithm: &mut Terms<D>,
    order: usize,
) {
    if !is_whole(exponent) {
        power_of[order] = if order == 0 {
            power(base[0], exponent)
        } else {
            let factor = |j: usize| exponent * (order - j) as f64 - j as f64;
            let terms = (0..order).map(|j| factor(j) * base[order - j] * power_of[j]);
            dot(terms) / (base[0] * order as f64)
        };
        return;
    }
    power_of[order] = if exponent.value() == 1.0 { base[order] } else { product(base, base, order) };
    if is_whole_with_derivatives(exponent) {
        logarithm[order] = if order == 0 {
            base[0].ln()
        } else {
            let terms = (1..order).map(|j| logarithm[j] * base[order - j] * j as f64);
            (base[order] - dot(terms) / order as f64) / base[0]
        };
        // The factor has the value 0, so that of the power stays as it is.
        power_of[order] += (exponent - exponent.value()) * product(power_of, logarithm, order).value();
    }
}

/// Writes the coefficient of `order` of exp(−`of`) into `exponential`.
pub(crate) fn decay<D: Scalar>(of: &Terms<D>, exponential: &mut Terms<D>, order: usize) {
    exponential[order] = if order == 0 {
        (-of[0]).exp()
    } else {
        dot((1..=order).map(|j| of[j] * exponential[order - j] * j as f64)) / -(order as f64)
    };
}
