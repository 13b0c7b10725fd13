//! Quantities that follow from the rows of a table, with their uncertainties.

use fmm_friction::Role;
use fmm_model::{Bounds, Damping, Dual, Oscillator, Parameter, Scalar};

#[cfg(feature = "sampler")]
use crate::finding::Finding;
use crate::finding::Source;
use crate::law::DIRECTIONS;
use crate::law::dimension::{is_coefficient, is_force};
use crate::law::naming::{Form, Units};
use crate::machine::term::{CHANGE_PER_HALF_CYCLE, RISE_OVER_POSITION, Term};
use crate::machine::{Machine, Scale};
use crate::quantities::rows::Place;
use crate::quantities::table::{Table, mass_of_stiffness};

/// Shared values of one fit and what is known from elsewhere, from which the derived quantities follow.
pub(crate) struct Inputs<'a> {
    pub(crate) machine: &'a Machine,
    pub(crate) shared: &'a [f64],
    pub(crate) table: &'a Table,
    /// Relative error of the gain of the instrument, as a factor (1).
    pub(crate) gain: f64,
    pub(crate) gain_uncertainty: f64,
}

/// Names of what states a linear damping once more.
pub(crate) const OF_DAMPING: [&str; 4] = ["damping_ratio", "quality_factor", "logarithmic_decrement", "time_constant"];

/// Inputs that were not fitted: scale of the machine, normal load, gain of the instrument, gain of a measured force.
pub(crate) const KNOWN: usize = 4;

