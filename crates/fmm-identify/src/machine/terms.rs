//! Terms that are fitted beside the law, and parameters that are fixed.

use std::fmt::Write as _;

use fmm_model::{Bounds, ModelError, Parameter, Restoring, Scalar, Unit};

use crate::error::IdentifyError;
use crate::law::naming::{LINEAR, Units};

/// Terms that are fitted beside the law, and parameters that are fixed.
///
/// Linear, quadratic and cubic damping belong to every experiment; damping with a free power, the terms of the spring
/// and a change of the friction during the record to vibrations; zero, inertia, stiffness, gravity, asymmetry, load
/// offset, channels and delay to a [force along a motion](crate::ForceRecord):
///
/// ```text
/// F(t + τ) = (N + N₀) (µ + a |µ|) + c v + c₂ |v| v + c₃ v³ + m v' + k x + A sin x + B cos x + F₀ + Σ κᵢ yᵢ(t + τ)
/// ```
///
/// µ is the law, with the sign of the velocity; N is 1 without a measured load, so that levels are forces. A force
/// along a motion separates the levels of the two directions, a = (F₊ − F₋)/(F₊ + F₋); in a ring-down these are a level
/// and a force that moves the rest position. yᵢ are the [channels](crate::ForceRecord::with_channel) that were measured
/// beside the force. [`Candidate::named`](crate::Candidate::named) has a word for each term.
///
/// ```
/// use fmm_identify::Terms;
///
/// // A pendulum: air drag beside whatever the law is, and the exponent of a Stribeck curve held at 2.
/// let terms = Terms::default().with_quadratic_damping().holding("exponent", 2.0)?;
/// assert_eq!(terms.held().collect::<Vec<_>>(), [("exponent", 2.0)]);
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Terms {
    has: [bool; Term::ALL.len()],
    any_sign: bool,
    /// The longest delay of a force behind its motion (s); `None` for twenty samples.
    pub(crate) longest_delay: Option<f64>,
    held: Vec<(String, f64)>,
}

/// A term that is fitted beside the law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Term {
    LinearDamping,
    QuadraticDamping,
    CubicDamping,
    PowerDamping,
    /// The exponent of the term before it.
    PowerExponent,
    CubicSpring,
    QuinticSpring,
    Stop,
    /// The stiffness beyond the stop before it.
    StopRatio,
    Gap,
    /// Relative change w of the friction for each second.
    Change,
    /// Change q of that change.
    CurvedChange,
    /// Zero of the force, F₀.
    Zero,
    /// Inertia m v' of the mass between the force sensor and the contact.
    Inertia,
    /// Stiffness k x.
    Stiffness,
    /// Gravity on a joint, A sin x, for angles x in rad.
    Gravity,
    /// Its other part, B cos x.
    GravityCosine,
    /// Levels that differ by direction.
    Asymmetry,
    /// Load N₀ beside the measured one: friction that does not depend on the load.
    LoadOffset,
    /// Shares κᵢ of the channels that were measured beside the force.
    Channels,
    /// Delay τ of the force behind the motion, of either sign.
    Delay,
}

impl Term {
    /// All terms, in the order of their words in the name of a candidate.
    pub(crate) const ALL: [Self; 21] = [
        Self::LinearDamping,
        Self::QuadraticDamping,
        Self::CubicDamping,
        Self::PowerDamping,
        Self::PowerExponent,
        Self::CubicSpring,
        Self::QuinticSpring,
        Self::Stop,
        Self::StopRatio,
        Self::Gap,
        Self::Change,
        Self::CurvedChange,
        Self::Zero,
        Self::Inertia,
        Self::Stiffness,
        Self::Gravity,
        Self::GravityCosine,
        Self::Asymmetry,
        Self::LoadOffset,
        Self::Channels,
        Self::Delay,
    ];

