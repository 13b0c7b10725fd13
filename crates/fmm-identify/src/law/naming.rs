//! Name, symbol and unit of a parameter of a law wherever it is stated: in a fit, among the findings, in a report.

use fmm_friction::{LawParameter, Role};
use fmm_model::{Parameter, Unit};
use fmm_record::{Quantity, Record};

use crate::law::dimension::{is_coefficient, is_force};

/// Name of the linear damping per mass, of the machine or of a law.
pub(crate) const LINEAR: &str = "damping_per_mass";

/// Kind of quantity in which the level of a law is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Level {
    /// A coefficient, where the load is part of the fit.
    Coefficient,
    /// A coefficient, from a force and a load.
    Mu,
    /// A force.
    Force,
    /// A force per mass.
    PerMass,
}

impl Level {
    /// Word in place of `coefficient` in the name of a level.
    const fn word(self) -> &'static str {
        match self {
            Self::Coefficient => "coefficient",
            Self::Mu => "mu",
            Self::Force => "friction_force",
            Self::PerMass => "friction_per_mass",
        }
    }
}

/// Name of a level of a law as `level`: `static_coefficient` is `static_friction_force` as a force.
pub(crate) fn level_name(name: &str, level: Level) -> String {
    let before = name.strip_suffix("coefficient").map_or_else(|| format!("{name}_"), str::to_owned);
    before + level.word()
}

/// Units of the motion in a record, and of forces.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Units {
    pub(crate) position: Unit,
    pub(crate) force: Unit,
}

impl Units {
    /// Of a motion with positions in `position` and forces in `force`.
    pub(crate) fn new(position: &str, force: &str) -> Self {
        Self { position: Unit::of(position), force: Unit::of(force) }
    }

    /// Those that belong to the unit of a `record`; forces are in N.
    pub(crate) fn of(record: &Record) -> Self {
        let orders = match record.quantity() {
            Quantity::Displacement => 0,
            Quantity::Acceleration => 2,
            _ => 1,
        };
        let position = Unit::of(record.unit()).times(&Unit::of("s").power(orders));
        Self { position, force: Unit::of("N") }
    }

    /// Unit of a velocity.
    pub(crate) fn velocity(&self) -> Unit {
        self.position.per(&Unit::of("s"))
    }

    /// Unit of an acceleration, which is a force per mass.
    pub(crate) fn acceleration(&self) -> Unit {
        self.velocity().per(&Unit::of("s"))
    }

    /// True if positions are in m.
    pub(crate) fn is_metric(&self) -> bool {
        self.position == Unit::of("m")
    }

    /// Unit of a level as `level`.
    fn of_level(&self, level: Level) -> Unit {
        match level {
            Level::Coefficient | Level::Mu => Unit::default(),
            Level::Force => self.force.clone(),
            Level::PerMass => self.acceleration(),
        }
    }

    /// A parameter of a law with its levels as `level`, and the lengths of the record in place of m.
    pub(crate) fn stated(&self, law_parameter: &LawParameter, level: Level) -> Parameter {
        let (parameter, role) = (law_parameter.parameter(), law_parameter.role());
        let own = Unit::of(parameter.unit()).with("m", &self.position);
        let as_force = || self.of_level(level).times(&own);
        let (plain, symbol) = (parameter.name(), parameter.symbol());
        let (name, symbol, unit) = match (role, level) {
            (Role::Slope, Level::Force) => ("damping".to_owned(), "c", as_force()),
            (Role::Slope, Level::PerMass) => (LINEAR.to_owned(), "c/m", as_force()),
            _ if is_coefficient(law_parameter) => {
                let symbol = match level {
                    Level::Force if plain == "coefficient" => "F",
                    Level::PerMass if plain == "coefficient" => "F/m",
                    _ => symbol,
                };
                (level_name(plain, level), symbol, as_force())
            }
            _ if is_force(role) => {
                let per_mass = if level == Level::PerMass { "_per_mass" } else { "" };
                (format!("contact_{plain}{per_mass}"), symbol, as_force())
            }
            _ => (plain.to_owned(), symbol, own),
        };
        Parameter::named(name, symbol.to_owned(), unit.to_string()).bounded(parameter.bounds())
    }

    /// The same as a fit has it: a level that may not lie below the sliding one as what it lies above it by.
    pub(crate) fn fitted(&self, law_parameter: &LawParameter, level: Level) -> Parameter {
        let stated = self.stated(law_parameter, level);
        match law_parameter.role() {
            Role::LevelAbove | Role::Breakaway => {
                let excess = law_parameter.parameter().name().replace("coefficient", "excess_coefficient");
                let (name, symbol) = (level_name(&excess, level), stated.symbol().to_owned());
                Parameter::named(name, symbol, stated.unit().to_owned()).bounded(stated.bounds())
            }
            _ => stated,
        }
    }
}

#[cfg(test)]
mod tests {
    use fmm_friction::{Berger, LawFamily, LuGre};

    use super::*;

    fn texts(parameters: &[LawParameter], of: impl Fn(&LawParameter) -> Parameter) -> Vec<String> {
        parameters.iter().map(|parameter| of(parameter).to_string()).collect()
    }

    #[test]
    fn names_and_units_follow_from_role_and_record() {
        let metric = Units::new("m", "N");
        assert_eq!(
            texts(Berger::PARAMETERS, |parameter| metric.fitted(parameter, Level::PerMass)),
            ["friction_per_mass F/m (m/s²)", "excess_friction_per_mass μ₁ (m/s²)", "decay α (s/m)"]
        );
        let joint = Units::new("rad", "N m");
        assert_eq!(
            texts(LuGre::PARAMETERS, |parameter| joint.fitted(parameter, Level::Force))[..7],
            [
                "sliding_friction_force μ_c (N m)",
                "static_excess_friction_force μ_s (N m)",
                "stribeck_speed v_s (rad/s)",
                "exponent δ (1)",
                "contact_stiffness σ₀ (N m/rad)",
                "contact_bristle_damping σ₁ (N m s/rad)",
                "damping c (N m s/rad)",
            ]
        );
        let volts = Units::of(&Record::new(0.0, 1.0, vec![0.0; 3], Quantity::Velocity, "V").unwrap());
        assert_eq!((volts.position.to_string(), volts.acceleration().to_string()), ("V s".into(), "V/s".into()));
        assert_eq!(texts(Berger::PARAMETERS, |parameter| volts.stated(parameter, Level::PerMass))[2], "decay α (1/V)");
    }
}