impl Inputs<'_> {
    /// Standard uncertainties of the inputs that were not fitted.
    pub(crate) fn uncertainties(&self) -> [(Source, f64); KNOWN] {
        let scale = match self.machine.scale() {
            Scale::Stiffness(known) => (Source::Stiffness, known.uncertainty()),
            Scale::Mass(known) => (Source::Mass, known.uncertainty()),
            _ => (Source::Mass, 0.0),
        };
        let load = self.machine.normal_load().map_or(0.0, |load| load.uncertainty());
        // Gains of forces are fitted, each with what is known of it.
        [scale, (Source::NormalLoad, load), (Source::Gain, self.gain_uncertainty), (Source::ForceGain, 0.0)]
    }

    /// The derived quantities with their derivatives.
    pub(crate) fn with_gradients(&self) -> Vec<Derived> {
        let directions = self.shared.len() + KNOWN;
        let values = self.derived::<f64>(0);
        let mut gradients = vec![vec![0.0; directions]; values.len()];
        for first in (0..directions).step_by(DIRECTIONS) {
            for (gradient, (_, number)) in gradients.iter_mut().zip(self.derived::<Dual<DIRECTIONS>>(first)) {
                for (direction, slope) in gradient[first..].iter_mut().enumerate().take(DIRECTIONS) {
                    *slope = number.partial(direction);
                }
            }
        }
        let with_gradient = |((parameter, value), gradient)| Derived { parameter, value, gradient };
        values.into_iter().zip(gradients).map(with_gradient).collect()
    }

    /// Units of the forces that are stated; of a record in other units, damping alone is one.
    fn forces(&self) -> Units {
        let own = if self.table.is_per_mass() { self.table.units.with_forces() } else { None };
        own.unwrap_or_else(|| Units::new("m", "N"))
    }

    /// True if forces per mass are accelerations in SI, so that a mass makes forces of them.
    fn is_si(&self) -> bool {
        !self.table.is_per_mass() || self.table.units.with_forces().is_some()
    }

    /// True if forces are in N along a motion in m, which a normal load in N makes coefficients of.
    fn is_along_a_line(&self) -> bool {
        !self.table.is_per_mass() || self.table.units.is_metric()
    }

    /// The derived quantities, as numbers whose directions from `first` on are the shared values, then the inputs.
    fn derived<D: Scalar>(&self, first: usize) -> Vec<(Parameter, D)> {
        let variable = |value: f64, direction: usize| D::variable(value, direction.wrapping_sub(first));
        let natural_frequency = self.table.shared(Place::Frequency).map(|index| variable(self.shared[index], index));
        let mut derived = Vec::new();
        // A scale on which the motion depends is fitted with what is known of it.
        let scale = |place, known: f64| match self.table.shared(place) {
            Some(index) => variable(self.shared[index], index),
            None => variable(known, self.shared.len()),
        };
        let stated = self.forces();
        let to_mass = |stiffness: D| natural_frequency.map(|frequency| mass_of_stiffness(stiffness, frequency));
        let mass = match self.machine.scale() {
            Scale::Mass(known) => {
                let mass = scale(Place::Mass, known.value());
                let unit = stated.force.per(&stated.position).to_string();
                let parameter = Parameter::named("stiffness", "k", unit).bounded(Bounds::POSITIVE);
                derived.extend(to_mass(D::from(1.0)).map(|per_stiffness| (parameter, mass / per_stiffness)));
                Some(mass)
            }
            Scale::Stiffness(known) => {
                let mass = to_mass(scale(Place::Stiffness, known.value()));
                let parameter = Parameter::named("mass", "m", stated.mass().to_string()).bounded(Bounds::POSITIVE);
                derived.extend(mass.map(|mass| (parameter, mass)));
                mass
            }
            _ => None,
        };
        if self.table.is_per_mass() {
            for (place, term) in self.table.terms.iter().enumerate() {
                let Some(parameter) = term.stiffness_per_mass(&self.table.units.position) else { continue };
                let index = self.table.oscillator + place;
                let value = variable(self.shared[index], index);
                derived.extend(to_mass(D::from(1.0)).map(|per_stiffness| (parameter, value / per_stiffness)));
            }
            if let Some(frequency) = natural_frequency {
                derived.extend(self.of_damping(frequency, mass, &variable).into_iter().flatten());
            }
        }
        if let Some((slope, mass)) = self.table.shared(Place::Slope).zip(mass) {
            let parameter = Parameter::named("slope_force", "F_s", stated.force.to_string());
            derived.push((parameter, variable(self.shared[slope], slope) * mass));
        }
        let change = self.table.shared(Place::Term(Term::Change)).filter(|_| self.table.is_per_mass());
        if let Some((index, frequency)) = change.zip(natural_frequency) {
            let per_half_cycle = variable(self.shared[index], index) / (frequency * 2.0);
            derived.push((Parameter::new(CHANGE_PER_HALF_CYCLE, "w/2f₀", "1"), per_half_cycle));
        }
        if let Some(index) = self.table.shared(Place::Term(Term::Position)) {
            let rise = variable(self.shared[index], index) * self.table.deflections.largest_square;
            derived.push((Parameter::new(RISE_OVER_POSITION, "β X²", "1"), rise));
        }
        // With an unknown scale the fitted values are forces already, by the channel of a measured one if there is one.
        let by_force = variable(1.0, self.shared.len() + 3);
        let to_force = if self.table.is_per_mass() { mass } else { Some(by_force) };
        let load = self.machine.normal_load().map(|load| variable(load.value(), self.shared.len() + 1));
        // A record that reads too much shows too large a force per mass, and nothing of a force.
        let gain = if self.table.is_per_mass() { variable(self.gain, self.shared.len() + 2) } else { D::from(1.0) };
        let Table { family, units, law, .. } = self.table;
        let law_value = |index: usize| variable(self.shared[law + index], law + index);
        let level = family.level().map(law_value);
        for (i, law_parameter) in family.fitted().enumerate() {
            let role = law_parameter.role();
            let mut value = law_value(i);
            if let (Role::LevelAbove | Role::Breakaway, Some(level)) = (role, level) {
                value += level;
                let stated = units.stated(law_parameter, self.table.form);
                derived.push((stated, if self.table.is_per_mass() { value / gain } else { value * by_force }));
            }
            let Some(force) = to_force.map(|to_force| value * to_force) else { continue };
            let stated = |form: Form| stated.stated(law_parameter, form);
            if is_coefficient(law_parameter) {
                if self.is_si() {
                    let force = force / gain;
                    derived.extend(mass.map(|_| (stated(Form::Force), force)));
                    derived
                        .extend(load.filter(|_| self.is_along_a_line()).map(|load| (stated(Form::Mu), force / load)));
                }
            } else if mass.is_some() && (role == Role::Slope || is_force(role) && self.is_si()) {
                derived.push((stated(Form::Force), force));
            }
        }
        derived
    }
}

