//! Parameters of an identification in their order, and the motion that they describe.

use std::borrow::Cow;
use std::f64::consts::PI;

use fmm_fit::EvaluationError;
use fmm_friction::Role;
use fmm_model::{Bounds, Damping, Oscillator, Parameter, Restoring, Rounded, Scalar};

use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::experiment::reference;
use crate::law::dimension::is_force;
use crate::law::naming::{Level, Units};
use crate::law::{Law, Motion};
use crate::machine::Scale;
use crate::machine::terms::Term;
use crate::machine::{Machine, Terms};

/// Amplitude (rad) beyond which a record is not one of a pendulum with that length: no crossing counts turns.
const MOST_RADIANS: f64 = 4.0 * PI;

/// Order of the parameters: oscillator, damping beside the law, law, then for each record its initial state and, unless
/// it is fixed, its offset.
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
    /// For each record, the index of its initial position; initial velocity, gain and delay of its drive, and offset
    /// follow.
    pub(crate) own: Vec<usize>,
    /// For each record, how many parameters of its own its motion depends on.
    of_motion: Vec<usize>,
    /// For each parameter of a record, the power of the gain of the record to which it is proportional.
    powers: Vec<f64>,
    /// Relative standard uncertainty (1) of all forces that a measured force sets the scale of.
    pub(crate) force_uncertainty: f64,
}

