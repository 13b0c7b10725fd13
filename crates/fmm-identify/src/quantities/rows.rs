//! Rows of the table of quantities, and what makes them: of the oscillator, of two directions, of each experiment.

use std::borrow::Cow;

use fmm_model::{Bounds, Parameter};
use fmm_record::Quantity;

use crate::error::IdentifyError;
use crate::experiment::run_down::are_run_downs;
use crate::experiment::{Experiment, reference};
use crate::finding::Source;
use crate::law::naming::{Form, Units};
use crate::machine::term::Term;
use crate::machine::{Known, Machine, Scale, Terms};

/// Knowledge of a quantity before the records are looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Knowledge {
    /// Found by the fit alone.
    Free,
    /// Known to a standard uncertainty: the fit takes it as one more observation.
    Prior { value: f64, uncertainty: f64, source: Source },
    /// A value that the fit does not change.
    Fixed(f64),
}

impl Knowledge {
    /// Knowledge of a quantity that is `known` by `source`.
    fn of(known: Known, source: Source) -> Self {
        match known.uncertainty() {
            0.0 => Self::Fixed(known.value()),
            uncertainty => Self::Prior { value: known.value(), uncertainty, source },
        }
    }
}

/// Place in the model of the number that a row holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// f₀ (Hz), where the motion does not show the mass.
    Frequency,
    Mass,
    Stiffness,
    /// Damping of the machine that is known to an uncertainty.
    MachineDamping,
    QuadraticDamping,
    NormalLoad,
    /// Constant force per mass beside a run-down, such as that of a slope.
    Slope,
    /// Velocity of the medium behind quadratic damping.
    Wind,
    Term(Term),
    /// A parameter of the law, by its number among the fitted ones.
    Law(usize),
    Position,
    Velocity,
    DriveGain,
    Delay,
    Offset,
    Disturbance(usize),
    Corner,
    /// Share of a channel that was measured beside a force, by its number.
    Channel(usize),
    /// Deflection of the bristles at the beginning of a force along a motion.
    Deflection,
}

/// Row of the table beside its [`Parameter`], which has name, symbol, unit and bounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Row {
    pub(crate) place: Place,
    /// The record to which it belongs; `None` if all records share it.
    pub(crate) record: Option<usize>,
    pub(crate) knowledge: Knowledge,
}

/// Rows and parameters while they are collected.
#[derive(Default)]
pub(super) struct Builder {
    pub(super) rows: Vec<Row>,
    pub(super) parameters: Vec<Parameter>,
}

impl Builder {
    pub(super) fn push(&mut self, place: Place, record: Option<usize>, parameter: Parameter, knowledge: Knowledge) {
        self.rows.push(Row { place, record, knowledge });
        self.parameters.push(parameter);
    }

    pub(super) fn free(&mut self, place: Place, parameter: Parameter) {
        self.push(place, None, parameter, Knowledge::Free);
    }
}

/// The rows of what tells the two directions of run-downs apart: a constant force, and wind where `terms` have a drag
/// that feels it, which is no faster than the largest `speed`.
pub(super) fn between_directions(
    terms: &Terms,
    units: &Units,
    speed: f64,
    rows: &mut Builder,
) -> Result<(), IdentifyError> {
    rows.free(Place::Slope, Parameter::named("slope_per_mass", "F_s/m", units.acceleration().to_string()));
    if terms.has(Term::QuadraticDamping) {
        let wind = Parameter::named("wind", "w", units.velocity().to_string()).bounded(Bounds::new(-speed, speed)?);
        rows.free(Place::Wind, wind);
    }
    Ok(())
}

const MASS: Parameter = Parameter::new("mass", "m", "kg").bounded(Bounds::POSITIVE);
const STIFFNESS: Parameter = Parameter::new("stiffness", "k", "N/m").bounded(Bounds::POSITIVE);

