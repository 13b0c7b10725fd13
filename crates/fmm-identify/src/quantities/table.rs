//! Table of quantities: each number of machine, law, experiment and sensor is a row, by which it is found and scaled.

use std::f64::consts::PI;
use std::ops::Range;

use fmm_friction::Role;
use fmm_model::{Bounds, Parameter, Restoring, Rounded, Scalar};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::deflections::Deflections;
use crate::experiment::run_down::{are_run_downs, have_both_directions};
use crate::experiment::{Experiment, reference};
use crate::law::Law;
use crate::law::dimension::is_force;
use crate::law::naming::{Form, Units};
use crate::machine::Terms;
use crate::machine::term::Term;
use crate::machine::{Machine, Scale};
use crate::quantities::rows::{
    Builder, Knowledge, Place, Row, between_directions, knowledge_of_change, of_experiment, oscillator,
};

/// Amplitude (rad) beyond which a record is not one of a pendulum with that length: no crossing counts turns.
const MOST_RADIANS: f64 = 4.0 * PI;

/// Rows of a problem in their order: oscillator, terms beside the law, law, then for each record its initial state, its
/// drive, its offset, its disturbances and its sensor.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    pub(crate) family: Law,
    /// The terms beside the law.
    pub(crate) terms: Terms,
    /// Units of the motion and of forces.
    pub(crate) units: Units,
    /// Form of its forces: per mass beside a frequency, as all that a free vibration shows; as forces beside mass and
    /// stiffness; as coefficients beside mass, stiffness, damping and normal load as they are declared.
    pub(crate) form: Form,
    pub(crate) rows: Vec<Row>,
    /// Bounds of each row by its nature.
    pub(crate) natural: Vec<Bounds>,
    /// Rows of the oscillator; the terms follow.
    pub(crate) oscillator: usize,
    /// First row of the law.
    pub(crate) law: usize,
    /// Rows that all records share.
    pub(crate) shared: usize,
    /// First row of each record.
    pub(crate) own: Vec<usize>,
    /// Rows of each record on which its motion depends; they come first.
    pub(super) of_motion: Vec<usize>,
    /// Deflections over which friction depends on the position; those of a measured motion are not known here.
    pub(crate) deflections: Deflections,
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
        "a pendulum that moves by {} {unit} for each radian would swing by {angle:.3e} rad in this record, beyond two \
         whole turns; give the length in {unit} that makes one radian",
        Rounded::every_digit(length)
    )))
}

/// Refuses run-downs beside other experiments, and what a machine without a spring does not have.
fn require_spring(machine: &Machine, terms: &Terms, experiments: &[Experiment]) -> Result<(), IdentifyError> {
    let is_bent = terms.has_spring() || terms.has(Term::Position) || machine.restoring() != Restoring::Linear;
    let is_scaled_otherwise = !matches!(machine.scale(), Scale::PerUnitMass | Scale::Mass(_));
    Err(IdentifyError::contradiction(match are_run_downs(experiments) {
        None => {
            "a run-down is that of a machine without a spring, and other experiments beside it have one; fit them apart"
        }
        Some(true) if is_scaled_otherwise => {
            "a run-down has no spring: give a mass (kg, or kg m² for angles) or nothing, and no stiffness"
        }
        Some(true) if is_bent => {
            "a run-down has no spring and no middle of its path; leave out the terms of the spring, friction over the \
             position, and the pendulum"
        }
        Some(_) => return Ok(()),
    }))
}

impl Table {
    /// Form in which forces of the `machine` are fitted.
    pub(crate) fn form(machine: &Machine) -> Form {
        match machine.scale() {
            Scale::Unknown | Scale::MassAndStiffness(..) => Form::Force,
            _ => Form::PerMass,
        }
    }

    /// Table and parameters of a law with its terms for these experiments.
    pub(crate) fn of(
        candidate: &Candidate,
        machine: &Machine,
        experiments: &[Experiment],
    ) -> Result<(Self, Vec<Parameter>), IdentifyError> {
        Self::by(Self::form(machine), candidate, machine, experiments)
    }

