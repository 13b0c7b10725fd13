//! Problem of a planned test, and its information about the parameters that all tests share.

use std::f64::consts::PI;

use fmm_fit::design::Information;
use fmm_fit::{FitError, Residuals};
use fmm_friction::Role;
use fmm_model::{Dual, Parameter, Scalar, Unit};
use fmm_record::{Quantity, Record};

use crate::candidate::Candidate;
use crate::design::inputs::{Input, Inputs};
use crate::design::planned_test::{Load, Motion};
use crate::design::{Guess, PlannedTest};
use crate::error::IdentifyError;
use crate::experiment::{Drive, Experiment};
use crate::friction_curve::path::Path;
use crate::law::DIRECTIONS;
use crate::law::dimension::is_force;
use crate::machine::Scale;
use crate::machine::term::Term;
use crate::machine::{Known, Machine};
use crate::problem::Problem;
use crate::quantities::rows::{Knowledge, Place, Row};
use crate::quantities::table::{Table, mass_of_stiffness};

/// Layout and parameters that all tests share, static levels among them.
pub(crate) fn layout(
    model: &Candidate,
    machine: &Machine,
    position: &Unit,
    frequency: f64,
) -> Result<(Table, Vec<Parameter>), IdentifyError> {
    let blank = Record::new(0.0, 1.0, vec![0.0; 2], Quantity::Displacement, position.to_string())?;
    let blank = Experiment::planned(blank, None, false, frequency, 1.0, None);
    // What is known to an uncertainty is an input of a plan.
    let (layout, mut parameters) = Table::of(model, &machine.exactly(), &[blank])?;
    parameters.truncate(layout.shared);
    Ok((layout, parameters))
}

/// The mass (kg) of a machine that vibrates at `frequency` (Hz), if a scale is known.
pub(crate) fn mass_of(machine: &Machine, frequency: f64) -> Option<f64> {
    match machine.scale() {
        Scale::Mass(mass) | Scale::MassAndStiffness(mass, _) => Some(mass.value()),
        Scale::Stiffness(stiffness) => Some(mass_of_stiffness(stiffness.value(), frequency)),
        Scale::PerUnitMass | Scale::Unknown => None,
    }
}

/// The derivatives of parameters of these `names` by `parameters`, row by row: 1 where the name is the same.
pub(crate) fn by_name(names: &[&str], parameters: &[Parameter]) -> Vec<f64> {
    let row = |name: &&str| parameters.iter().map(|parameter| f64::from(parameter.name() == *name)).collect::<Vec<_>>();
    names.iter().flat_map(row).collect()
}

/// Error `source` of a design by `law`.
pub(crate) fn design_error(law: &'static str, source: FitError) -> IdentifyError {
    IdentifyError::simulation(law, source)
}

/// A guess at certain values of the shared parameters, and the inputs of a plan.
#[derive(Clone, Copy)]
pub(crate) struct Local<'a> {
    pub(crate) guess: &'a Guess,
    pub(crate) layout: &'a Table,
    pub(crate) inputs: &'a Inputs,
    pub(crate) values: &'a [f64],
}