/// The rows of the oscillator.
pub(super) fn oscillator(machine: &Machine, experiments: &[Experiment], form: Form, rows: &mut Builder) {
    let is_forced = experiments.iter().any(Experiment::is_forced);
    let known = |known: Known, source| Knowledge::of(known, source);
    match (form, machine.scale()) {
        (Form::PerMass, _) if are_run_downs(experiments) == Some(true) => {}
        (Form::PerMass, scale) => {
            let bounds = reference(experiments).frequency_bounds();
            rows.free(Place::Frequency, Parameter::new("natural_frequency_hz", "f₀", "Hz").bounded(bounds));
            // A free vibration does not depend on it: there it makes forces of forces per mass, and nothing else.
            match scale {
                Scale::Mass(mass) if is_forced && mass.uncertainty() > 0.0 => {
                    rows.push(Place::Mass, None, MASS, known(mass, Source::Mass));
                }
                Scale::Stiffness(stiffness) if is_forced && stiffness.uncertainty() > 0.0 => {
                    rows.push(Place::Stiffness, None, STIFFNESS, known(stiffness, Source::Stiffness));
                }
                _ => {}
            }
        }
        (_, scale) => {
            let (mass, stiffness) = scale.known();
            let or_free = |of: Option<Known>, source| of.map_or(Knowledge::Free, |of| known(of, source));
            rows.push(Place::Mass, None, MASS, or_free(mass, Source::Mass));
            rows.push(Place::Stiffness, None, STIFFNESS, or_free(stiffness, Source::Stiffness));
        }
    }
    let is_declared = form == Form::Coefficient;
    if let Some(damping) = machine.damping().filter(|damping| is_declared || damping.uncertainty() > 0.0) {
        let per_mass = machine.scale() == Scale::PerUnitMass;
        let (name, symbol, unit) = match (is_declared, per_mass) {
            (true, _) => ("damping", "c", "N s/m"),
            (false, true) => ("machine_damping_per_mass", "c_m/m", "1/s"),
            (false, false) => ("machine_damping", "c_m", "N s/m"),
        };
        let parameter = Parameter::new(name, symbol, unit).bounded(Bounds::NOT_NEGATIVE);
        rows.push(Place::MachineDamping, None, parameter, known(damping, Source::Damping));
    }
    if is_declared {
        let quadratic = Parameter::new("quadratic_damping", "A", "N s²/m²").bounded(Bounds::NOT_NEGATIVE);
        rows.push(Place::QuadraticDamping, None, quadratic, Knowledge::Fixed(0.0));
        let load = machine.normal_load().map_or(Knowledge::Fixed(1.0), |load| known(load, Source::NormalLoad));
        let parameter = Parameter::new("normal_load", "N", "N").bounded(Bounds::POSITIVE);
        rows.push(Place::NormalLoad, None, parameter, load);
    }
}

/// Knowledge of the relative change of the friction for each second (1/s) in a `record`.
pub(super) fn knowledge_of_change(machine: &Machine, record: &Experiment) -> Knowledge {
    machine.steadiness().map_or(Knowledge::Free, |for_each_half_cycle| Knowledge::Prior {
        value: 0.0,
        uncertainty: for_each_half_cycle * 2.0 * record.guess.frequency(),
        source: Source::Steadiness,
    })
}

/// The rows of `experiment` number `record`; returns how many of them its motion depends on.
pub(super) fn of_experiment(
    record: usize,
    experiments: &[Experiment],
    units: &Units,
    rows: &mut Builder,
) -> Result<usize, IdentifyError> {
    let experiment = &experiments[record];
    let named = |name: &'static str| match experiments.len() {
        1 => Cow::Borrowed(name),
        _ => Cow::Owned(format!("{name}_{}", record + 1)),
    };
    let first = rows.rows.len();
    let mut push = |place, parameter, knowledge| rows.push(place, Some(record), parameter, knowledge);
    let state = if experiment.begins_at_rest() { Knowledge::Fixed(0.0) } else { Knowledge::Free };
    // Where nothing depends on the position, a velocity does not tell it.
    let is_anywhere = experiment.is_run_down() && experiment.record().quantity() == Quantity::Velocity;
    if !is_anywhere {
        push(Place::Position, Parameter::named(named("initial_position"), "x₀", units.position.to_string()), state);
    }
    push(Place::Velocity, Parameter::named(named("initial_velocity"), "v₀", units.velocity().to_string()), state);
    let mut count = if is_anywhere { 1 } else { 2 };
    if let Some(drive) = experiment.drive() {
        if drive.gain_uncertainty() > 0.0 {
            let name = if drive.is_force() { "force_gain" } else { "base_gain" };
            let known =
                Knowledge::Prior { value: 1.0, uncertainty: drive.gain_uncertainty(), source: Source::ForceGain };
            push(Place::DriveGain, Parameter::named(named(name), "g", "1").bounded(Bounds::POSITIVE), known);
            count += 1;
        }
        let longest = drive.longest_delay();
        if longest > 0.0 {
            let delay = Parameter::named(named("delay"), "τ", "s").bounded(Bounds::new(-longest, longest)?);
            let known = drive.delay_uncertainty.map_or(Knowledge::Free, |uncertainty| Knowledge::Prior {
                value: 0.0,
                uncertainty,
                source: Source::Timing,
            });
            push(Place::Delay, delay, known);
            count += 1;
        }
    }
    let unit = experiment.record().unit();
    if experiment.summary().held_offset.is_none() {
        push(Place::Offset, Parameter::named(named("offset"), "b", unit.to_owned()), Knowledge::Free);
    }
    let number = if experiments.len() == 1 { String::new() } else { format!("_{}", record + 1) };
    for (at, disturbance) in experiment.nuisances.iter().enumerate() {
        push(Place::Disturbance(at), disturbance.parameter(at, &number, unit), Knowledge::Free);
    }
    if experiment.sensor().has_free_corner() {
        let corner = Parameter::named(named("sensor_corner_hz"), "f_c", "Hz").bounded(experiment.corner_bounds());
        push(Place::Corner, corner, Knowledge::Free);
    }
    debug_assert!(rows.rows.len() >= first + count);
    Ok(count)
}
