//! What the parameters of a law scale with.

use fmm_friction::{LawParameter, Role};
use fmm_model::Dimension;

use crate::IdentifyError;
use crate::law::Law;

/// The scales of the motion in a record, in its units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scales {
    /// Largest displacement.
    pub(crate) length: f64,
    /// Largest velocity.
    pub(crate) speed: f64,
    /// F/m of Coulomb friction with the same losses.
    pub(crate) friction: f64,
    /// c/m of the viscous part (1/s).
    pub(crate) damping: f64,
    /// What divides speeds and lengths at which laws bend, to begin a fit in another place.
    pub(crate) sharpness: f64,
}

/// What the value of a parameter of a law scales with beside a force, as powers of position and time. Angles are positions, and a power
/// that is itself a parameter of the law has its typical value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Powers {
    position: f64,
    time: f64,
    /// How much of the SI unit the unit of the parameter is (1).
    factor: f64,
}

impl Powers {
    /// Of the unit in which `law` states `parameter`; none for one of which it is not known what it scales with.
    fn of(law: &Law, parameter: &LawParameter) -> Option<Self> {
        let exponent = |symbol: &str| {
            let named = |parameter: &&LawParameter| parameter.parameter().symbol() == symbol;
            law.parameters.iter().find(named).map(LawParameter::typical)
        };
        let unit = Dimension::of(parameter.parameter().unit(), exponent).filter(|unit| unit.mass() == 0.0)?;
        Some(Self { position: unit.length() + unit.angle(), time: unit.time(), factor: unit.factor() })
    }

    /// The power of a speed that it is; none if it is none.
    pub(crate) fn of_speed(&self) -> Option<f64> {
        (self.position != 0.0 && self.time == -self.position).then_some(self.position)
    }

    /// The value of the parameter that stands for a `speed`.
    pub(crate) fn at_speed(&self, speed: f64) -> f64 {
        speed.powf(self.position) / self.factor
    }
}

impl Law {
    /// What a parameter of this law scales with; a law with a unit that is not known is refused before.
    pub(crate) fn powers(&self, parameter: &LawParameter) -> Powers {
        Powers::of(self, parameter).unwrap_or(Powers { position: 0.0, time: 0.0, factor: 1.0 })
    }

    /// Refuses a law with a parameter in a unit of which it is not known what it scales with.
    pub(crate) fn require_units(&self) -> Result<(), IdentifyError> {
        let unknown = self.parameters.iter().find(|parameter| Powers::of(self, parameter).is_none());
        unknown.map_or(Ok(()), |parameter| {
            let (law, parameter) = (self.name, parameter.parameter());
            Err(IdentifyError::UnknownName {
                what: format!(
                    "{law} states {} in {}, and a fit does not know where to begin: a unit is made of m, s, rad and deg, with \
                     prefixes and powers",
                    parameter.name(),
                    parameter.unit()
                ),
            })
        })
    }

    /// Whether `parameter` says where the law bends, which a fit may have to look for.
    pub(crate) fn bends(&self, parameter: &LawParameter) -> bool {
        let Powers { position, time, .. } = self.powers(parameter);
        parameter.role() != Role::Slope && (position, time) != (0.0, 0.0)
    }

    /// The power of a record's gain to which `parameter` is proportional.
    pub(crate) fn power_of_gain(&self, parameter: &LawParameter) -> f64 {
        let force = if is_force(parameter.role()) || parameter.role() == Role::Slope { 1.0 } else { 0.0 };
        force + self.powers(parameter).position
    }
}

impl Scales {
    /// Where a fit of a `parameter` of `law` may begin.
    pub(crate) fn typical(&self, law: &Law, parameter: &LawParameter) -> f64 {
        let Powers { position, time, factor } = law.powers(parameter);
        if parameter.role() == Role::Slope {
            return self.damping / factor;
        }
        let force = if is_force(parameter.role()) { self.friction } else { 1.0 };
        let scale = force * self.length.powf(position + time) * self.speed.powf(-time);
        parameter.typical() * scale * self.sharpness.powf(-position) / factor
    }
}

/// Whether `role` is proportional to the friction force.
pub(crate) fn is_force(role: Role) -> bool {
    matches!(role, Role::Level | Role::Excess | Role::LevelAbove | Role::Breakaway)
}