    /// The word by which a candidate has it, after a plus sign; `None` for the second number of a term.
    pub(crate) const fn name(self) -> Option<&'static str> {
        match self {
            Self::LinearDamping => Some("linear"),
            Self::QuadraticDamping => Some("quadratic"),
            Self::CubicDamping => Some("cubic"),
            Self::PowerDamping => Some("power"),
            Self::CubicSpring => Some("cubic spring"),
            Self::QuinticSpring => Some("quintic spring"),
            Self::Stop => Some("stop"),
            Self::Gap => Some("gap"),
            Self::Change => Some("change"),
            Self::CurvedChange => Some("curved change"),
            Self::Zero => Some("zero"),
            Self::Inertia => Some("inertia"),
            Self::Stiffness => Some("stiffness"),
            Self::Gravity => Some("gravity"),
            Self::Asymmetry => Some("asymmetry"),
            Self::LoadOffset => Some("load offset"),
            Self::Channels => Some("channels"),
            Self::Delay => Some("delay"),
            Self::PowerExponent | Self::StopRatio | Self::GravityCosine => None,
        }
    }

    /// The words there are.
    pub(crate) fn names() -> impl Iterator<Item = &'static str> {
        Self::ALL.into_iter().filter_map(Self::name)
    }

    /// The term of this name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|term| term.name() == Some(name))
    }

    /// The second number of this term, if it has one.
    const fn second(self) -> Option<Self> {
        match self {
            Self::PowerDamping => Some(Self::PowerExponent),
            Self::Stop => Some(Self::StopRatio),
            Self::Gravity => Some(Self::GravityCosine),
            Self::CurvedChange => Some(Self::Change),
            _ => None,
        }
    }

    /// True for a part of the restoring force.
    pub(crate) const fn is_spring(self) -> bool {
        matches!(self, Self::CubicSpring | Self::QuinticSpring | Self::Stop | Self::StopRatio | Self::Gap)
    }

    /// True for damping.
    pub(crate) const fn is_damping(self) -> bool {
        use Term::{CubicDamping, LinearDamping, PowerDamping, PowerExponent, QuadraticDamping};
        matches!(self, LinearDamping | QuadraticDamping | CubicDamping | PowerDamping | PowerExponent)
    }

    /// True for a term that a force along a motion has, and no vibration.
    const fn is_of_forces_alone(self) -> bool {
        !self.is_damping() && !self.is_spring() && !matches!(self, Self::Change | Self::CurvedChange)
    }

    /// The power of the gain of a record to which its parameter is proportional; `exponent` is that of a power-law
    /// damping.
    pub(crate) const fn power_of_gain(self, exponent: f64) -> f64 {
        match self {
            Self::Stop | Self::Gap => 1.0,
            Self::QuadraticDamping => -1.0,
            Self::CubicDamping | Self::CubicSpring => -2.0,
            Self::QuinticSpring => -4.0,
            Self::PowerDamping => 1.0 - exponent,
            _ => 0.0,
        }
    }

    /// The stiffness that a term of the spring adds, k k₃/m or k k₅/m, for positions in units of `position`; `None` for
    /// other terms.
    pub(crate) fn stiffness_per_mass(self, position: &Unit) -> Option<Parameter> {
        let (name, symbol, power) = match self {
            Self::CubicSpring => ("cubic_stiffness_per_mass", "k k₃/m", 2),
            Self::QuinticSpring => ("quintic_stiffness_per_mass", "k k₅/m", 4),
            _ => return None,
        };
        Some(Parameter::named(name, symbol, Unit::of("1/s²").per(&position.power(power)).to_string()))
    }

    /// Its parameter in a vibration with positions in units of `position`, damping within the bounds `damping`; `None`
    /// for a term that a vibration does not have.
    fn parameter(self, position: &Unit, damping: Bounds) -> Option<Parameter> {
        let second = Unit::of("s");
        let (name, symbol, unit, bounds) = match self {
            Self::LinearDamping => (LINEAR, "c/m", Unit::of("1/s"), damping),
            Self::QuadraticDamping => (QUADRATIC, "c₂/m", position.power(-1), damping),
            Self::CubicDamping => ("cubic_damping_per_mass", "c₃/m", second.per(&position.power(2)), damping),
            Self::PowerDamping => {
                let per_power = Unit::of("(s/m)^p").with("m", position);
                let unit = position.per(&second.power(2)).times(&per_power);
                ("power_damping_per_mass", "c_p/m", unit, damping)
            }
            Self::PowerExponent => ("power_damping_exponent", "p", Unit::default(), POWERS),
            Self::CubicSpring => ("cubic_spring", "k₃", position.power(-2), Bounds::UNBOUNDED),
            Self::QuinticSpring => ("quintic_spring", "k₅", position.power(-4), Bounds::UNBOUNDED),
            Self::Stop => ("stop_distance", "g", position.clone(), Bounds::POSITIVE),
            Self::StopRatio => ("stop_stiffness_ratio", "b", Unit::default(), Bounds::NOT_NEGATIVE),
            Self::Gap => ("gap", "g", position.clone(), Bounds::NOT_NEGATIVE),
            Self::Change => (CHANGE, "w", Unit::of("1/s"), Bounds::UNBOUNDED),
            Self::CurvedChange => ("friction_change_curvature", "q", Unit::of("1/s²"), Bounds::UNBOUNDED),
            _ => return None,
        };
        Some(Parameter::named(name, symbol, unit.to_string()).bounded(bounds))
    }

    /// Its parameter in a force along a motion in these units, damping within the bounds `damping`; `None` for a term
    /// whose parameters depend on the records, and for one that such a force does not have.
    pub(crate) fn force_parameter(self, units: &Units, damping: Bounds) -> Option<Parameter> {
        let Units { position, force } = units;
        let per_speed = |power| (force.per(&units.velocity().power(power)), damping);
        let of_force = || (force.clone(), Bounds::UNBOUNDED);
        let (name, symbol, (unit, bounds)) = match self {
            Self::LinearDamping => ("damping", "c", per_speed(1)),
            Self::QuadraticDamping => ("quadratic_damping", "c₂", per_speed(2)),
            Self::CubicDamping => ("cubic_damping", "c₃", per_speed(3)),
            Self::Zero => ("zero", "F₀", of_force()),
            Self::Inertia => {
                // An angle is a number here: a torque by an angular acceleration is kg m².
                let force = force.with("N", &Unit::of("kg m/s²"));
                let unit = force.per(&units.acceleration()).with("rad", &Unit::default());
                ("inertia", "m", (unit, Bounds::UNBOUNDED))
            }
            Self::Stiffness => ("stiffness", "k", (force.per(position), Bounds::UNBOUNDED)),
            Self::Gravity => ("gravity_sine", "A", of_force()),
            Self::GravityCosine => ("gravity_cosine", "B", of_force()),
            Self::Asymmetry => ("asymmetry", "a", (Unit::default(), Bounds::UNBOUNDED.at_least(-1.0).at_most(1.0))),
            Self::LoadOffset => ("load_offset", "N₀", (Unit::of("N"), Bounds::UNBOUNDED)),
            _ => return None,
        };
        Some(Parameter::named(name, symbol, unit.to_string()).bounded(bounds))
    }
}

