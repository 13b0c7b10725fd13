//! Which parameters an identification has, in which order, and how a simulation is made of them.

use std::borrow::Cow;
use std::f64::consts::PI;

use fmm_fit::EvaluationError;
use fmm_friction::{LawFamily, LawParameter, Role};
use fmm_model::{Bounds, Damping, Oscillator, Parameter, Scalar};
use fmm_record::Quantity;
use fmm_sim::Scenario;

use crate::machine::Scale;
use crate::{Machine, RingDown};

/// The parameters of a law that a ring-down is fitted by: all but static levels, on which a free decay depends only in
/// where it stops. They are held at the sliding level that precedes them.
pub(crate) fn fitted<F: LawFamily>() -> impl Iterator<Item = &'static LawParameter> {
    F::PARAMETERS.iter().filter(|parameter| parameter.role() != Role::Breakaway)
}

/// Order of the parameters: oscillator, law, then for each record its initial state and, unless it is fixed, its
/// offset.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    /// Parameters of the oscillator.
    pub(crate) oscillator: usize,
    /// Parameters of oscillator and law: those that all records share.
    pub(crate) shared: usize,
    /// For each record, the index of its initial position; velocity and offset follow.
    pub(crate) own: Vec<usize>,
}

impl Layout {
    /// Layout and parameters of law family `F` for these records.
    pub(crate) fn of<F: LawFamily>(machine: &Machine, decays: &[RingDown]) -> (Self, Vec<Parameter>) {
        let units = Units::of(&decays[0]);
        let unknown_scale = machine.scale() == Scale::Unknown;
        let mut parameters = if unknown_scale {
            vec![
                Parameter::new("mass", "m", "kg").bounded(Bounds::POSITIVE),
                Parameter::new("stiffness", "k", "N/m").bounded(Bounds::POSITIVE),
            ]
        } else {
            let bounds = decays[0].frequency_bounds();
            vec![Parameter::new("natural_frequency_hz", "f₀", "Hz").bounded(bounds)]
        };
        let oscillator = parameters.len();
        for law_parameter in fitted::<F>() {
            let parameter = law_parameter.parameter();
            let renamed = match law_parameter.role() {
                Role::Level if unknown_scale => named(parameter, "friction_force", "N"),
                Role::Level => named(parameter, "friction_per_mass", &units.acceleration),
                Role::Slope if unknown_scale => Parameter::new("damping", "c", "N s/m"),
                Role::Slope => Parameter::new("damping_per_mass", "c/m", "1/s"),
                _ => parameter.clone(),
            };
            parameters.push(renamed.bounded(parameter.bounds()));
        }
        let shared = parameters.len();
        let mut own = Vec::with_capacity(decays.len());
        for (index, decay) in decays.iter().enumerate() {
            let of_record = |name: &'static str| match decays.len() {
                1 => Cow::Borrowed(name),
                _ => Cow::Owned(format!("{name}_{}", index + 1)),
            };
            own.push(parameters.len());
            parameters.push(Parameter::named(of_record("initial_position"), "x₀", units.position.clone()));
            parameters.push(Parameter::named(of_record("initial_velocity"), "v₀", units.velocity.clone()));
            if decay.fixed_offset().is_none() {
                parameters.push(Parameter::named(of_record("offset"), "b", decay.record().unit().to_owned()));
            }
        }
        (Self { oscillator, shared, own }, parameters)
    }

    /// How many parameters the motion of one record depends on: the shared ones and its initial state.
    pub(crate) fn directions(&self) -> usize {
        self.shared + 2
    }

    /// Index of parameter `direction` of record `record` among all parameters.
    pub(crate) fn index(&self, record: usize, direction: usize) -> usize {
        if direction < self.shared { direction } else { self.own[record] + direction - self.shared }
    }

    /// Whether the parameter at `index` is proportional to the record: friction levels, initial states, offsets.
    pub(crate) fn scales_with_record<F: LawFamily>(&self, index: usize) -> bool {
        let role = index.checked_sub(self.oscillator).and_then(|i| fitted::<F>().nth(i)).map(LawParameter::role);
        index >= self.shared || role == Some(Role::Level)
    }

    /// Values for all parameters of the law, static levels included.
    fn law_values<F: LawFamily, D: Scalar>(&self, motion: &[D]) -> Vec<D> {
        let mut fitted = motion[self.oscillator..self.shared].iter().copied();
        let mut level = D::from(0.0);
        let value = |parameter: &LawParameter| {
            if parameter.role() == Role::Breakaway {
                return Some(level);
            }
            let value = fitted.next()?;
            if parameter.role() == Role::Level {
                level = value;
            }
            Some(value)
        };
        F::PARAMETERS.iter().filter_map(value).collect()
    }

    /// The scenario of one record; `motion` holds the shared values and then its initial position and velocity.
    pub(crate) fn scenario<F: LawFamily, D: Scalar>(
        &self,
        machine: &Machine,
        motion: &[D],
    ) -> Result<Scenario<D, F::At<D>>, EvaluationError> {
        let known_damping = D::from(machine.damping().map_or(0.0, |damping| damping.value()));
        let (oscillator, damping) = match machine.scale() {
            Scale::Unknown => (Oscillator::new(motion[0], motion[1])?, known_damping),
            Scale::PerUnitMass => (Oscillator::per_unit_mass(motion[0])?, known_damping),
            Scale::Mass(_) | Scale::Stiffness(_) => {
                let mass = mass(machine.scale(), motion[0]).unwrap_or_else(|| D::from(1.0));
                (Oscillator::per_unit_mass(motion[0])?, known_damping / mass)
            }
        };
        let oscillator = oscillator.with_damping(Damping::linear(damping)?);
        let law = F::at(&self.law_values::<F, D>(motion))?;
        let scenario = Scenario::new(oscillator, law, D::from(1.0))?;
        Ok(scenario.starting_at(motion[self.shared], motion[self.shared + 1])?)
    }
}

