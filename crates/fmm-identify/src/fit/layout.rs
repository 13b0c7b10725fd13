//! Which parameters an identification has, in which order, and how a simulation is made of them.

use std::borrow::Cow;
use std::f64::consts::PI;

use fmm_fit::EvaluationError;
use fmm_model::{Bounds, Damping, Oscillator, Parameter, Restoring, Scalar};

use crate::experiment::reference;
use crate::law::naming::{Level, Units};
use crate::law::{Law, Motion};
use crate::machine::Scale;
use crate::machine::terms::Term;
use crate::{Experiment, IdentifyError, Machine, Terms};

/// Order of the parameters: oscillator, damping beside the law, law, then for each record its initial state and, unless it
/// is fixed, its offset.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    pub(crate) family: Law,
    /// Parameters of the oscillator.
    pub(crate) oscillator: usize,
    /// The terms beside the law, whose parameters follow those of the oscillator.
    pub(crate) terms: Terms,
    /// Units of the motion and of forces.
    pub(crate) units: Units,
    /// Index of the first parameter of the law.
    pub(crate) law: usize,
    /// Parameters of oscillator, damping and law: those that all records share.
    pub(crate) shared: usize,
    /// For each record, the index of its initial position; velocity and offset follow.
    pub(crate) own: Vec<usize>,
}