    /// The same by these `form`.
    pub(crate) fn by(
        form: Form,
        candidate: &Candidate,
        machine: &Machine,
        experiments: &[Experiment],
    ) -> Result<(Self, Vec<Parameter>), IdentifyError> {
        let Candidate { law: family, terms } = candidate.clone();
        family.require_units()?;
        terms.require_vibration()?;
        if terms.has_linear_damping() && family.has_slope() {
            return Err(IdentifyError::two_dampings(family.name));
        }
        if (terms.has(Term::Change) || terms.has(Term::Position)) && !family.is_of_speed() {
            return Err(IdentifyError::contradiction(format!(
                "{} has an internal state; friction that changes during the record or over the position takes a law of \
                 the sliding speed",
                family.name
            )));
        }
        if let Some(contradiction) = terms.spring_contradiction(machine.restoring()) {
            return Err(IdentifyError::contradiction(contradiction));
        }
        let reference = reference(experiments);
        require_swing(machine, reference)?;
        require_spring(machine, &terms, experiments)?;
        let is_driven = experiments.iter().any(|experiment| experiment.drive().is_some());
        let is_declared = form == Form::Coefficient;
        let family = if is_driven || is_declared { family.with_breakaway() } else { family };
        let units = Units::of(reference.record());
        let mut rows = Builder::default();
        oscillator(machine, experiments, form, &mut rows);
        if have_both_directions(experiments) {
            between_directions(&terms, &units, reference.scales().1, &mut rows)?;
        }
        let oscillator = rows.rows.len();
        for (term, parameter) in terms.iter().zip(terms.parameters(&units.position)) {
            match term {
                Term::Change => rows.push(Place::Term(term), None, parameter, knowledge_of_change(machine, reference)),
                Term::Position => rows.free(Place::Term(term), parameter.bounded(reference.deflections().curvatures())),
                _ => rows.free(Place::Term(term), parameter),
            }
        }
        let law = rows.rows.len();
        for (number, parameter) in family.fitted().enumerate() {
            let parameter = if is_declared { parameter.parameter().clone() } else { units.fitted(parameter, form) };
            rows.free(Place::Law(number), parameter);
        }
        let shared = rows.rows.len();
        let (mut own, mut of_motion) = (Vec::with_capacity(experiments.len()), Vec::with_capacity(experiments.len()));
        for record in 0..experiments.len() {
            own.push(rows.rows.len());
            of_motion.push(of_experiment(record, experiments, &units, &mut rows)?);
        }
        let Builder { rows, parameters } = rows;
        let natural = parameters.iter().map(Parameter::bounds).collect();
        let deflections = reference.deflections();
        let mut table =
            Self { family, terms, units, form, rows, natural, oscillator, law, shared, own, of_motion, deflections };
        let mut parameters = parameters;
        table.settle(&mut parameters)?;
        Ok((table, parameters))
    }

    /// Fixes what the terms fix, and narrows the bounds of all fixed rows.
    pub(super) fn settle(&mut self, parameters: &mut [Parameter]) -> Result<(), IdentifyError> {
        for (name, value) in self.terms.held() {
            let known = || parameters.iter().map(Parameter::name).collect::<Vec<_>>().join(", ");
            let Some(index) = parameters.iter().position(|parameter| parameter.name() == name) else {
                let law = self.family.name;
                return Err(IdentifyError::UnknownName {
                    what: format!("{law} has no parameter called {name:?} to fix; its parameters are: {}", known()),
                });
            };
            self.rows[index].knowledge = Knowledge::Fixed(value);
        }
        for (parameter, row) in parameters.iter_mut().zip(&self.rows) {
            let Knowledge::Fixed(value) = row.knowledge else { continue };
            let bounds = parameter.bounds();
            if !bounds.contains(value) {
                let (name, lower, upper) = (parameter.name().to_owned(), bounds.lower(), bounds.upper());
                return Err(IdentifyError::held_out_of_bounds(&name, value, lower, upper));
            }
            *parameter = parameter.clone().bounded(Bounds::new(value, value)?);
        }
        Ok(())
    }

    /// Rows of the law.
    pub(crate) fn of_law(&self) -> Range<usize> {
        self.law..self.shared
    }

    /// True if forces are per mass, as a free vibration shows them.
    pub(crate) fn is_per_mass(&self) -> bool {
        self.form == Form::PerMass
    }

    /// Index of a row that all records share.
    pub(crate) fn shared(&self, place: Place) -> Option<usize> {
        self.rows[..self.shared].iter().position(|row| row.place == place)
    }