impl Local<'_> {
    /// Number of shared parameters and inputs.
    fn directions(&self) -> usize {
        self.values.len() + self.inputs.len()
    }

    /// The shared parameters as they are in `test`, with the mass and the spring that are added and the errors of its
    /// inputs: of a record that reads too much, all lengths are too long.
    ///
    /// ```text
    /// m′ = m + Δm,  k′ = k + Δk,  f₀′ = √(k′/m′)/2π,  (c/m)′ = c/m · m/m′,  (F/m)′ = F/m · m/m′ · (1 + u_N ξ_N/N)
    /// ```
    fn of_test<D: Scalar>(&self, test: &PlannedTest, first: usize) -> Vec<D> {
        let Self { guess, layout, inputs, values } = *self;
        let error = |input: Input| match inputs.find(input) {
            Some((place, u)) => D::variable(0.0, (values.len() + place).wrapping_sub(first)) * u,
            None => D::from(0.0),
        };
        let mut own: Vec<D> =
            values.iter().enumerate().map(|(i, value)| D::variable(*value, i.wrapping_sub(first))).collect();
        let added = |known: Option<Known>, input: fn(Known) -> Input| {
            known.map_or(D::from(0.0), |known| error(input(known)) + known.value())
        };
        let added_mass = added(test.added_mass, Input::AddedMass);
        let added_stiffness = added(test.added_stiffness, Input::AddedStiffness);
        let one = D::from(1.0);
        let (mut of_mass, mut of_stiffness, mut of_force) = (one, one, one);
        if test.added_mass.is_some() || test.added_stiffness.is_some() {
            let alone = match guess.machine.scale() {
                Scale::Mass(known) => error(Input::Scale) + known.value(),
                Scale::Stiffness(known) => mass_of_stiffness(error(Input::Scale) + known.value(), own[0]),
                _ => own[0],
            };
            let whole = alone + added_mass;
            of_mass = alone / whole;
            if layout.is_per_mass() {
                let spring = alone / mass_of_stiffness(one, own[0]);
                of_stiffness = spring / (spring + added_stiffness);
                of_force = of_mass;
                own[0] = ((spring + added_stiffness) / whole).sqrt() / (2.0 * PI);
            } else {
                of_stiffness = own[1] / (own[1] + added_stiffness);
                (own[0], own[1]) = (whole, own[1] + added_stiffness);
            }
        }
        for (place, term) in layout.terms.iter().enumerate() {
            let value = &mut own[layout.oscillator + place];
            match term {
                Term::LinearDamping | Term::QuadraticDamping | Term::CubicDamping | Term::PowerDamping => {
                    *value *= of_mass;
                }
                Term::CubicSpring | Term::QuinticSpring | Term::StopRatio => *value *= of_stiffness,
                _ => {}
            }
        }
        if let Load::Other(load) = test.load {
            of_force *= error(Input::Load(load)) / load.value() + 1.0;
        }
        for (place, parameter) in layout.family.fitted().enumerate() {
            if is_force(parameter.role()) || parameter.role() == Role::Slope {
                own[layout.law + place] *= of_force;
            }
        }
        let gain = (error(Input::Gain(test.sensor)) + 1.0).ln();
        for (index, value) in own.iter_mut().enumerate() {
            *value *= (gain * layout.power_of_gain(index, values)).exp();
        }
        own
    }

    /// The `machine` with the mass and the spring of `test`.
    fn machine(&self, test: &PlannedTest, machine: &Machine) -> Result<Machine, IdentifyError> {
        let added = |known: Option<Known>| known.map_or(0.0, |known| known.value());
        let machine = match machine.scale() {
            Scale::Mass(mass) => machine.scaled(Scale::Mass(mass.moved_to(mass.value() + added(test.added_mass)))),
            Scale::Stiffness(stiffness) => {
                machine.scaled(Scale::Stiffness(stiffness.moved_to(stiffness.value() + added(test.added_stiffness))))
            }
            Scale::PerUnitMass if test.added_mass.is_some() || test.added_stiffness.is_some() => {
                return Err(IdentifyError::contradiction(format!(
                    "{} adds a mass or a stiffness, but neither is known of the machine; give its mass or its \
                     stiffness",
                    test.name()
                )));
            }
            _ => *machine,
        };
        let is_linear = machine.restoring() == fmm_model::Restoring::Linear && !self.layout.terms.has(Term::Gap);
        if test.added_stiffness.is_some() && !is_linear {
            return Err(IdentifyError::contradiction(format!(
                "{} adds a spring to a machine whose own is not linear, so that the whole would be another law; leave \
                 it out",
                test.name()
            )));
        }
        Ok(machine)
    }

    /// The experiment that `test` would be.
    pub(crate) fn experiment(&self, test: &PlannedTest) -> Result<Experiment, IdentifyError> {
        let shared: Vec<f64> = self.of_test(test, 0);
        let frequency = if self.layout.is_per_mass() { shared[0] } else { (shared[1] / shared[0]).sqrt() / (2.0 * PI) };
        let factor = match (test.load, self.guess.machine.normal_load()) {
            (Load::OfMachine, _) => 1.0,
            (Load::None, _) => 0.0,
            (Load::Other(load), Some(of_machine)) => load.value() / of_machine.value(),
            (Load::Other(_), None) => {
                return Err(IdentifyError::missing(format!(
                    "{} has a normal load, but that of the machine, of which it is a multiple, is not stated; give the machine its normal load",
                    test.name()
                )));
            }
        };
        let record = self.guess.blank(test.sensor.quantity(), test.rate(), test.samples())?;
        let drive = match &test.motion {
            Motion::Released(_) => None,
            // The channel of a force that sets the scale is an input that all tests share.
            Motion::Pushed(force, _) if self.guess.machine.scale() == Scale::Unknown => Some(Drive::force(force)?),
            Motion::Pushed(force, uncertainty) => Some(Drive::force(force)?.with_gain_uncertainty(*uncertainty)?),
            Motion::Impact(force) => Some(Drive::force(force)?.with_free_delay(record.interval())?),
            Motion::Carried(base) => Some(Drive::base(base)?),
        };
        let is_at_rest = matches!(test.motion, Motion::Impact(_));
        let offset = (!test.fits_offset).then_some(0.0);
        Experiment::planned(record, drive, is_at_rest, frequency, test.sensor.noise(), offset).with_load_factor(factor)
    }

    /// The problem of `test`, which would be the one of these `experiments`, and its values.
    fn problem<'a>(
        &self,
        test: &PlannedTest,
        experiments: &'a [Experiment],
    ) -> Result<(Problem<'a>, Vec<f64>), IdentifyError> {
        let shared: Vec<f64> = self.of_test(test, 0);
        let machine = self.machine(test, &self.guess.machine)?;
        let model = &self.guess.model;
        let model = Candidate { law: model.law.with_held_breakaway(), ..model.clone() };
        let problem = Problem::of(&model, machine, experiments)?.without_prior();
        let state = |parameter: &Parameter| match (parameter.name(), &test.motion) {
            ("initial_position", Motion::Released(position)) => *position,
            ("force_gain" | "base_gain", _) => 1.0,
            _ => 0.0,
        };
        let of_row = |(place, row): (Option<usize>, &Row)| match (place, row.knowledge) {
            (Some(place), _) => shared[place],
            (None, Knowledge::Prior { value, .. } | Knowledge::Fixed(value)) => value,
            (None, Knowledge::Free) => 0.0,
        };
        let own = problem.parameters()[problem.table.shared..].iter().map(state);
        let values = self.rows(&problem).map(of_row).chain(own).collect();
        Ok((problem, values))
    }

    /// Each shared row of the `problem` of a test: it is one of the guess, with its place, or something known of the
    /// machine.
    fn rows<'a>(&'a self, problem: &'a Problem<'_>) -> impl Iterator<Item = (Option<usize>, &'a Row)> {
        let place = |parameter: &Parameter| self.guess.parameters.iter().position(|one| one.name() == parameter.name());
        problem.parameters()[..problem.table.shared].iter().map(place).zip(&problem.table.rows)
    }

    /// Path of the motion of `test`.
    pub(crate) fn path_of(&self, test: &PlannedTest) -> Result<Path, IdentifyError> {
        let experiments = [self.experiment(test)?];
        let (problem, values) = self.problem(test, &experiments)?;
        Path::of(&problem, &values).map_err(|error| IdentifyError::simulation(self.guess.model.law_name(), error))
    }

    /// Information of `test` about the shared parameters and the inputs, in this order.
    pub(crate) fn information(&self, test: &PlannedTest) -> Result<Information, IdentifyError> {
        let failed = |source| design_error(self.guess.model.law_name(), source);
        let experiments = [self.experiment(test)?];
        let (own, values) = self.problem(test, &experiments)?;
        let information = Information::of_problem(&own, &values, own.table.shared);
        let information =
            information.and_then(|information| information.scaled(test.sensor.noise().powi(-2))).map_err(failed)?;
        let rows: Vec<(Option<usize>, &Row)> = self.rows(&own).collect();
        let input = |row: &Row| match row.place {
            Place::MachineDamping => self.inputs.find(Input::Damping),
            _ => self.inputs.find(Input::Scale),
        };

        let directions = self.directions();
        let mut derivatives = vec![0.0; rows.len() * directions];
        for (row, (_, known)) in derivatives.chunks_exact_mut(directions).zip(&rows).filter(|(_, (at, _))| at.is_none())
        {
            if let Some((place, u)) = input(known) {
                row[self.values.len() + place] = u;
            }
        }
        for first in (0..directions).step_by(DIRECTIONS) {
            let seeded: Vec<Dual<DIRECTIONS>> = self.of_test(test, first);
            for (row, (place, _)) in derivatives.chunks_exact_mut(directions).zip(&rows) {
                let Some(place) = place else { continue };
                let slopes = row[first..].iter_mut().enumerate().take(DIRECTIONS);
                slopes.for_each(|(direction, slope)| *slope = seeded[*place].partial(direction));
            }
        }
        information.transformed(&derivatives).map_err(failed)
    }
}
