//! Rows of forces along motions: law, terms, and the deflection of the bristles at the beginning of each record.

use fmm_model::{Bounds, Parameter};

use crate::candidate::Candidate;
use crate::error::IdentifyError;
use crate::experiment::deflections::Deflections;
use crate::experiment::force::ForceRecord;
use crate::law::naming::{Form, Units};
use crate::machine::Terms;
use crate::machine::term::Term;
use crate::quantities::rows::{Builder, Knowledge, Place};
use crate::quantities::table::Table;

/// Samples of delay that are looked for unless a longest delay is given.
const SAMPLES_OF_DELAY: f64 = 20.0;

/// Refuses steady states without a time for a law or a term that depends on it.
fn require_timeless(candidate: &Candidate) -> Result<(), IdentifyError> {
    let Candidate { law, terms } = candidate;
    let needs = |what: &str| {
        IdentifyError::contradiction(format!(
            "{what} depends on time or position, of which steady states have none; take a law of the speed, damping \
             and zero, or give the times"
        ))
    };
    if !law.is_of_speed() {
        return Err(needs(law.name));
    }
    let of_time = [Term::Inertia, Term::Stiffness, Term::Gravity, Term::Delay];
    let term = of_time.into_iter().find(|term| terms.has(*term)).and_then(Term::name);
    term.map_or(Ok(()), |name| Err(needs(name)))
}

/// Refuses records that do not go together, or that lack something that the `terms` need.
fn require_records(terms: &Terms, records: &[ForceRecord]) -> Result<(), IdentifyError> {
    let first = records.first();
    let first = first.ok_or_else(|| IdentifyError::missing("there is no record to identify; give at least one"))?;
    for record in records {
        record.require_units([first.position_unit(), first.force_unit()])?;
        let names = |record: &ForceRecord| record.channels.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        if terms.has(Term::Channels) && names(record) != names(first) {
            return Err(IdentifyError::contradiction(format!(
                "the records have different channels beside the force: {:?} and {:?}",
                names(first),
                names(record)
            )));
        }
        if record.loads.is_some() != first.loads.is_some() {
            return Err(IdentifyError::contradiction(
                "some of the records have a normal load and some have not; give all of them, or none",
            ));
        }
    }
    if terms.has(Term::LoadOffset) && first.loads.is_none() {
        return Err(IdentifyError::missing("a load offset needs a normal load that was measured"));
    }
    if terms.has(Term::Channels) && first.channels.is_empty() {
        return Err(IdentifyError::missing(
            "the model has channels beside the force, but none was given with a record",
        ));
    }
    Ok(())
}

impl Table {
    /// Table and parameters of `family` with `terms` for these records of forces: law, then the terms that are one
    /// factor each, then asymmetry, load offset and delay, then the deflections.
    pub(crate) fn of_forces(
        candidate: &Candidate,
        records: &[ForceRecord],
    ) -> Result<(Self, Vec<Parameter>), IdentifyError> {
        let Candidate { law: family, mut terms } = candidate.clone();
        terms.require_force()?;
        if terms.has_linear_damping() && family.has_slope() {
            return Err(IdentifyError::two_dampings(family.name));
        }
        family.require_units()?;
        require_records(&terms, records)?;
        if records.iter().any(ForceRecord::is_timeless) {
            require_timeless(candidate)?;
        }
        let first = &records[0];
        let units = Units::new(first.position_unit(), first.force_unit());
        let form = if first.loads.is_some() { Form::Coefficient } else { Form::Force };
        let shortest = records.iter().map(ForceRecord::interval).fold(f64::INFINITY, f64::min);
        let longest = terms.longest_delay.unwrap_or(SAMPLES_OF_DELAY * shortest);
        if terms.has(Term::Delay) {
            // Other records are fitted and predicted with the delays that these allow.
            terms = terms.with_delay_up_to(longest);
        }
        let mut rows = Builder::default();
        for (number, parameter) in family.fitted().enumerate() {
            rows.free(Place::Law(number), units.fitted(parameter, form));
        }
        let is_shape = |term: &Term| !matches!(term, Term::Asymmetry | Term::LoadOffset | Term::Delay);
        let (shapes, others): (Vec<Term>, Vec<Term>) = terms.iter().partition(is_shape);
        for term in shapes.into_iter().chain(others) {
            match term.force_parameter(&units, terms.damping_bounds()) {
                Some(parameter) => rows.free(Place::Term(term), parameter),
                None if term == Term::Delay => {
                    let bounds = Bounds::new(-longest, longest)?;
                    rows.free(Place::Term(term), Parameter::new("delay", "τ", "s").bounded(bounds));
                }
                None => {
                    for (place, (name, _)) in first.channels.iter().enumerate() {
                        let name = format!("share_of_{}", name.replace([' ', '-'], "_"));
                        rows.free(Place::Channel(place), Parameter::named(name, "κ", "1"));
                    }
                }
            }
        }
        let shared = rows.rows.len();
        let mut own = Vec::with_capacity(records.len());
        for record in 0..records.len() {
            own.push(rows.rows.len());
            if family.is_of_speed() {
                continue;
            }
            let number = if records.len() == 1 { String::new() } else { format!("_{}", record + 1) };
            let deflection = Parameter::named(format!("initial_deflection{number}"), "z₀/z_max", "1");
            let deflection = deflection.bounded(Bounds::new(-1.0, 1.0)?);
            rows.push(Place::Deflection, Some(record), deflection, Knowledge::Free);
        }
        let Builder { rows, mut parameters } = rows;
        let natural = parameters.iter().map(Parameter::bounds).collect();
        let of_motion = vec![0; records.len()];
        let (oscillator, law) = (0, 0);
        let deflections = Deflections::default();
        let mut table =
            Self { family, terms, units, form, rows, natural, oscillator, law, shared, own, of_motion, deflections };
        table.settle(&mut parameters)?;
        Ok((table, parameters))
    }
}
