//! One number of a report: a quantity with its uncertainty and where it comes from.

use fmm_fit::{EstimateStatus, Fit};
use fmm_friction::{LawFamily, Role};
use fmm_model::{Dual, Parameter, Rounded, Scalar};

use crate::Machine;
use crate::dimension::is_force;
use crate::layout::{Layout, fitted, mass_of_stiffness, named};
use crate::machine::Scale;
use crate::residual_structure::Covariance;

/// Where the value of a finding comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Origin {
    /// Found by the fit.
    Fitted(EstimateStatus),
    /// Follows from fitted values and what is known of the machine.
    Derived,
}

/// A quantity that the identification found.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    pub(crate) parameter: Parameter,
    pub(crate) value: f64,
    pub(crate) uncertainty: Option<f64>,
    pub(crate) origin: Origin,
    is_of_record: bool,
}

impl Finding {
    pub(crate) fn new(
        parameter: Parameter,
        value: f64,
        uncertainty: Option<f64>,
        origin: Origin,
        is_of_record: bool,
    ) -> Self {
        Self { parameter, value, uncertainty, origin, is_of_record }
    }

    /// Name, symbol and unit.
    pub fn parameter(&self) -> &Parameter {
        &self.parameter
    }

    /// The estimate, in the unit of the parameter.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// u, its standard uncertainty, in the unit of the parameter; none if the record does not determine it.
    pub fn uncertainty(&self) -> Option<f64> {
        self.uncertainty
    }

    /// Value, uncertainty and unit as text.
    pub(crate) fn quantity(&self) -> String {
        let value = Rounded::new(self.value, self.uncertainty);
        match self.parameter.unit() {
            "1" => value.to_string(),
            unit => format!("{value} {unit}"),
        }
    }

    /// Whether it belongs to one record alone: its initial state or its offset.
    pub fn is_of_record(&self) -> bool {
        self.is_of_record
    }

    /// Where it comes from.
    pub fn origin(&self) -> Origin {
        self.origin
    }
}

/// Shared values of one fit and what is known from elsewhere, from which the derived quantities follow.
struct Inputs<'a> {
    machine: &'a Machine,
    shared: &'a [f64],
    /// Index of the first parameter of the law.
    law: usize,
    /// Unit of a force per mass.
    acceleration: &'a str,
    gain_uncertainty: f64,
}

/// Inputs that were not fitted: scale of the machine, normal load, gain of the instrument.
const KNOWN: usize = 3;

/// Directions of derivative evaluated at a time.
const DIRECTIONS: usize = 6;

impl Inputs<'_> {
    /// Standard uncertainties of the inputs that were not fitted.
    fn uncertainties(&self) -> [f64; KNOWN] {
        let scale = match self.machine.scale() {
            Scale::Mass(known) | Scale::Stiffness(known) => known.uncertainty(),
            Scale::PerUnitMass | Scale::Unknown => 0.0,
        };
        [scale, self.machine.normal_load().map_or(0.0, |load| load.uncertainty()), self.gain_uncertainty]
    }

    /// The derived quantities, as numbers whose directions from `first` on are the shared values, then the inputs.
    fn derived<F: LawFamily, D: Scalar>(&self, first: usize) -> Vec<(Parameter, D)> {
        let variable = |value: f64, direction: usize| D::variable(value, direction.wrapping_sub(first));
        let natural_frequency = variable(self.shared[0], 0);
        let mut derived = Vec::new();
        let mass = match self.machine.scale() {
            Scale::PerUnitMass | Scale::Unknown => None,
            Scale::Mass(known) => {
                let mass = variable(known.value(), self.shared.len());
                let stiffness = mass / mass_of_stiffness(D::from(1.0), natural_frequency);
                derived.push((Parameter::new("stiffness", "k", "N/m"), stiffness));
                Some(mass)
            }
            Scale::Stiffness(known) => {
                let mass = mass_of_stiffness(variable(known.value(), self.shared.len()), natural_frequency);
                derived.push((Parameter::new("mass", "m", "kg"), mass));
                Some(mass)
            }
        };
        // With an unknown scale the fitted values are forces already, whatever they are worth.
        let to_force = match self.machine.scale() {
            Scale::Unknown => Some(D::from(1.0)),
            _ => mass,
        };
        let load = self.machine.normal_load().map(|load| variable(load.value(), self.shared.len() + 1));
        let gain = variable(1.0, self.shared.len() + 2);
        let law_value = |index: usize| variable(self.shared[self.law + index], self.law + index);
        let level = fitted::<F>().position(|parameter| parameter.role() == Role::Level).map(law_value);
        for (i, law_parameter) in fitted::<F>().enumerate() {
            let (parameter, role) = (law_parameter.parameter(), law_parameter.role());
            let mut value = law_value(i);
            if let (Role::LevelAbove, Some(level)) = (role, level) {
                value = value + level;
                if self.machine.scale() != Scale::Unknown {
                    derived.push((named(parameter, "friction_per_mass", self.acceleration), value / gain));
                }
            }
            let Some(to_force) = to_force else { continue };
            let force = value * to_force;
            if role == Role::Slope && mass.is_some() {
                derived.push((Parameter::new("damping", "c", "N s/m"), force));
            } else if is_force(role) && parameter.unit() == "1" {
                let force = force / gain;
                if mass.is_some() {
                    derived.push((named(parameter, "friction_force", "N"), force));
                }
                if let Some(load) = load {
                    derived.push((named(parameter, "mu", "1"), force / load));
                }
            } else if is_force(role) && parameter.unit() == "1/m" && mass.is_some() {
                let name = format!("contact_{}", parameter.name());
                derived.push((Parameter::named(name, parameter.symbol().to_owned(), "N/m"), force));
            }
        }
        derived
    }
}

