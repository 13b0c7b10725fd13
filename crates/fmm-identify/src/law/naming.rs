//! Name, symbol and unit of a parameter of a law wherever it is stated: in a fit, among the findings, in a report.

use fmm_friction::{LawParameter, Role};
use fmm_model::{Parameter, Unit};
use fmm_record::{Quantity, Record};

use crate::law::dimension::{is_coefficient, is_force};

/// Name of the linear damping per mass, of the machine or of a law.
pub(crate) const LINEAR: &str = "damping_per_mass";

/// Form in which a level of a law is stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// A coefficient, where the load is part of the fit.
    Coefficient,
    /// A coefficient, from a force and a load.
    Mu,
    /// A force.
    Force,
    /// A force per mass.
    PerMass,
}

/// Name in this `form` of a level that its law calls `name`, or of the `excess` by which it lies above the sliding one.
///
/// | law | from force and load | force | per mass |
/// |---|---|---|---|
/// | `coefficient` | `mu` | `friction_force` | `friction_per_mass` |
/// | `excess_coefficient` | `excess_mu` | `excess_friction_force` | `excess_friction_per_mass` |
/// | `static_coefficient` | `static_mu` | `static_friction_force` | `static_friction_per_mass` |
/// | its excess | | `static_excess_friction_force` | `static_excess_friction_per_mass` |
pub(crate) fn level_name(name: &str, excess: bool, form: Form) -> String {
    let before = name.strip_suffix("coefficient").map_or_else(|| format!("{name}_"), str::to_owned);
    let excess = if excess { "excess_" } else { "" };
    let word = match form {
        Form::Coefficient => "coefficient",
        Form::Mu => "mu",
        Form::Force => "friction_force",
        Form::PerMass => "friction_per_mass",
    };
    format!("{before}{excess}{word}")
}

/// Units of the motion in a record, and of forces.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Units {
    pub(crate) position: Unit,
    pub(crate) force: Unit,
}

impl Units {
    /// Units of a motion with positions in `position` and forces in `force`.
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

    /// The same with the forces that a mass makes of forces per mass: N along a motion in m, by a mass in kg, and N m
    /// about an axis with angles in rad, by a moment of inertia in kg m²; `None` for other positions.
    pub(crate) fn with_forces(&self) -> Option<Self> {
        let is_angle = self.position == Unit::of("rad");
        (is_angle || self.is_metric())
            .then(|| Self { force: Unit::of(if is_angle { "N m" } else { "N" }), ..self.clone() })
    }

    /// Unit of a mass, by these forces.
    pub(crate) fn mass(&self) -> Unit {
        if self.position == Unit::of("rad") { Unit::of("kg m²") } else { Unit::of("kg") }
    }

    /// True if positions are in m.
    pub(crate) fn is_metric(&self) -> bool {
        self.position == Unit::of("m")
    }

    /// Parameter of a law as a report states it: a level in this `form`, and lengths in the unit of the record instead of m.
    pub(crate) fn stated(&self, law_parameter: &LawParameter, form: Form) -> Parameter {
        self.named(law_parameter, false, form)
    }

    /// A parameter as a fit has it: of a level that may not lie below the sliding one the excess.
    pub(crate) fn fitted(&self, law_parameter: &LawParameter, form: Form) -> Parameter {
        self.named(law_parameter, matches!(law_parameter.role(), Role::LevelAbove | Role::Breakaway), form)
    }

    fn named(&self, law_parameter: &LawParameter, excess: bool, form: Form) -> Parameter {
        let (parameter, role) = (law_parameter.parameter(), law_parameter.role());
        let own = Unit::of(parameter.unit()).with("m", &self.position);
        let as_force = || match form {
            Form::Coefficient | Form::Mu => own.clone(),
            Form::Force => self.force.times(&own),
            Form::PerMass => self.acceleration().times(&own),
        };
        let (plain, symbol) = (parameter.name(), parameter.symbol());
        let (name, symbol, unit) = match (role, form) {
            (Role::Slope, Form::Force) => ("damping".to_owned(), "c", as_force()),
            (Role::Slope, Form::PerMass) => (LINEAR.to_owned(), "c/m", as_force()),
            _ if is_coefficient(law_parameter) => {
                let symbol = match form {
                    Form::Force if plain == "coefficient" => "F",
                    Form::PerMass if plain == "coefficient" => "F/m",
                    _ => symbol,
                };
                (level_name(plain, excess, form), symbol, as_force())
            }
            _ if is_force(role) => {
                let per_mass = if form == Form::PerMass { "_per_mass" } else { "" };
                (format!("contact_{plain}{per_mass}"), symbol, as_force())
            }
            _ => (plain.to_owned(), symbol, own),
        };
        Parameter::named(name, symbol.to_owned(), unit.to_string()).bounded(parameter.bounds())
    }
}

#[cfg(test)]
mod tests {
    use fmm_friction::{Berger, FamilyVisitor, LawFamily, LuGre, catalogue};

    use super::*;

    fn texts(parameters: &[LawParameter], of: impl Fn(&LawParameter) -> Parameter) -> Vec<String> {
        parameters.iter().map(|parameter| of(parameter).to_string()).collect()
    }

    #[test]
    fn names_and_units_follow_from_role_and_record() {
        let metric = Units::new("m", "N");
        assert_eq!(
            texts(Berger::PARAMETERS, |parameter| metric.fitted(parameter, Form::PerMass)),
            ["friction_per_mass F/m (m/s²)", "excess_friction_per_mass μ₁ (m/s²)", "decay α (s/m)"]
        );
        let joint = Units::new("rad", "N m");
        assert_eq!(
            texts(LuGre::PARAMETERS, |parameter| joint.fitted(parameter, Form::Force))[..7],
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
        assert_eq!(texts(Berger::PARAMETERS, |parameter| volts.stated(parameter, Form::PerMass))[2], "decay α (1/V)");
    }

    /// Every level of the catalogue, by the name in its law, and its names as a force and per mass.
    #[test]
    fn each_level_of_the_catalogue_has_its_names() {
        struct Levels;
        impl FamilyVisitor for Levels {
            type Output = &'static [LawParameter];

            fn visit<F: LawFamily>(&mut self) -> Self::Output {
                F::PARAMETERS
            }
        }
        let listed = [
            ("coefficient", "friction_force", "friction_per_mass"),
            ("excess_coefficient", "excess_friction_force", "excess_friction_per_mass"),
            ("sliding_coefficient", "sliding_friction_force", "sliding_friction_per_mass"),
            ("static_coefficient", "static_friction_force", "static_friction_per_mass"),
            ("peak_coefficient", "peak_friction_force", "peak_friction_per_mass"),
            ("gaining_coefficient", "gaining_friction_force", "gaining_friction_per_mass"),
            ("losing_coefficient", "losing_friction_force", "losing_friction_per_mass"),
            ("difference_coefficient", "difference_friction_force", "difference_friction_per_mass"),
        ];
        let units = Units::new("m", "N");
        for parameter in catalogue(&mut Levels).into_iter().flatten().filter(|parameter| is_coefficient(parameter)) {
            let name = parameter.parameter().name();
            let [force, per_mass] = [Form::Force, Form::PerMass].map(|form| units.stated(parameter, form));
            let found = (name, force.name(), per_mass.name());
            assert!(listed.contains(&found) || name.contains("level_"), "{found:?}");
        }
    }
}
