//! Taylor series of a law along a motion, order by order.

use fmm_model::Scalar;

use crate::law::functions::power;

/// One Taylor coefficient an order, from 0 on.
pub(crate) type Terms<D> = [D; Expansion::<f64>::TERMS];

/// Taylor coefficients, in any unit of time, of a [`BristleLaw`](crate::BristleLaw) of one state along a motion.
///
/// [`BristleLaw::expand`](crate::BristleLaw::expand) computes one order after the other: the motion at one order needs
/// the law at the order before.
///
/// ```text
/// (a b)ₖ = Σⱼ aⱼ bₖ₋ⱼ,     k a₀ (aᵉ)ₖ = Σⱼ (e (k − j) − j) aₖ₋ⱼ (aᵉ)ⱼ (j < k),     k (eᵃ)ₖ = Σⱼ j aⱼ (eᵃ)ₖ₋ⱼ
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
    /// True for a state that stays constant because it has reached its bound.
    pub held: bool,
    /// Intermediate series of a law.
    pub(crate) room: [Terms<D>; 6],
}

impl<D: Scalar> Expansion<D> {
    /// Number of coefficients: orders 0 to 24.
    pub const TERMS: usize = 25;

    /// Room for the coefficients, all zero.
    pub fn new() -> Self {
        let zeros = [D::from(0.0); Expansion::<f64>::TERMS];
        Self { velocity: zeros, state: zeros, rate: zeros, coefficient: zeros, held: false, room: [zeros; 6] }
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
    convolve(&a[..=order], &b[..=order])
}

/// Σ aᵢ bₙ₋ᵢ over two slices of n + 1 numbers, in four sums that do not wait for each other.
#[inline]
pub(crate) fn convolve<D: Scalar>(a: &[D], b: &[D]) -> D {
    let mut sums = [D::from(0.0); 4];
    let (parts, ends) = (a.chunks_exact(4), b.rchunks_exact(4));
    let rest = parts.remainder().iter().zip(ends.remainder().iter().rev());
    for (sum, (a, b)) in sums.iter_mut().zip(rest) {
        *sum = *a * *b;
    }
    for (a, b) in parts.zip(ends) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += a[lane] * b[3 - lane];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}

/// True for an exponent of 1 or 2 that has derivatives. At a base of zero such a power has a series, but the
/// derivatives of the series do not exist.
pub(crate) fn is_whole_with_derivatives<D: Scalar>(exponent: D) -> bool {
    is_whole(exponent) && (0..D::DIRECTIONS).any(|direction| exponent.partial(direction) != 0.0)
}

/// True for an exponent of 1 or 2. Such a power has a series at a base of zero as well.
pub(crate) fn is_whole<D: Scalar>(exponent: D) -> bool {
    exponent.value() == 1.0 || exponent.value() == 2.0
}

/// Writes the coefficient of `order` of `base` to the power `exponent` into `power_of`; `room` is used by this power
/// alone.
///
/// The base must not begin at zero, unless the exponent [is whole](is_whole) and without derivatives.
pub(crate) fn raise<D: Scalar>(
    base: &Terms<D>,
    exponent: D,
    power_of: &mut Terms<D>,
    room: &mut Terms<D>,
    order: usize,
) {
    if !is_whole(exponent) {
        power_of[order] = if order == 0 {
            power(base[0], exponent)
        } else {
            // e Σⱼ (k − j) aₖ₋ⱼ pⱼ − Σⱼ j pⱼ aₖ₋ⱼ, the second with j aⱼ in the place of j pⱼ, as Σⱼ k aₖ₋ⱼ pⱼ is known.
            room[order] = base[order] * order as f64;
            let rising = convolve(&power_of[..order], &room[1..=order]);
            let whole = convolve(&power_of[..order], &base[1..=order]);
            (rising * (exponent + 1.0) - whole * order as f64) * (D::from(1.0) / (base[0] * order as f64))
        };
        return;
    }
    power_of[order] = if exponent.value() == 1.0 { base[order] } else { product(base, base, order) };
    if is_whole_with_derivatives(exponent) {
        // ln a: k aₖ = Σⱼ j (ln a)ⱼ aₖ₋ⱼ.
        room[order] = if order == 0 {
            base[0].ln()
        } else {
            let known = (1..order).map(|j| room[j] * base[order - j] * j as f64);
            let known = known.fold(D::from(0.0), |sum, term| sum + term);
            (base[order] - known / order as f64) / base[0]
        };
        // The factor has the value 0, so that of the power stays as it is.
        power_of[order] += (exponent - exponent.value()) * product(power_of, room, order).value();
    }
}

/// Writes the coefficient of `order` of exp(−`of`) into `exponential`; `slope` is room for −`of`′.
pub(crate) fn decay<D: Scalar>(of: &Terms<D>, exponential: &mut Terms<D>, slope: &mut Terms<D>, order: usize) {
    if order == 0 {
        exponential[0] = (-of[0]).exp();
        return;
    }
    slope[order] = of[order] * -(order as f64);
    exponential[order] = convolve(&exponential[..order], &slope[1..=order]) * (1.0 / order as f64);
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    use crate::law::{BristleLaw, Regime};
    use crate::laws::{BoucWen, Dahl, LuGre};

    type Number = Dual<2>;

    /// The velocity is a polynomial in time. The series of the rate then agrees with the law at a later velocity and
    /// state, with derivatives in a level and in an exponent.
    fn check<L: BristleLaw<Number>>(name: &str, law: &L, velocity: [f64; 3], state: f64, time: f64) {
        let mut series = Expansion::new();
        for (term, velocity) in series.velocity.iter_mut().zip(velocity) {
            *term = Number::from(velocity);
        }
        series.state[0] = Number::from(state);
        for order in 0..Expansion::<f64>::TERMS {
            assert!(law.expand(order, &mut series), "{name}");
            if let Some(next) = series.state.get_mut(order + 1) {
                *next = series.rate[order] / (order + 1) as f64;
            }
        }
        let at = |terms: &Terms<Number>| terms.iter().rev().fold(Number::from(0.0), |sum, term| sum * time + *term);
        let (velocity, state, mut rate) = (at(&series.velocity), at(&series.state), [Number::from(0.0)]);
        law.rate(velocity, &[state], Regime::ALL_HOLD, &mut rate);
        let coefficient = law.coefficient(velocity, &[state], &rate);
        for (got, expected) in [(at(&series.rate), rate[0]), (at(&series.coefficient), coefficient)] {
            let size = expected.value().abs().max(1e-3 * velocity.value());
            assert!((got.value() - expected.value()).abs() < 1e-11 * size, "{name}: {got:?}, not {expected:?}");
            for direction in 0..2 {
                let (got, expected) = (got.partial(direction), expected.partial(direction));
                let size = expected.abs().max(size);
                assert!((got - expected).abs() < 1e-10 * size, "{name}, {direction}: {got}, not {expected}");
            }
        }
    }

    #[test]
    fn series_follow_the_laws() {
        let number = |value: f64| Number::from(value);
        let velocity = [0.02, 0.3, -2.0];
        for exponent in [0.6, 1.0, 1.4, 2.0] {
            let law = Dahl::new(Number::variable(0.25, 0), number(1e3), Number::variable(exponent, 1)).unwrap();
            for state in [-2.4e-4, 0.0, 1e-4] {
                check(&format!("dahl, {exponent}"), &law, velocity, state, 1e-3);
            }
        }
        for exponent in [0.8, 1.0, 1.5, 2.0] {
            let whole = is_whole(number(exponent));
            let seeded = if whole { number(exponent) } else { Number::variable(exponent, 1) };
            let [breakaway, fall_speed, damping, viscous] = [0.3, 0.05, 2.0, 0.1].map(number);
            let law =
                LuGre::new(Number::variable(0.2, 0), breakaway, fall_speed, seeded, number(1e3), damping, viscous);
            check(&format!("lugre, {exponent}"), &law.unwrap(), velocity, 1e-4, 1e-3);
        }
        for exponent in [1.0, 1.3, 2.0] {
            let whole = is_whole(number(exponent));
            let seeded = if whole { number(exponent) } else { Number::variable(exponent, 1) };
            let beta = 6e3f64.powf(exponent);
            let [beta, gamma] = [0.6, 0.4].map(|share| number(share * beta));
            let law = BoucWen::new(Number::variable(1e3, 0), number(1.0), beta, gamma, seeded).unwrap();
            for state in [-1e-4, 1e-4] {
                check(&format!("bouc_wen, {exponent}"), &law, velocity, state, 5e-4);
            }
        }
    }

    #[test]
    fn there_is_no_series_where_a_power_bends() {
        let mut series = Expansion::new();
        series.velocity[0] = 1e-3;
        let with = |exponent: f64| LuGre::new(0.2, 0.3, 0.05, exponent, 1e3, 0.0, 0.0).unwrap();
        assert!(with(2.0).expand(0, &mut series) && !with(1.5).expand(0, &mut series));
        let law = |exponent: f64| BoucWen::new(1e3, 1.0, 6e3, 4e3, exponent).unwrap();
        assert!(law(1.0).expand(0, &mut series) && !law(1.5).expand(0, &mut series));
        // Nor has the law an end beyond its bound, which it reaches from outside.
        series.state[0] = 0.2;
        let dahl = Dahl::new(0.1, 1.0, 1.0).unwrap();
        assert!(!dahl.expand(0, &mut series));
        series.held = true;
        assert!(dahl.expand(0, &mut series));
        assert_eq!(series.coefficient[0], 0.2);
    }
}