impl Layout {
    /// Layout and parameters of `family` with `terms` for these records.
    pub(crate) fn of(
        family: Law,
        machine: &Machine,
        terms: &Terms,
        decays: &[Experiment],
    ) -> Result<(Self, Vec<Parameter>), IdentifyError> {
        family.require_units()?;
        if terms.has_linear_damping() && family.has_slope() {
            return Err(IdentifyError::two_dampings(family.name));
        }
        if terms.has_spring() && matches!(machine.restoring(), Restoring::Sine { .. }) {
            return Err(IdentifyError::contradiction(
                "a pendulum has the sine for its restoring force; leave out the pendulum, or the terms of the spring",
            ));
        }
        let reference = reference(decays);
        let is_driven = decays.iter().any(|decay| decay.drive().is_some());
        let family = if is_driven { family.with_breakaway() } else { family };
        let units = Units::of(reference.record());
        let unknown_scale = machine.scale() == Scale::Unknown;
        let level = if unknown_scale { Level::Force } else { Level::PerMass };
        let mut parameters = if unknown_scale {
            vec![
                Parameter::new("mass", "m", "kg").bounded(Bounds::POSITIVE),
                Parameter::new("stiffness", "k", "N/m").bounded(Bounds::POSITIVE),
            ]
        } else {
            let bounds = reference.frequency_bounds();
            vec![Parameter::new("natural_frequency_hz", "f₀", "Hz").bounded(bounds)]
        };
        let oscillator = parameters.len();
        parameters.extend(terms.parameters(&units.position));
        let law = parameters.len();
        parameters.extend(family.fitted().map(|parameter| units.fitted(parameter, level)));
        let shared = parameters.len();
        let mut own = Vec::with_capacity(decays.len());
        for (index, decay) in decays.iter().enumerate() {
            let of_record = |name: &'static str| match decays.len() {
                1 => Cow::Borrowed(name),
                _ => Cow::Owned(format!("{name}_{}", index + 1)),
            };
            own.push(parameters.len());
            parameters.push(Parameter::named(of_record("initial_position"), "x₀", units.position.to_string()));
            parameters.push(Parameter::named(of_record("initial_velocity"), "v₀", units.velocity().to_string()));
            if decay.fixed_offset().is_none() {
                parameters.push(Parameter::named(of_record("offset"), "b", decay.record().unit().to_owned()));
            }
            let number = if decays.len() == 1 { String::new() } else { format!("_{}", index + 1) };
            let disturbances = decay.nuisances().iter().enumerate();
            parameters
                .extend(disturbances.map(|(at, nuisance)| nuisance.parameter(at, &number, decay.record().unit())));
            if decay.sensor().has_free_corner() {
                let corner = Parameter::named(of_record("sensor_corner_hz"), "f_c", "Hz");
                parameters.push(corner.bounded(decay.corner_bounds()));
            }
        }
        for (name, value) in terms.held() {
            let known = || parameters.iter().map(Parameter::name).collect::<Vec<_>>().join(", ");
            let Some(index) = parameters.iter().position(|parameter| parameter.name() == name) else {
                let law = family.name;
                return Err(IdentifyError::UnknownName {
                    what: format!("{law} has no parameter called {name:?} to hold; its parameters are: {}", known()),
                });
            };
            let bounds = parameters[index].bounds();
            if !bounds.contains(value) {
                let (name, lower, upper) = (name.to_owned(), bounds.lower(), bounds.upper());
                return Err(IdentifyError::held_out_of_bounds(&name, value, lower, upper));
            }
            parameters[index] = parameters[index].clone().bounded(Bounds::new(value, value)?);
        }
        Ok((Self { family, oscillator, terms: terms.clone(), units, law, shared, own }, parameters))
    }

    /// How many parameters the motion of one record depends on: the shared ones and its initial state.
    pub(crate) fn directions(&self) -> usize {
        self.shared + 2
    }

    /// Index of the first disturbance of record number `record`, which is `decay`.
    pub(crate) fn nuisance(&self, record: usize, decay: &Experiment) -> usize {
        self.own[record] + 2 + usize::from(decay.fixed_offset().is_none())
    }

    /// Index of the corner frequency of the sensor of record number `record`, which is `decay`, if it is fitted.
    pub(crate) fn corner(&self, record: usize, decay: &Experiment) -> Option<usize> {
        decay.sensor().has_free_corner().then(|| self.nuisance(record, decay) + decay.nuisances().len())
    }

    /// Index of parameter `direction` of record `record` among all parameters.
    pub(crate) fn index(&self, record: usize, direction: usize) -> usize {
        if direction < self.shared { direction } else { self.own[record] + direction - self.shared }
    }

    /// The power of the gain of the record to which the parameter at `index` is proportional.
    pub(crate) fn power_of_gain(&self, index: usize) -> f64 {
        if index >= self.shared {
            return 1.0;
        }
        match index.checked_sub(self.law) {
            Some(index) => {
                self.family.fitted().nth(index).map_or(0.0, |parameter| self.family.power_of_gain(parameter))
            }
            None => index
                .checked_sub(self.oscillator)
                .map_or(0.0, |place| self.terms.iter().nth(place).map_or(0.0, Term::power_of_gain)),
        }
    }

    /// The motion of one `experiment`, of the shared `values` with its initial position and velocity behind them.
    pub(crate) fn motion<D: Scalar>(
        &self,
        machine: &Machine,
        terms: &Terms,
        experiment: &Experiment,
        values: &[D],
    ) -> Result<Motion<D>, EvaluationError> {
        let known_damping = D::from(machine.damping().map_or(0.0, |damping| damping.value()));
        let (oscillator, damping) = match machine.scale() {
            Scale::Unknown => (Oscillator::new(values[0], values[1])?, known_damping),
            Scale::PerUnitMass => (Oscillator::per_unit_mass(values[0])?, known_damping),
            Scale::Mass(_) | Scale::Stiffness(_) => {
                let mass = mass(machine.scale(), values[0]).unwrap_or_else(|| D::from(1.0));
                (Oscillator::per_unit_mass(values[0])?, known_damping / mass)
            }
        };
        let beside = |term: Term| terms.place(term).map(|place| values[self.oscillator + place]);
        let per_mass = |term: Term| beside(term).map_or(D::from(0.0), |value| value * oscillator.mass());
        let linear = beside(Term::LinearDamping);
        let damping = linear.map_or(damping, |linear| damping + linear * oscillator.mass());
        let damping = Damping::of_any_sign(damping, per_mass(Term::QuadraticDamping))?;
        let damping =
            if terms.has(Term::CubicDamping) { damping.with_cubic(per_mass(Term::CubicDamping))? } else { damping };
        let force = match experiment.driven_values() {
            None => None,
            Some((drive, sampled)) => {
                let is_relative = !drive.is_force() || machine.scale() == Scale::Unknown;
                let of_mass = mass(machine.scale(), values[0]).filter(|_| !is_relative);
                let factor = match of_mass {
                    Some(mass) => D::from(1.0) / mass,
                    None if drive.is_force() => D::from(1.0),
                    None => oscillator.mass(),
                };
                Some(drive.excitation(sampled, factor)?)
            }
        };
        let spring = |term: Term, known: f64| beside(term).map_or(D::from(known), |fitted| fitted + known);
        let restoring = match machine.restoring() {
            Restoring::Sine { length } => Restoring::sine(D::from(length))?,
            Restoring::Polynomial { cubic, quintic } => {
                Restoring::polynomial(spring(Term::CubicSpring, cubic), spring(Term::QuinticSpring, quintic))?
            }
            _ if terms.has_spring() => {
                Restoring::polynomial(spring(Term::CubicSpring, 0.0), spring(Term::QuinticSpring, 0.0))?
            }
            _ => Restoring::Linear,
        };
        Ok(Motion {
            oscillator: oscillator.with_damping(damping).with_restoring(restoring),
            law: self.family.values(&values[self.law..self.shared]),
            normal_load: D::from(experiment.load_factor()),
            initial: [values[self.shared], values[self.shared + 1]],
            force,
        })
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
