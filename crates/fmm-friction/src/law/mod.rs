//! Traits of laws, the questions of an engine, and the vocabulary of a law as a family.

mod error;
pub(crate) mod expansion;
pub(crate) mod family;
mod feed_forward;
pub(crate) mod functions;
mod kind;
mod own;
pub(crate) mod parameter;
mod search;

use fmm_model::Scalar;

pub use error::LawError;
pub(crate) use error::digits;
pub use expansion::Expansion;
pub use family::{FamilyMember, FamilyVisitor, LawFamily, Reparametrisation, SpecialCase};
pub use feed_forward::FeedForward;
pub use kind::{LawKind, LawVisitor};
pub use own::{OwnLaw, SpeedFormula};
pub use parameter::{LawParameter, Role};
pub use search::{SearchRole, SearchStage, SearchTrial};

/// A law of the sliding speed alone, with a level to exceed before sliding begins.
///
/// An implementor promises:
///
/// 1. `coefficient` and `breakaway` are pure functions of the law's parameters and the speed;
/// 2. for every speed ≥ 0 the coefficient is finite and not negative, so that friction never pushes;
/// 3. the coefficient in the limit of zero speed does not exceed `breakaway`.
///
/// The engine sets the *sign*. A law sees only a speed and no direction, so that it cannot return a force along the
/// motion, and no law needs a dead zone or a smoothed signum. For this reason there is no single method that takes a
/// velocity. There is none that takes the load either: a law would then have to decide between stick and slip, which
/// depends on the machine.
///
/// ```
/// use fmm_friction::SlidingLaw;
/// use fmm_model::{Dual, Scalar};
///
/// /// Friction that falls with the speed, μ₀ + μ₁ exp(−α v).
/// struct Falling<D>(D, D, D);
///
/// impl<D: Scalar> SlidingLaw<D> for Falling<D> {
///     fn coefficient(&self, speed: D) -> D {
///         self.0 + self.1 * (-self.2 * speed).exp()
///     }
///     fn breakaway(&self) -> D {
///         self.0 + self.1
///     }
/// }
///
/// let law = Falling(Dual::<1>::from(0.228), Dual::from(0.261), Dual::variable(2.852, 0));
/// let coefficient = law.coefficient(Dual::from(0.2));
/// let exp = (-2.852f64 * 0.2).exp();
/// assert_eq!(coefficient.value(), 0.228 + 0.261 * exp);
/// assert!((coefficient.partial(0) + 0.261 * 0.2 * exp).abs() < 1e-16);
/// ```
pub trait SlidingLaw<D: Scalar> {
    /// Friction coefficient (1) while sliding at `speed` ≥ 0 (m/s).
    fn coefficient(&self, speed: D) -> D;

    /// Static level: the coefficient (1) that the load must exceed to break away from rest.
    fn breakaway(&self) -> D;

    /// True for a law that differs while the speed falls: [`coefficient`](Self::coefficient) holds while the speed
    /// grows, [`coefficient_losing_speed`](Self::coefficient_losing_speed) while it falls, and any value between the
    /// two at constant speed.
    fn depends_on_acceleration(&self) -> bool {
        false
    }

    /// Friction coefficient (1) while sliding at `speed` ≥ 0 (m/s) that falls. It differs from
    /// [`coefficient`](Self::coefficient) only if the law
    /// [depends on the acceleration](Self::depends_on_acceleration).
    fn coefficient_losing_speed(&self, speed: D) -> D {
        self.coefficient(speed)
    }

    /// The speed (m/s) at and below which a contact counts as resting if the load permits. Zero, except for laws with a
    /// dead zone by definition ([`Karnopp`](crate::Karnopp)).
    fn capture_speed(&self) -> D {
        D::from(0.0)
    }
}

/// Set of the elements of a bristle law that slide, one bit an element; the others hold.
///
/// Laws whose elements switch ([`MaxwellSlip`](crate::MaxwellSlip), [`Gms`](crate::Gms)) need this memory beside
/// their state. All elements hold when the velocity passes zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Regime(u64);