/// The mass (kg) that the known scale and the natural frequency (Hz) give, if a scale is known.
pub(crate) fn mass<D: Scalar>(scale: Scale, natural_frequency: D) -> Option<D> {
    match scale {
        Scale::Mass(mass) => Some(D::from(mass.value())),
        Scale::Stiffness(stiffness) => Some(mass_of_stiffness(D::from(stiffness.value()), natural_frequency)),
        Scale::PerUnitMass | Scale::Unknown => None,
    }
}

/// m = k/(2π f₀)².
pub(crate) fn mass_of_stiffness<D: Scalar>(stiffness: D, natural_frequency: D) -> D {
    let angular = natural_frequency * (2.0 * PI);
    stiffness / (angular * angular)
}

/// A law's coefficient under the name and unit it has as a force: `coefficient` becomes `friction_force`,
/// `static_coefficient` becomes `static_friction_force`.
pub(crate) fn named(parameter: &Parameter, quantity: &'static str, unit: &str) -> Parameter {
    let stem =
        parameter.name().strip_suffix("coefficient").map_or_else(|| format!("{}_", parameter.name()), str::to_owned);
    let symbol = match quantity {
        "friction_per_mass" => "F/m",
        "friction_force" => "F",
        _ => parameter.symbol(),
    };
    Parameter::named(format!("{stem}{quantity}"), symbol.to_owned(), unit.to_owned())
}

/// Units of position, velocity and acceleration that belong to the unit of a record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Units {
    pub(crate) position: String,
    pub(crate) velocity: String,
    pub(crate) acceleration: String,
}

impl Units {
    fn of(decay: &RingDown) -> Self {
        let unit = decay.record().unit();
        if decay.record().quantity() == Quantity::Displacement {
            return Self { position: unit.into(), velocity: format!("{unit}/s"), acceleration: format!("{unit}/s²") };
        }
        match unit.strip_suffix("/s") {
            Some(base) => Self { position: base.into(), velocity: unit.into(), acceleration: format!("{base}/s²") },
            None => Self { position: format!("{unit} s"), velocity: unit.into(), acceleration: format!("{unit}/s") },
        }
    }
}
