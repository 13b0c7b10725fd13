//! Terms of the machine that are fitted beside the law, and parameters that are held.

use std::fmt::Write as _;

use fmm_model::{Bounds, ModelError, Parameter, Unit};

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
    CubicSpring,
    QuinticSpring,
}

impl Term {
    /// All terms, in the order of their parameters.
    pub(crate) const ALL: [Self; 5] =
        [Self::LinearDamping, Self::QuadraticDamping, Self::CubicDamping, Self::CubicSpring, Self::QuinticSpring];

    /// The word by which a candidate has it, after a plus sign.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::LinearDamping => "linear",
            Self::QuadraticDamping => "quadratic",
            Self::CubicDamping => "cubic",
            Self::CubicSpring => "cubic spring",
            Self::QuinticSpring => "quintic spring",
        }
    }

    /// The term of this name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|term| term.name() == name)
    }

    /// Whether it is part of the restoring force.
    pub(crate) const fn is_spring(self) -> bool {
        matches!(self, Self::CubicSpring | Self::QuinticSpring)
    }

    /// The power of the gain of a record to which its parameter is proportional.
    pub(crate) const fn power_of_gain(self) -> f64 {
        match self {
            Self::LinearDamping => 0.0,
            Self::QuadraticDamping => -1.0,
            Self::CubicDamping | Self::CubicSpring => -2.0,
            Self::QuinticSpring => -4.0,
        }
    }

    /// The stiffness that a term of the spring adds, k k₃/m or k k₅/m, for positions in units of `position`.
    pub(crate) fn stiffness_per_mass(self, position: &Unit) -> Parameter {
        let (name, symbol, power) = match self {
            Self::QuinticSpring => ("quintic_stiffness_per_mass", "k k₅/m", 4),
            _ => ("cubic_stiffness_per_mass", "k k₃/m", 2),
        };
        Parameter::named(name, symbol, Unit::of("1/s²").per(&position.power(power)).to_string())
    }

    /// Its parameter, for positions in units of `position`.
    fn parameter(self, position: &Unit) -> Parameter {
        let (name, symbol, unit) = match self {
            Self::LinearDamping => (LINEAR, "c/m", Unit::of("1/s")),
            Self::QuadraticDamping => (QUADRATIC, "c₂/m", position.power(-1)),
            Self::CubicDamping => ("cubic_damping_per_mass", "c₃/m", Unit::of("s").per(&position.power(2))),
            Self::CubicSpring => ("cubic_spring", "k₃", position.power(-2)),
            Self::QuinticSpring => ("quintic_spring", "k₅", position.power(-4)),
        };
        Parameter::named(name, symbol, unit.to_string())
    }
}

/// Name of the linear damping among the parameters, of the machine or of the law: a record determines their sum only.
pub(crate) const LINEAR: &str = "damping_per_mass";
/// Name of the quadratic damping among the parameters.
pub(crate) const QUADRATIC: &str = "quadratic_damping_per_mass";

impl Terms {
    /// No term but the law, and nothing held.
    pub(crate) const NONE: Self = Self { has: [false; Term::ALL.len()], any_sign: false, held: Vec::new() };

    /// The same with `term`.
    pub(crate) fn with(mut self, term: Term) -> Self {
        self.has[term as usize] = true;
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

    /// The same with a spring that hardens or softens, F = k (x + k₃ x³) ([`Restoring::Polynomial`](fmm_model::Restoring)).
    #[must_use]
    pub fn with_cubic_spring(self) -> Self {
        self.with(Term::CubicSpring)
    }

    /// The same with a term k₅ x⁵ in the spring.
    #[must_use]
    pub fn with_quintic_spring(self) -> Self {
        self.with(Term::QuinticSpring)
    }

    /// The same with damping that may come out negative. A negative damper is no damper; it says that the law lacks friction that
    /// falls with speed.
    #[must_use]
    pub fn with_damping_of_any_sign(self) -> Self {
        Self { any_sign: true, ..self }
    }

    /// The same with the fitted parameter called `name` held at `value`, in the unit in which it would be fitted.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] if the value is not finite. Whether there is such a parameter shows when the law is known.
    pub fn holding(mut self, name: impl Into<String>, value: f64) -> Result<Self, ModelError> {
        let value = ModelError::require_finite("held value", value, "(in the unit of its parameter)")?;
        self.held.push((name.into(), value));
        Ok(self)
    }

    /// Whether there is none, and nothing is held.
    pub(crate) fn is_plain(&self) -> bool {
        *self == Self::NONE
    }

    /// The terms that are fitted, in the order of their parameters.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Term> + '_ {
        Term::ALL.into_iter().filter(|term| self.has(*term))
    }

    /// Whether `term` is fitted.
    pub(crate) const fn has(&self, term: Term) -> bool {
        self.has[term as usize]
    }

    /// The place of `term` among those that are fitted; `None` if it is not.
    pub(crate) fn place(&self, term: Term) -> Option<usize> {
        self.iter().position(|fitted| fitted == term)
    }

    /// Whether the spring is fitted as one that hardens or softens.
    pub(crate) fn has_spring(&self) -> bool {
        self.iter().any(Term::is_spring)
    }

    /// Whether damping may come out negative.
    pub(crate) const fn are_of_any_sign(&self) -> bool {
        self.any_sign
    }

    /// Whether a linear damping of the machine is fitted.
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
        let bounds = move |term: Term| if term.is_spring() { Bounds::UNBOUNDED } else { damping };
        self.iter().map(move |term| term.parameter(position).bounded(bounds(term)))
    }

    /// The name of `law` with these terms.
    pub(crate) fn name(&self, law: &str) -> String {
        let mut name = law.to_owned();
        for term in self.iter() {
            name.push_str(" + ");
            name.push_str(term.name());
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
