//! Friction of a law with internal state along a velocity that is given step by step.

use alloc::format;

use fmm_model::Scalar;

use crate::law::{BristleLaw, LawError, Regime, digits};

/// Follows the `N` states of a law along a velocity that is held over each step, in closed form: the feed-forward of a
/// controller that compensates friction.
///
/// A step costs an exponential or two, has no error of integration, however long it is and however stiff the bristles
/// are, and needs neither heap nor standard library. Laws with such a form are [`LuGre`](crate::LuGre),
/// [`Dahl`](crate::Dahl), [`MaxwellSlip`](crate::MaxwellSlip) and [`Gms`](crate::Gms), whose elements that slide are
/// remembered from step to step. A law of the sliding speed alone needs none of this: its
/// [`coefficient`](crate::SlidingLaw::coefficient) times the sign of the velocity is all.
///
/// The velocity fed is that which is *wanted*: a measured one, with its noise, turns the bristles to and fro at rest.
///
/// ```
/// use fmm_friction::{Dahl, FeedForward};
///
/// // 1 mm/s for 2 ms bends bristles by 2 µm, that yield at 3 µm; there and back leaves them bent the other way.
/// let mut friction = FeedForward::new(Dahl::new(0.3, 1e5, 1.0)?, [0.0])?;
/// let out = friction.step(1e-3, 2e-3).expect("finite");
/// assert!((out - 0.3 * (1.0 - f64::exp(-2.0 / 3.0))).abs() < 1e-15);
/// let back = friction.step(-1e-3, 2e-3).expect("finite");
/// assert!(back < 0.0 && friction.state() == &[back / 1e5]);
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
///
/// At a dual number the coefficient has its derivatives, those by the velocity among them:
///
/// ```
/// use fmm_friction::{Dahl, FeedForward};
/// use fmm_model::{Dual, Scalar};
///
/// // ∂μ/∂v = σ t exp(−σ v t/μ).
/// let number = Dual::<1>::from;
/// let law = Dahl::new(number(0.3), number(1e5), number(1.0))?;
/// let coefficient = FeedForward::new(law, [number(0.0)])?.step(Dual::variable(1e-3, 0), number(2e-3)).expect("finite");
/// assert!((coefficient.partial(0) - 200.0 * f64::exp(-2.0 / 3.0)).abs() < 1e-11);
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedForward<L, D, const N: usize> {
    law: L,
    state: [D; N],
    regime: Regime,
    /// Sign of the velocity of the last step; 0 at rest.
    sign: i8,
}

impl<D: Scalar, L: BristleLaw<D>, const N: usize> FeedForward<L, D, N> {
    /// A `law` whose states begin at `state` (their own unit), zero for bristles that nothing has bent.
    ///
    /// # Errors
    /// [`LawError::WrongCount`] unless the law has `N` states, [`LawError::OutOfBounds`] for a state beyond its
    /// [bound](BristleLaw::bound), [`LawError::Contradiction`] for a law without a closed form at constant velocity.
    pub fn new(law: L, state: [D; N]) -> Result<Self, LawError> {
        let states = law.states();
        if states != N {
            let what = format!("the law has {states} internal states, but {N} values were given");
            return Err(LawError::WrongCount { what, got: N });
        }
        for (index, state) in state.iter().enumerate() {
            let (value, bound) = (state.value(), law.bound(index).value());
            if !(value.abs() <= bound) {
                let what = format!("state {index} must lie within ±{}, but is {}", digits(bound), digits(value));
                return Err(LawError::OutOfBounds { what, value });
            }
        }
        let mut trial = state;
        if !law.carry_on(D::from(1.0), D::from(0.0), &mut trial, &mut Regime::default()) {
            let what =
                "the law has no closed form at constant velocity, as the laws LuGre, Dahl, Maxwell slip and GMS have";
            return Err(LawError::Contradiction { what: what.into() });
        }
        Ok(Self { law, state, regime: Regime::ALL_HOLD, sign: 0 })
    }

    /// Goes on for `duration` (s) at `velocity` (m/s); returns the friction coefficient (1) at the end, with the sign of
    /// the force that opposes a positive velocity. At rest nothing moves, and bristles keep their force.
    ///
    /// `None`, and no change, if the velocity or the duration is not finite, or the duration negative.
    pub fn step(&mut self, velocity: D, duration: D) -> Option<D> {
        if !(velocity.value().is_finite() && duration.value().is_finite() && duration.value() >= 0.0) {
            return None;
        }
        let sign = if velocity.value() == 0.0 { 0 } else { velocity.value().signum() as i8 };
        // All elements hold when the velocity passes zero.
        let mut regime = if sign == self.sign { self.regime } else { Regime::ALL_HOLD };
        let mut state = self.state;
        if sign != 0 {
            self.law.carry_on(velocity, duration, &mut state, &mut regime);
        }
        let mut rate = [D::from(0.0); N];
        self.law.rate(velocity, &state, regime, &mut rate);
        let coefficient = self.law.coefficient(velocity, &state, &rate);
        if !(coefficient.value().is_finite() && state.iter().all(|state| state.value().is_finite())) {
            return None;
        }
        (self.state, self.regime, self.sign) = (state, regime, sign);
        Some(coefficient)
    }

    /// The law.
    pub const fn law(&self) -> &L {
        &self.law
    }

    /// The states of the law, in its order and units.
    pub const fn state(&self) -> &[D; N] {
        &self.state
    }

    /// The elements that slide.
    pub const fn regime(&self) -> Regime {
        self.regime
    }
}