    /// Index of a row of record number `record`.
    pub(crate) fn own(&self, record: usize, place: Place) -> Option<usize> {
        let first = self.own[record];
        let end = self.own.get(record + 1).copied().unwrap_or(self.rows.len());
        self.rows[first..end].iter().position(|row| row.place == place).map(|at| first + at)
    }

    /// Rows on which the motion of record number `record` depends: the shared ones, its initial state and its drive.
    pub(crate) fn directions(&self, record: usize) -> usize {
        self.shared + self.of_motion[record]
    }

    /// Index of row `direction` of record `record` among all rows.
    pub(crate) fn index(&self, record: usize, direction: usize) -> usize {
        if direction < self.shared { direction } else { self.own[record] + direction - self.shared }
    }

    /// All rows on which the residuals of record number `record` depend, in their order.
    pub(crate) fn of_record(&self, record: usize) -> impl Iterator<Item = usize> + use<> {
        let end = self.own.get(record + 1).copied().unwrap_or(self.rows.len());
        (0..self.shared).chain(self.own[record]..end)
    }

    /// Index of the first disturbance of record number `record`; of none, where it would be.
    pub(crate) fn first_disturbance(&self, record: usize) -> usize {
        let of_motion = self.own[record] + self.of_motion[record];
        of_motion + usize::from(self.own(record, Place::Offset).is_some())
    }

    /// True if the row at `index` is proportional to the forces, of which a measured one sets the scale.
    pub(crate) fn is_scaled_by_force(&self, index: usize) -> bool {
        match self.rows[index].place {
            Place::Mass | Place::Stiffness => true,
            Place::Law(number) => self
                .family
                .fitted()
                .nth(number)
                .is_some_and(|parameter| is_force(parameter.role()) || parameter.role() == Role::Slope),
            _ => false,
        }
    }

    /// The power of the gain of the record to which the row at `index`, of these `values`, is proportional.
    pub(crate) fn power_of_gain(&self, index: usize, values: &[f64]) -> f64 {
        // Where a measured force sets the scale, a record that reads too much makes mass and stiffness too small.
        let by_force = if self.is_per_mass() { 0.0 } else { -1.0 };
        match self.rows[index].place {
            Place::Position | Place::Velocity | Place::Slope | Place::Wind | Place::Offset | Place::Disturbance(_) => {
                1.0
            }
            Place::DriveGain => -1.0,
            Place::Mass | Place::Stiffness => by_force,
            Place::Law(number) => self.family.fitted().nth(number).map_or(0.0, |parameter| {
                self.family.power_of_gain(parameter) + if self.is_scaled_by_force(index) { by_force } else { 0.0 }
            }),
            Place::Term(term) => term.power_of_gain(self.exponent_of_damping(values)),
            _ => 0.0,
        }
    }

    /// The power of a factor on all times to which the row at `index`, of these `values`, is proportional, if the
    /// record is the `order`th derivative of the position.
    ///
    /// ```text
    /// L Tˢ ~ g^(order + s),  as a record of L/T^order keeps its values
    /// ```
    pub(crate) fn power_of_clock(&self, index: usize, values: &[f64], order: f64) -> f64 {
        let force = if self.is_per_mass() { order - 2.0 } else { 0.0 };
        match self.rows[index].place {
            Place::Frequency | Place::Corner => -1.0,
            Place::Position | Place::Deflection => order,
            Place::Velocity | Place::Wind => order - 1.0,
            Place::Slope => order - 2.0,
            Place::Delay => 1.0,
            // A measured force stays as it is.
            Place::Mass if !self.is_per_mass() => 2.0 - order,
            Place::Stiffness if !self.is_per_mass() => -order,
            Place::Law(number) => self.family.fitted().nth(number).map_or(0.0, |parameter| {
                self.family.power_of_clock(parameter, order) + if self.is_scaled_by_force(index) { force } else { 0.0 }
            }),
            Place::Term(term) => term.power_of_clock(self.exponent_of_damping(values), order),
            _ => 0.0,
        }
    }

    /// Exponent of a damping with a free power; 1 without.
    fn exponent_of_damping(&self, values: &[f64]) -> f64 {
        self.shared(Place::Term(Term::PowerExponent)).map_or(1.0, |index| values[index])
    }
}

/// m = k/(2π f₀)².
pub(crate) fn mass_of_stiffness<D: Scalar>(stiffness: D, natural_frequency: D) -> D {
    let angular = natural_frequency * (2.0 * PI);
    stiffness / (angular * angular)
}