impl Regime {
    /// No element slides.
    pub const ALL_HOLD: Self = Self(0);

    /// The most elements that a law can have.
    pub const CAPACITY: usize = 64;

    /// True if the element of this `index` slides.
    pub const fn slides(self, index: usize) -> bool {
        index < Self::CAPACITY && self.0 >> index & 1 == 1
    }

    /// The same regime with the element of this `index` sliding.
    #[must_use]
    pub const fn sliding(self, index: usize) -> Self {
        if index < Self::CAPACITY { Self(self.0 | 1 << index) } else { self }
    }
}

/// A law with an internal state, the deflection of bristles that stand for the asperities in contact.
///
/// An implementor promises:
///
/// 1. all methods are pure functions of the law's parameters and their arguments;
/// 2. `rate` and `coefficient` are odd: both change sign with velocity and state together;
/// 3. the box |zᵢ| ≤ `bound(i)` is invariant: a state that starts inside stays inside;
/// 4. within one regime and one sign of the velocity, `rate` and `coefficient` are smooth.
///
/// Such a law needs no stick phase: at rest the bristles carry the load.
pub trait BristleLaw<D: Scalar> {
    /// Number of internal states.
    fn states(&self) -> usize;

    /// Writes dz/dt (unit of the state per second) at relative `velocity` (m/s) and `state` into `rate`; both
    /// slices hold [`states`](Self::states) values.
    fn rate(&self, velocity: D, state: &[D], regime: Regime, rate: &mut [D]);

    /// Friction coefficient (1), with the sign of the force that opposes a positive velocity. `rate` is
    /// the result of [`rate`](Self::rate) at the same arguments.
    fn coefficient(&self, velocity: D, state: &[D], rate: &[D]) -> D;

    /// Half width of the invariant interval of state `index`.
    fn bound(&self, index: usize) -> D;

    /// Friction coefficient (1) of steady sliding at `speed` ≥ 0 (m/s); `None` for laws without a closed form.
    fn steady_coefficient(&self, speed: D) -> Option<D> {
        let _ = speed;
        None
    }

    /// Carries the state along a motion of constant `velocity` (m/s, not zero) that lasts `duration` (s), and returns
    /// true; false, without a change of the state, for a law without a closed form.
    ///
    /// Elements that switch are taken to hold at the beginning, unless they are at their bound.
    ///
    /// ```
    /// use fmm_friction::{BristleLaw, Dahl};
    ///
    /// // 2 µm in 2 ms: z = (µ/σ)(1 − e^(−σ s/µ)) from rest.
    /// let (mut state, law) = ([0.0], Dahl::new(0.3, 1e5, 1.0)?);
    /// assert!(law.carry(1e-3, 2e-3, &mut state));
    /// assert!((state[0] - 3e-6 * (1.0 - f64::exp(-2.0 / 3.0))).abs() < 1e-20);
    /// # Ok::<(), fmm_friction::LawError>(())
    /// ```
    fn carry(&self, velocity: D, duration: D, state: &mut [D]) -> bool {
        let _ = (velocity, duration, state);
        false
    }

    /// Like [`carry`](Self::carry), from elements that slide as `regime` says, which is theirs at the end afterwards. They
    /// go on only if the velocity has not passed zero since.
    ///
    /// A law whose state does not tell which elements slide ([`Gms`](crate::Gms)) has this form only.
    fn carry_on(&self, velocity: D, duration: D, state: &mut [D], regime: &mut Regime) -> bool {
        let _ = regime;
        self.carry(velocity, duration, state)
    }

