//! Term that is fitted beside the law: its word, its parameters, the power of a gain that it follows.

use fmm_model::{Bounds, Parameter, Unit};

use crate::law::naming::{LINEAR, Units};

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
    /// Rate r at which that change slows down.
    CurvedChange,
    /// Curvature β of the friction over the position.
    Position,
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
    pub(crate) const ALL: [Self; 22] = [
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
        Self::Position,
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
            Self::Position => Some("position"),
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
    pub(super) const fn second(self) -> Option<Self> {
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
    pub(super) const fn is_of_forces_alone(self) -> bool {
        !self.is_damping() && !self.is_spring() && !matches!(self, Self::Change | Self::CurvedChange | Self::Position)
    }

    /// The power of the gain of a record to which its parameter is proportional; `exponent` is that of a power-law
    /// damping.
    pub(crate) const fn power_of_gain(self, exponent: f64) -> f64 {
        match self {
            Self::Stop | Self::Gap => 1.0,
            Self::QuadraticDamping => -1.0,
            Self::CubicDamping | Self::CubicSpring | Self::Position => -2.0,
            Self::QuinticSpring => -4.0,
            Self::PowerDamping => 1.0 - exponent,
            _ => 0.0,
        }
    }

    /// The power of a factor on all times to which its parameter is proportional, if the record is the `order`th
    /// derivative of the position; `exponent` is that of a power-law damping.
    pub(crate) fn power_of_clock(self, exponent: f64, order: f64) -> f64 {
        let of_length = order * self.power_of_gain(exponent);
        of_length
            + match self {
                Self::LinearDamping | Self::Change | Self::CurvedChange => -1.0,
                Self::CubicDamping => 1.0,
                Self::PowerDamping => exponent - 2.0,
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
    pub(super) fn parameter(self, position: &Unit, damping: Bounds) -> Option<Parameter> {
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
            Self::CurvedChange => ("friction_change_slowing", "r", Unit::of("1/s"), Bounds::UNBOUNDED),
            Self::Position => ("friction_over_position", "β", position.power(-2), Bounds::UNBOUNDED),
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

/// Name among the findings of the rise of the friction from the middle to the largest deflection, over its mean.
pub(crate) const RISE_OVER_POSITION: &str = "friction_rise_over_position";

/// Exponents of a power-law damping. What grows more slowly than the speed is friction, of which there is a law
/// `power_law`.
const POWERS: Bounds = Bounds::UNBOUNDED.at_least(1.0).at_most(5.0);