/// Name of the quadratic damping among the parameters.
pub(crate) const QUADRATIC: &str = "quadratic_damping_per_mass";

/// Name of the change of the friction during the record among the parameters.
pub(crate) const CHANGE: &str = "friction_change";

/// Name of the same for each half cycle among the findings.
pub(crate) const CHANGE_PER_HALF_CYCLE: &str = "friction_change_per_half_cycle";

/// Exponents of a power-law damping. What grows more slowly than the speed is friction, of which there is a law
/// `power_law`.
const POWERS: Bounds = Bounds::UNBOUNDED.at_least(1.0).at_most(5.0);

impl Terms {
    /// No term but the law, and nothing fixed.
    pub(crate) const NONE: Self =
        Self { has: [false; Term::ALL.len()], any_sign: false, longest_delay: None, held: Vec::new() };

    /// The same with `term`.
    pub(crate) fn with(mut self, term: Term) -> Self {
        self.has[term as usize] = true;
        if let Some(second) = term.second() {
            self.has[second as usize] = true;
        }
        self
    }

    /// The same with a linear damping of the machine, c/m, not negative. Not for laws that have a viscous part.
    #[must_use]
    pub fn with_linear_damping(self) -> Self {
        self.with(Term::LinearDamping)
    }

    /// The same with a quadratic damping of the machine, such as the drag of air, not negative.
    #[must_use]
    pub fn with_quadratic_damping(self) -> Self {
        self.with(Term::QuadraticDamping)
    }

    /// The same with a damping that grows with the cube of the velocity, not negative.
    #[must_use]
    pub fn with_cubic_damping(self) -> Self {
        self.with(Term::CubicDamping)
    }

    /// The same with a damping that grows with a power of the velocity between 1 and 5, not negative.
    #[must_use]
    pub fn with_power_damping(self) -> Self {
        self.with(Term::PowerDamping)
    }

    /// The same with a stop on both sides, at a distance and of a stiffness that are fitted
    /// ([`Restoring::stop`](fmm_model::Restoring::stop)); a preloaded joint that opens is one that is softer beyond.
    #[must_use]
    pub fn with_stop(self) -> Self {
        self.with(Term::Stop)
    }