impl Inputs<'_> {
    /// ζ, Q, δ and τ of all linear damping, at this natural frequency (Hz) of this `mass` (kg); none without damping,
    /// nor at or above the critical one.
    fn of_damping<D: Scalar>(
        &self,
        natural_frequency: D,
        mass: Option<D>,
        variable: &impl Fn(f64, usize) -> D,
    ) -> Option<[(Parameter, D); 4]> {
        let Table { family, law, .. } = self.table;
        let fitted = |index: usize| variable(self.shared[index], index);
        // A straight line over the speed, on a level or not, is a linear damping; the slope of other laws is none.
        let is_line = family.fitted().all(|parameter| matches!(parameter.role(), Role::Level | Role::Slope));
        let slope = family.fitted().position(|parameter| is_line && parameter.role() == Role::Slope);
        let term = self.table.shared(Place::Term(Term::LinearDamping));
        let declared = self.machine.damping().map(|damping| {
            let damping = self.table.shared(Place::MachineDamping).map_or(D::from(damping.value()), fitted);
            mass.map_or(damping, |mass| damping / mass)
        });
        let parts = [term.map(fitted), slope.map(|slope| fitted(law + slope)), declared];
        let linear = parts.into_iter().flatten().fold(D::from(0.0), |sum, part| sum + part);
        let oscillator =
            Oscillator::per_unit_mass(natural_frequency).ok()?.with_damping(Damping::new(linear, D::from(0.0)).ok()?);
        let stated = |name, symbol, unit, value: D| {
            let is_number = value.value().is_normal() && (value.value() * value.value()).is_normal();
            is_number.then(|| (Parameter::new(name, symbol, unit).bounded(Bounds::POSITIVE), value))
        };
        Some([
            stated(OF_DAMPING[0], "ζ", "1", oscillator.damping_ratio())?,
            stated(OF_DAMPING[1], "Q", "1", oscillator.quality_factor()?)?,
            stated(OF_DAMPING[2], "δ", "1", oscillator.logarithmic_decrement()?)?,
            stated(OF_DAMPING[3], "τ", "s", oscillator.time_constant()?)?,
        ])
    }
}

/// A quantity that follows from shared values and inputs, with its derivatives by all of them.
pub(crate) struct Derived {
    pub(crate) parameter: Parameter,
    pub(crate) value: f64,
    /// Derivatives by the shared values, then by scale, normal load, gain of the instrument and gain of a measured force.
    pub(crate) gradient: Vec<f64>,
}

/// Quantities that follow from the `shared` values of a fit and from the known inputs of the `machine`.
pub(crate) fn derived(machine: &Machine, table: &Table, shared: &[f64]) -> Vec<Derived> {
    Inputs { machine, shared, table, gain: 1.0, gain_uncertainty: 0.0 }.with_gradients()
}

/// The values of these `findings`, the fitted ones first, for one draw of the fitted `values`, of what is known of the
/// machine, and of the error of the `gain` of the instrument, as a factor (1); NaN for one that the draw does not have.
#[cfg(feature = "sampler")]
pub(crate) fn values_of_findings(
    findings: &[Finding],
    machine: &Machine,
    table: &Table,
    values: &[f64],
    gain: f64,
) -> Vec<f64> {
    let fitted = values.iter().enumerate();
    let fitted = fitted.map(|(index, value)| value * gain.powf(-table.power_of_gain(index, values)));
    let inputs = Inputs { machine, shared: &values[..table.shared], table, gain, gain_uncertainty: 0.0 };
    let derived = inputs.derived::<f64>(0);
    let named = |finding: &Finding| {
        let (_, value) = derived.iter().find(|(parameter, _)| parameter.name() == finding.parameter().name())?;
        Some(*value)
    };
    fitted.chain(findings.iter().skip(values.len()).map(|finding| named(finding).unwrap_or(f64::NAN))).collect()
}
