//! The laws by their names.

use std::error::Error;

use fmm_friction::{
    FamilyVisitor, Gms, LawError, LawFamily, LawKind, LawVisitor as _, MaxwellSlip, MaxwellSlipOf, OwnLaw, SlidingLaw,
    Smoothed, Stribeck, catalogue,
};
use fmm_sim::{Bristle, Engine as _, RungeKutta, Scenario, Trajectory, simulate_into};

use super::contact::{Contact, Make};
use super::entries::{Entries, Field};
use super::keys::{Shape, Slot};
use super::law::Given;

type Made = Result<Contact, Box<dyn Error>>;

/// A law that a scenario can name.
pub(crate) struct Entry {
    /// The name.
    pub(crate) name: &'static str,
    /// Its parameters.
    pub(crate) slots: fn() -> Vec<Slot>,
    /// The law with what was given for it, among those of one's own.
    make: fn(Given, &[&'static OwnLaw]) -> Made,
}

/// Makes entries of families.
struct AllEntries;

impl FamilyVisitor for AllEntries {
    /// None for families of elements by their number: a scenario lists its elements.
    type Output = Option<Entry>;

    fn visit<F: LawFamily>(&mut self) -> Option<Entry> {
        if F::kind() == LawKind::Elements {
            return None;
        }
        let make = |given: Given, _: &[_]| made(&given, |values| F::at(values).map(of_family::<F>));
        Some(Entry { name: F::NAME, slots: || Slot::numbers(F::NAME, F::PARAMETERS), make })
    }
}

/// Every law that a scenario can name.
pub(crate) fn laws() -> Vec<Entry> {
    catalogue(&mut AllEntries).into_iter().flatten().chain([MAXWELL_SLIP, GMS, SMOOTHED]).collect()
}

const MAXWELL_SLIP: Entry = Entry {
    name: "maxwell_slip",
    slots: || vec![Slot::of("stiffness", "κ", "1/m", Shape::List), Slot::of("level", "w", "1", Shape::List)],
    make: |given, _| {
        let elements = given.pairs()?;
        made(&given, |_| MaxwellSlip::new(&elements).map(of_family::<MaxwellSlipOf<1>>))
    },
};

const GMS: Entry = Entry {
    name: "gms",
    slots: || {
        let mut slots = Slot::numbers("gms", Stribeck::PARAMETERS);
        slots.push(Slot::of("attraction", "C", "1/s", Shape::Number));
        slots.push(Slot::of("stiffness", "κ", "1/m", Shape::List));
        slots.push(Slot::of("share", "α", "1", Shape::List));
        slots
    },
    make: |given, _| {
        let elements = given.pairs()?;
        made(&given, |values| {
            let (curve, attraction) = values.split_at(Stribeck::PARAMETERS.len());
            let law = Gms::new(Stribeck::at(curve)?, attraction[0], &elements)?;
            Ok(Make { law, automatic: |scenario, sampling| Bristle::default().run(scenario, sampling) }.bristle())
        })
    },
};

const SMOOTHED: Entry = Entry {
    name: "smoothed",
    slots: || vec![Slot::of("law", "", "", Shape::Law), Slot::of("smoothing_width", "ε", "m/s", Shape::Number)],
    make: |mut given, own| {
        let (inner, law) = contact(given.inner()?, own)?;
        let Some(law) = law.sliding else {
            return Err(format!(
                "the law {inner} has an internal state and cannot be smoothed in the speed; a law of the speed alone \
                 can, such as coulomb or stribeck"
            )
            .into());
        };
        made(&given, |values| Ok(of_speed(Smoothed::new(law, values[0])?)))
    },
};

/// A law of a family, moved by the engine that suits law and machine.
fn of_family<F: LawFamily>(law: F::At<f64>) -> Contact {
    let automatic = |scenario: &Scenario<f64, F::At<f64>>, sampling: &_| {
        let mut trajectory = Trajectory::new();
        simulate_into::<F, _>(scenario, sampling, None, &mut trajectory)?;
        Ok(trajectory)
    };
    F::visit(Make { law, automatic })
}

/// A law of the speed alone, moved by the engine for any of them.
fn of_speed<L: SlidingLaw<f64> + Clone + 'static>(law: L) -> Contact {
    Make { law, automatic: |scenario, sampling| RungeKutta::default().run(scenario, sampling) }.sliding()
}

fn made(given: &Given, make: impl FnOnce(&[f64]) -> Result<Contact, LawError>) -> Made {
    Ok(make(&given.numbers()?).map_err(|error| format!("the law {}: {error}", given.law))?)
}

/// The law of an object `{name: {parameter: value, …}}`, with its name; those of one's `own` stand before the others.
///
/// # Errors
/// If there is no such law, or its parameters are not what it needs.
pub(crate) fn contact(law: Entries, own: &[&'static OwnLaw]) -> Result<(&'static str, Contact), Box<dyn Error>> {
    let known = || {
        let names = own.iter().map(|law| law.name()).chain(laws().into_iter().map(|entry| entry.name));
        format!("the laws are {}", names.collect::<Vec<_>>().join(", "))
    };
    let Ok([(name, Field::Object(parameters))]) = <[_; 1]>::try_from(law.0) else {
        let example = "{\"coulomb\": {\"mu\": 0.2}}";
        return Err(format!("a law is an object with one key, its name, such as {example}; {}", known()).into());
    };
    if let Some(own) = own.iter().find(|own| own.name() == name) {
        let given = Given::sort(own.name(), Slot::numbers(own.name(), own.parameters()), parameters)?;
        return Ok((own.name(), made(&given, |values| own.at(values).map(of_speed))?));
    }
    let entry = laws().into_iter().find(|entry| entry.name == name);
    let entry = entry.ok_or_else(|| format!("there is no law \"{name}\"; {}", known()))?;
    let given = Given::sort(entry.name, (entry.slots)(), parameters)?;
    Ok((entry.name, (entry.make)(given, own)?))
}
