//! Terms of the machine that are fitted beside the law, and parameters that are held.

use std::fmt::Write as _;

use crate::law::naming::LINEAR;
use fmm_model::{Bounds, ModelError, Parameter, Restoring, Scalar, Unit};

/// Damping and spring terms of the machine that are fitted beside the law, and parameters that are held.
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
    held: Vec<(String, f64)>,
}

/// A term of the machine that is fitted beside the law.
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
}

impl Term {
    /// All terms, in the order of their parameters.
    pub(crate) const ALL: [Self; 10] = [
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
            Self::PowerExponent | Self::StopRatio => None,
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
            _ => None,
        }
    }

    /// True if it is part of the restoring force.
    pub(crate) const fn is_spring(self) -> bool {
        matches!(self, Self::CubicSpring | Self::QuinticSpring | Self::Stop | Self::StopRatio | Self::Gap)
    }

    /// The power of the gain of a record to which its parameter is proportional; `exponent` is that of a power-law
    /// damping.
    pub(crate) const fn power_of_gain(self, exponent: f64) -> f64 {
        match self {
            Self::LinearDamping | Self::PowerExponent | Self::StopRatio => 0.0,
            Self::Stop | Self::Gap => 1.0,
            Self::QuadraticDamping => -1.0,
            Self::CubicDamping | Self::CubicSpring => -2.0,
            Self::QuinticSpring => -4.0,
            Self::PowerDamping => 1.0 - exponent,
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

    /// Its parameter, for positions in units of `position`; damping within the bounds `damping`.
    fn parameter(self, position: &Unit, damping: Bounds) -> Parameter {
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
        };
        Parameter::named(name, symbol, unit.to_string()).bounded(bounds)
    }
}

/// Name of the quadratic damping among the parameters.
pub(crate) const QUADRATIC: &str = "quadratic_damping_per_mass";

/// Exponents of a power-law damping. What grows more slowly than the speed is friction, of which there is a law
/// `power_law`.
const POWERS: Bounds = Bounds::UNBOUNDED.at_least(1.0).at_most(5.0);

impl Terms {
    /// No term but the law, and nothing held.
    pub(crate) const NONE: Self = Self { has: [false; Term::ALL.len()], any_sign: false, held: Vec::new() };

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

    /// The same with damping that may come out negative. A negative damper is no damper; it says that the law lacks
    /// friction that falls with speed.
    #[must_use]
    pub fn with_damping_of_any_sign(self) -> Self {
        Self { any_sign: true, ..self }
    }

    /// The same with the fitted parameter called `name` held at `value`, in the unit in which it would be fitted.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] if the value is not finite. Whether there is such a parameter shows when the law is
    /// known.
    pub fn holding(mut self, name: impl Into<String>, value: f64) -> Result<Self, ModelError> {
        let value = ModelError::require_finite("held value", value, "(in the unit of its parameter)")?;
        self.held.push((name.into(), value));
        Ok(self)
    }

    /// No term is fitted, and nothing is held.
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

    /// True if the spring is fitted as one that hardens or softens.
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

    /// True if damping may come out negative.
    pub(crate) const fn are_of_any_sign(&self) -> bool {
        self.any_sign
    }

    /// True if a linear damping of the machine is fitted.
    pub const fn has_linear_damping(&self) -> bool {
        self.has(Term::LinearDamping)
    }

    /// Names and values of the parameters that are held.
    pub fn held(&self) -> impl Iterator<Item = (&str, f64)> {
        self.held.iter().map(|(name, value)| (name.as_str(), *value))
    }

    /// The parameters of the terms, for positions in units of `position`.
    pub(crate) fn parameters(&self, position: &Unit) -> impl Iterator<Item = Parameter> {
        let damping = if self.any_sign { Bounds::UNBOUNDED } else { Bounds::NOT_NEGATIVE };
        self.iter().map(move |term| term.parameter(position, damping))
    }

    /// The name of `law` with these terms.
    pub(crate) fn name(&self, law: &str) -> String {
        let mut name = law.to_owned();
        for term in self.iter().filter_map(Term::name) {
            name.push_str(" + ");
            name.push_str(term);
        }
        if self.any_sign && self.iter().any(|term| !term.is_spring()) {
            name.push_str(" of any sign");
        }
        for (index, (held, value)) in self.held.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(name, "{} {held} = {value}", if index == 0 { "," } else { " and" });
        }
        name
    }
}