/// Everything that a fit found: its parameters, and what follows from them and the known inputs of the machine.
///
/// Uncertainties of derived quantities are first order, u² = gᵀ V g + Σ (∂y/∂xᵢ)² u²(xᵢ), with exact derivatives
/// (JCGM 100:2008, 5.1.2 and 5.2.2).
pub(crate) fn findings<F: LawFamily>(
    machine: &Machine,
    layout: &Layout,
    fit: &Fit,
    covariance: &Covariance<'_>,
    gain_uncertainty: f64,
) -> Vec<Finding> {
    let estimated = fit.estimates().iter().enumerate().map(|(index, estimate)| {
        // What is proportional to a power of the record is uncertain with its gain.
        let gain = gain_uncertainty * layout.power_of_gain::<F>(index) * estimate.value();
        Finding {
            parameter: estimate.parameter().clone(),
            value: estimate.value(),
            uncertainty: covariance.get(index, index).map(|variance| variance.sqrt().hypot(gain)),
            origin: Origin::Fitted(estimate.status()),
            is_of_record: index >= layout.shared,
        }
    });
    let mut findings: Vec<Finding> = estimated.collect();
    let shared = &fit.values()[..layout.shared];
    let force = fitted::<F>().position(|parameter| is_force(parameter.role()));
    let acceleration = force.map_or("", |index| fit.estimates()[layout.law + index].parameter().unit());
    let inputs = Inputs { machine, shared, law: layout.law, acceleration, gain_uncertainty };
    let directions = layout.shared + KNOWN;
    let values = inputs.derived::<F, f64>(0);
    let mut gradients = vec![vec![0.0; directions]; values.len()];
    for first in (0..directions).step_by(DIRECTIONS) {
        for (gradient, (_, number)) in gradients.iter_mut().zip(inputs.derived::<F, Dual<DIRECTIONS>>(first)) {
            for (direction, slope) in gradient[first..].iter_mut().enumerate().take(DIRECTIONS) {
                *slope = number.partial(direction);
            }
        }
    }
    for ((parameter, value), gradient) in values.into_iter().zip(gradients) {
        let uncertainty = variance(covariance, &gradient, inputs.uncertainties()).map(f64::sqrt);
        findings.push(Finding { parameter, value, uncertainty, origin: Origin::Derived, is_of_record: false });
    }
    findings
}

/// gᵀ V g over the fitted values plus the variances of the inputs; none if a value that matters has none.
fn variance(covariance: &Covariance<'_>, gradient: &[f64], inputs: [f64; KNOWN]) -> Option<f64> {
    let (shared, known) = gradient.split_at(gradient.len() - inputs.len());
    let mut variance: f64 = known.iter().zip(inputs).map(|(slope, u)| (slope * u).powi(2)).sum();
    for (i, row) in shared.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
        for (j, column) in shared.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
            variance += row * column * covariance.get(i, j)?;
        }
    }
    Some(variance)
}