    /// Computes the Taylor coefficients of this `order` of rate and friction coefficient; known are those of lower
    /// orders, and velocity and state up to this order. Returns false if the law has no such series there, or several
    /// states. With a series an engine takes long steps of high order.
    ///
    /// ```
    /// use fmm_friction::{BristleLaw, Dahl, Expansion};
    ///
    /// // At constant velocity the deflection follows z′ = v (1 − σ z/µ).
    /// let (law, mut series) = (Dahl::new(0.3, 1e4, 1.0)?, Expansion::new());
    /// series.velocity[0] = 0.02;
    /// for order in 0..Expansion::<f64>::TERMS - 1 {
    ///     assert!(law.expand(order, &mut series));
    ///     series.state[order + 1] = series.rate[order] / (order + 1) as f64;
    /// }
    /// let at = |time: f64| series.state.iter().rev().fold(0.0, |sum, term| sum * time + term);
    /// assert!((at(1e-3) - 3e-5 * (1.0 - f64::exp(-2.0 / 3.0))).abs() < 1e-19);
    /// # Ok::<(), fmm_friction::LawError>(())
    /// ```
    fn expand(&self, order: usize, series: &mut Expansion<D>) -> bool {
        let _ = (order, series);
        false
    }

    /// Distance of an element from sliding (its unit is that of its state or coefficient) at this `velocity`: positive
    /// while the element holds. `None` for laws without elements that switch.
    fn reserve(&self, index: usize, velocity: D, state: &[D]) -> Option<D> {
        let _ = (index, velocity, state);
        None
    }
}

/// The numbers of an affine law, and the law itself: coefficient(v) = `level` + `slope` v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine<D = f64> {
    /// Coefficient in the limit of zero speed while sliding (1).
    pub level: D,
    /// Increase of the coefficient with speed (s/m).
    pub slope: D,
    /// Coefficient to exceed to leave rest (1).
    pub breakaway: D,
}

impl<D: Scalar> SlidingLaw<D> for Affine<D> {
    fn coefficient(&self, speed: D) -> D {
        self.level + self.slope * speed
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }
}

/// An elastic element that yields: a spring of `stiffness` which slides at `level`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element<D = f64> {
    /// Increase of the coefficient with the displacement while the element holds (1/m).
    pub stiffness: D,
    /// Coefficient at which it slides (1).
    pub level: D,
}

/// A law under which a linear oscillator moves in closed form between events.
///
/// ```text
/// F/N = level + slope |v|  +  Σ clamp(κᵢ zᵢ, ±levelᵢ),    κᵢ = stiffnessᵢ
/// ```
///
/// A law of the sliding speed alone has no elements. An implementor that is a [`SlidingLaw`] too promises that its
/// coefficients are those of [`affine`](Self::affine) and [`affine_losing_speed`](Self::affine_losing_speed). A blanket
/// implementation of [`SlidingLaw`] would forbid users to implement it for laws that are not affine.
pub trait PiecewiseLinearLaw<D: Scalar> {
    /// Level, slope and static level while the speed grows.
    fn affine(&self) -> Affine<D>;

    /// The same while the speed falls, if it differs.
    fn affine_losing_speed(&self) -> Option<Affine<D>> {
        None
    }

    /// Elements that deflect before they slide; at the start of a motion none is deflected.
    fn elements(&self) -> &[Element<D>] {
        &[]
    }
}

/// Makes piecewise linear laws sliding laws.
macro_rules! slides_as_affine {
    ($($law:ident),+) => {$(
        impl<D: Scalar> $crate::law::SlidingLaw<D> for $law<D> {
            fn coefficient(&self, speed: D) -> D {
                self.affine().coefficient(speed)
            }

            fn breakaway(&self) -> D {
                self.affine().breakaway
            }

            fn depends_on_acceleration(&self) -> bool {
                self.affine_losing_speed().is_some()
            }

            fn coefficient_losing_speed(&self, speed: D) -> D {
                self.affine_losing_speed().unwrap_or_else(|| self.affine()).coefficient(speed)
            }
        }
    )+};
}

pub(crate) use slides_as_affine;