/// Refuses a pendulum that would turn over and over in the record.
fn require_swing(machine: &Machine, record: &Experiment) -> Result<(), IdentifyError> {
    let Restoring::Sine { length } = machine.restoring() else { return Ok(()) };
    let angle = record.scales().0 / length;
    if angle <= MOST_RADIANS {
        return Ok(());
    }
    let unit = Units::of(record.record()).position;
    Err(IdentifyError::contradiction(format!(
        "a pendulum that moves by {} {unit} for each radian would swing by {angle:.3e} rad in this record, beyond two whole turns; give \
         the length in {unit} that makes one radian",
        Rounded::every_digit(length)
    )))
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
        if let Some(contradiction) = terms.spring_contradiction(machine.restoring()) {
            return Err(IdentifyError::contradiction(contradiction));
        }
        let reference = reference(decays);
        require_swing(machine, reference)?;
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
        let mut of_motion = Vec::with_capacity(decays.len());
        let mut powers = Vec::new();
        let mut force_uncertainty = 0.0f64;
        for (index, decay) in decays.iter().enumerate() {
            let of_record = |name: &'static str| match decays.len() {
                1 => Cow::Borrowed(name),
                _ => Cow::Owned(format!("{name}_{}", index + 1)),
            };
            own.push(parameters.len());
            let mut push = |parameter: Parameter, power: f64| {
                parameters.push(parameter);
                powers.push(power);
            };
            let initial = if decay.begins_at_rest() { Bounds::new(0.0, 0.0)? } else { Bounds::UNBOUNDED };
            let position = Parameter::named(of_record("initial_position"), "x₀", units.position.to_string());
            let velocity = Parameter::named(of_record("initial_velocity"), "v₀", units.velocity().to_string());
            push(position.bounded(initial), 1.0);
            push(velocity.bounded(initial), 1.0);
            let mut count = 2;
            if let Some(drive) = decay.drive() {
                if drive.is_force() && unknown_scale {
                    force_uncertainty = force_uncertainty.max(drive.gain_uncertainty());
                }
                if drive.fits_gain(machine.scale()) {
                    let name = if drive.is_force() { "force_gain" } else { "base_gain" };
                    push(Parameter::named(of_record(name), "g", "1").bounded(Bounds::POSITIVE), -1.0);
                    count += 1;
                }
                let longest = drive.longest_delay();
                if longest > 0.0 {
                    push(Parameter::named(of_record("delay"), "τ", "s").bounded(Bounds::new(-longest, longest)?), 0.0);
                    count += 1;
                }
            }
            of_motion.push(count);
            if decay.fixed_offset().is_none() {
                push(Parameter::named(of_record("offset"), "b", decay.record().unit().to_owned()), 1.0);
            }
            let number = if decays.len() == 1 { String::new() } else { format!("_{}", index + 1) };
            for (at, nuisance) in decay.nuisances().iter().enumerate() {
                push(nuisance.parameter(at, &number, decay.record().unit()), 1.0);
            }
            if decay.sensor().has_free_corner() {
                let corner = Parameter::named(of_record("sensor_corner_hz"), "f_c", "Hz");
                push(corner.bounded(decay.corner_bounds()), 0.0);
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
        let terms = terms.clone();
        let layout = Self { family, oscillator, terms, units, law, shared, own, of_motion, powers, force_uncertainty };
        Ok((layout, parameters))
    }

    /// How many parameters the motion of record number `record` depends on: the shared ones, its initial state and its
    /// drive.
    pub(crate) fn directions(&self, record: usize) -> usize {
        self.shared + self.of_motion[record]
    }

    /// Index of the offset of record number `record`, if it is fitted.
    pub(crate) fn offset(&self, record: usize) -> usize {
        self.own[record] + self.of_motion[record]
    }

    /// Index of the first disturbance of record number `record`, which is `decay`.
    pub(crate) fn nuisance(&self, record: usize, decay: &Experiment) -> usize {
        self.offset(record) + usize::from(decay.fixed_offset().is_none())
    }

    /// Index of the corner frequency of the sensor of record number `record`, which is `decay`, if it is fitted.
    pub(crate) fn corner(&self, record: usize, decay: &Experiment) -> Option<usize> {
        decay.sensor().has_free_corner().then(|| self.nuisance(record, decay) + decay.nuisances().len())
    }

    /// Index of parameter `direction` of record `record` among all parameters.
    pub(crate) fn index(&self, record: usize, direction: usize) -> usize {
        if direction < self.shared { direction } else { self.own[record] + direction - self.shared }
    }

    /// The power of the gain of the record to which the parameter at `index`, of these `values`, is proportional.
    pub(crate) fn power_of_gain(&self, index: usize, values: &[f64]) -> f64 {
        if index >= self.shared {
            return self.powers[index - self.shared];
        }
        if let Some(index) = index.checked_sub(self.law) {
            return self.family.fitted().nth(index).map_or(0.0, |parameter| self.family.power_of_gain(parameter));
        }
        let exponent = self.terms.place(Term::PowerExponent).map_or(1.0, |place| values[self.oscillator + place]);
        let term = index.checked_sub(self.oscillator).and_then(|place| self.terms.iter().nth(place));
        term.map_or(0.0, |term| term.power_of_gain(exponent))
    }

    /// Whether the parameter at `index` is proportional to the forces, of which a measured one sets the scale.
    pub(crate) fn is_scaled_by_force(&self, index: usize) -> bool {
        let of_law = |index| {
            self.family.fitted().nth(index).is_some_and(|law| is_force(law.role()) || law.role() == Role::Slope)
        };
        index < self.oscillator || (self.law..self.shared).contains(&index) && of_law(index - self.law)
    }

    /// The motion of one `experiment`, of the shared `values` with its own behind them, in the order of the parameters.
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
        let damping = match beside(Term::PowerExponent) {
            Some(exponent) => damping.with_power(per_mass(Term::PowerDamping), exponent)?,
            None => damping,
        };
        let force = match experiment.drive() {
            None => None,
            Some(drive) => {
                let is_relative = !drive.is_force() || machine.scale() == Scale::Unknown;
                let of_mass = mass(machine.scale(), values[0]).filter(|_| !is_relative);
                let mut per = match of_mass {
                    Some(mass) => D::from(1.0) / mass,
                    None if drive.is_force() => D::from(1.0),
                    None => oscillator.mass(),
                };
                let mut own = values[self.shared + 2..].iter();
                if drive.fits_gain(machine.scale()) {
                    per /= *own.next().unwrap_or(&D::from(1.0));
                }
                let mut delay = D::from(experiment.sensor().delay());
                if drive.longest_delay() > 0.0 {
                    delay += *own.next().unwrap_or(&D::from(0.0));
                }
                Some(drive.excitation(experiment.record().start(), delay, per)?)
            }
        };
        let restoring = terms.spring(machine.restoring(), beside)?;
        Ok(Motion {
            oscillator: oscillator.with_damping(damping).with_restoring(restoring),
            law: self.family.values(&values[self.law..self.shared]),
            normal_load: D::from(experiment.load_factor()),
            initial: [values[self.shared], values[self.shared + 1]],
            force,
            tolerance: None,
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