    /// The same with backlash: no restoring force within a gap about the rest position
    /// ([`Restoring::gap`](fmm_model::Restoring::gap)).
    #[must_use]
    pub fn with_gap(self) -> Self {
        self.with(Term::Gap)
    }

    /// The same with a spring that hardens or softens, F = k (x + k₃ x³)
    /// ([`Restoring::Polynomial`](fmm_model::Restoring)).
    #[must_use]
    pub fn with_cubic_spring(self) -> Self {
        self.with(Term::CubicSpring)
    }

    /// The same with a term k₅ x⁵ in the spring.
    #[must_use]
    pub fn with_quintic_spring(self) -> Self {
        self.with(Term::QuinticSpring)
    }

    /// The same with friction that changes during the record:
    ///
    /// ```text
    /// N exp(w τ) / ⟨exp(w τ)⟩ in the place of N,     τ = t − ⟨t⟩
    /// ```
    ///
    /// with ⟨ ⟩ the mean over the path slid, so that the levels are those in that mean. It changes all that the law
    /// gives; a viscous part that shall stay is a linear damping beside the law. For laws of the sliding speed.
    #[must_use]
    pub fn with_change(self) -> Self {
        self.with(Term::Change)
    }

    /// The same with friction that changes by w τ + q τ² in the exponent: such as while a contact warms.
    #[must_use]
    pub fn with_curved_change(self) -> Self {
        self.with(Term::CurvedChange)
    }

    /// The same with damping that may come out negative. A negative damper is no damper; it says that the law lacks
    /// friction that falls with speed.
    #[must_use]
    pub fn with_damping_of_any_sign(self) -> Self {
        Self { any_sign: true, ..self }
    }

    /// The same with a delay of a force behind its motion of at most `longest` (s), positive or negative.
    pub(crate) fn with_delay_up_to(self, longest: f64) -> Self {
        Self { longest_delay: Some(longest), ..self.with(Term::Delay) }
    }

    /// Refuses a term that a vibration does not have.
    ///
    /// # Errors
    /// [`IdentifyError::Contradiction`].
    pub(crate) fn require_vibration(&self) -> Result<(), IdentifyError> {
        match self.iter().filter(|term| term.is_of_forces_alone()).find_map(Term::name) {
            None => Ok(()),
            Some(name) => Err(IdentifyError::contradiction(format!(
                "{name} is a term of a force along a motion; leave it out of a law of vibrations"
            ))),
        }
    }

    /// Refuses a term that a force along a motion does not have.
    ///
    /// # Errors
    /// [`IdentifyError::Contradiction`].
    pub(crate) fn require_force(&self) -> Result<(), IdentifyError> {
        if self.has_spring() {
            return Err(IdentifyError::contradiction(
                "a spring that is not linear is a term of free vibrations; a force along a motion takes the term stiffness",
            ));
        }
        if self.has(Term::Change) {
            return Err(IdentifyError::contradiction(
                "a friction that changes during the record is a term of vibrations; cut a force along a motion into parts",
            ));
        }
        if self.has(Term::PowerDamping) {
            return Err(IdentifyError::contradiction(
                "damping with a free power is a term of free vibrations; a force along a motion takes the law power_law",
            ));
        }
        Ok(())
    }

    /// The same with the fitted parameter called `name` fixed at `value`, in the unit in which it would be fitted.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] if the value is not finite. A name that no parameter has is refused by the fit.
    pub fn holding(mut self, name: impl Into<String>, value: f64) -> Result<Self, ModelError> {
        let value = ModelError::require_finite("held value", value, "(in the unit of its parameter)")?;
        self.held.push((name.into(), value));
        Ok(self)
    }

