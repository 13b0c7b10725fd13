//! The laws by their names.

use fmm_friction::{
    FamilyVisitor, Gms, LawError, LawFamily, LawKind, MaxwellSlip, MaxwellSlipOf, Smoothed, Stribeck, catalogue,
};

use super::ScenarioError;
use super::contact::{AnySliding, Contact, Law, OfGms, OfSmoothed};
use super::entries::{Entries, Field};
use super::keys::{Shape, Slot};
use super::law::Given;

type Made = Result<Box<dyn Contact>, ScenarioError>;

/// A law that a scenario can name.
pub(crate) struct Entry {
    /// The name.
    pub(crate) name: &'static str,
    /// Its parameters.
    pub(crate) slots: fn() -> Vec<Slot>,
    make: fn(Given) -> Made,
}

/// Makes entries of families.
struct AllEntries;

impl FamilyVisitor for AllEntries {
    /// None for families of so many elements: a scenario lists its elements.
    type Output = Option<Entry>;

    fn visit<F: LawFamily>(&mut self) -> Option<Entry> {
        if F::kind() == LawKind::Elements {
            return None;
        }
        let make = |given: Given| made(&given, |values| F::at(values).map(Law::<F, _>::new));
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
    make: |given| {
        let elements = given.pairs()?;
        made(&given, |_| MaxwellSlip::new(&elements).map(Law::<MaxwellSlipOf<1>, _>::new))
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
    make: |given| {
        let elements = given.pairs()?;
        made(&given, |values| {
            let (curve, attraction) = values.split_at(Stribeck::PARAMETERS.len());
            Gms::new(Stribeck::at(curve)?, attraction[0], &elements).map(Law::<OfGms, _>::new)
        })
    },
};

const SMOOTHED: Entry = Entry {
    name: "smoothed",
    slots: || vec![Slot::of("law", "", "", Shape::Law), Slot::of("smoothing_width", "ε", "m/s", Shape::Number)],
    make: |mut given| {
        let (inner, law) = contact(given.inner()?)?;
        let Some(smooth) = law.into_sliding() else {
            return Err(ScenarioError::NotSliding { law: inner, known: known() });
        };
        made(&given, |values| Smoothed::new(AnySliding::new(smooth), values[0]).map(Law::<OfSmoothed, _>::new))
    },
};

fn made<C: Contact + 'static>(given: &Given, make: impl FnOnce(&[f64]) -> Result<C, LawError>) -> Made {
    let law = given.law();
    match make(&given.numbers()?) {
        Ok(contact) => Ok(Box::new(contact)),
        Err(source) => Err(ScenarioError::Law { law, source }),
    }
}

/// The names of all laws, for a message.
fn known() -> String {
    let names: Vec<&str> = laws().iter().map(|entry| entry.name).collect();
    format!("the laws are {}", names.join(", "))
}

/// The law of an object `{name: {parameter: value, …}}`, with its name.
///
/// # Errors
/// [`ScenarioError`] if there is no such law or its parameters are not what it needs.
pub(crate) fn contact(law: Entries) -> Result<(&'static str, Box<dyn Contact>), ScenarioError> {
    let Ok([(name, field)]) = <[_; 1]>::try_from(law.0) else {
        return Err(ScenarioError::NotOneLaw { known: known() });
    };
    let Some(entry) = laws().into_iter().find(|entry| entry.name == name) else {
        return Err(ScenarioError::UnknownLaw { law: name, known: known() });
    };
    let Field::Object(parameters) = field else {
        return Err(ScenarioError::NotOneLaw { known: known() });
    };
    let given = Given::sort(entry.name, (entry.slots)(), parameters)?;
    Ok((entry.name, (entry.make)(given)?))
}