    /// No term is fitted, and nothing is fixed.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::NONE
    }

    /// The terms that are fitted, in the order of their parameters.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Term> + '_ {
        Term::ALL.into_iter().filter(|term| self.has(*term))
    }

    /// True if `term` is fitted.
    pub(crate) const fn has(&self, term: Term) -> bool {
        self.has[term as usize]
    }

    /// The place of `term` among those that are fitted; `None` if it is not.
    pub(crate) fn place(&self, term: Term) -> Option<usize> {
        self.iter().position(|fitted| fitted == term)
    }

    /// The terms that are no friction over the speed, the spring and a change during the record, without fixed
    /// parameters.
    pub(crate) fn beside_friction(&self) -> Self {
        let is_beside = |term: &Term| term.is_spring() || matches!(term, Term::Change | Term::CurvedChange);
        self.iter().filter(is_beside).fold(Self::NONE, Self::with)
    }

    /// True if a term of the spring is fitted.
    pub(crate) fn has_spring(&self) -> bool {
        self.iter().any(Term::is_spring)
    }

    /// The restoring force that the terms of the spring make of the one that is `known`, by their values.
    ///
    /// # Errors
    /// [`ModelError`] for a value that cannot be.
    pub(crate) fn spring<D: Scalar>(
        &self,
        known: Restoring,
        value: impl Fn(Term) -> Option<D>,
    ) -> Result<Restoring<D>, ModelError> {
        let added = |term: Term, known: f64| value(term).map_or(D::from(known), |fitted| fitted + known);
        let polynomial = |cubic: f64, quintic: f64| {
            Restoring::polynomial(added(Term::CubicSpring, cubic), added(Term::QuinticSpring, quintic))
        };
        match (known, value(Term::Stop), value(Term::StopRatio), value(Term::Gap)) {
            (Restoring::Linear, Some(distance), Some(ratio), _) => Restoring::stop(distance, ratio),
            (Restoring::Linear, _, _, Some(gap)) => Restoring::gap(gap),
            (Restoring::Polynomial { cubic, quintic }, ..) => polynomial(cubic, quintic),
            (Restoring::Linear, ..) if self.has_spring() => polynomial(0.0, 0.0),
            (known, ..) => Ok(known.map(D::from)),
        }
    }

    /// Why the terms of the spring do not go together, or not with the restoring force that is `known`; `None` if they
    /// do.
    pub(crate) fn spring_contradiction(&self, known: Restoring) -> Option<&'static str> {
        let is_bent = self.has(Term::CubicSpring) || self.has(Term::QuinticSpring);
        let kinds = [is_bent, self.has(Term::Stop), self.has(Term::Gap)].into_iter().filter(|has| *has).count();
        match known {
            Restoring::Sine { .. } if kinds > 0 => Some(
                "a pendulum has the sine for its restoring force; leave out the pendulum, or the terms of the spring",
            ),
            Restoring::Polynomial { .. } if self.has(Term::Stop) || self.has(Term::Gap) => {
                Some("the machine has a spring that hardens or softens; leave it out, or the stop or the gap")
            }
            Restoring::Bilinear { .. } if kinds > 0 => {
                Some("the machine has a spring with a stop or a gap; leave it out, or the terms of the spring")
            }
            _ if kinds > 1 => Some("a spring bends, has a stop or has a gap: fit one of these at a time"),
            _ => None,
        }
    }

    /// True if a linear damping is fitted.
    pub const fn has_linear_damping(&self) -> bool {
        self.has(Term::LinearDamping)
    }

    /// Names and values of the parameters that are held.
    pub fn held(&self) -> impl Iterator<Item = (&str, f64)> {
        self.held.iter().map(|(name, value)| (name.as_str(), *value))
    }

    /// Bounds of the damping.
    pub(crate) const fn damping_bounds(&self) -> Bounds {
        if self.any_sign { Bounds::UNBOUNDED } else { Bounds::NOT_NEGATIVE }
    }

    /// The parameters of the terms of a vibration, for positions in units of `position`.
    pub(crate) fn parameters(&self, position: &Unit) -> impl Iterator<Item = Parameter> {
        self.iter().filter_map(move |term| term.parameter(position, self.damping_bounds()))
    }

    /// The name of `law` with these terms.
    pub(crate) fn name(&self, law: &str) -> String {
        let (of_forces, of_all): (Vec<Term>, Vec<Term>) = self.iter().partition(|term| term.is_of_forces_alone());
        let words = |terms: &[Term]| -> String {
            terms.iter().filter_map(|term| term.name()).flat_map(|word| [" + ", word]).collect()
        };
        let any_sign = self.any_sign && of_all.iter().any(|term| term.is_damping());
        let any_sign = if any_sign { " of any sign" } else { "" };
        let mut name = format!("{law}{}{any_sign}{}", words(&of_all), words(&of_forces));
        for (index, (held, value)) in self.held.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(name, "{} {held} = {value}", if index == 0 { "," } else { " and" });
        }
        name
    }
}
