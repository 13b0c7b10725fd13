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
    /// Whether it is a law of the sliding speed alone, which can be smoothed in it.
    is_of_speed: bool,
}

/// Laws of the sliding speed that have another level while the speed falls.
const OF_ACCELERATION: [&str; 2] = ["acceleration_coulomb", "exponential_pair"];

/// Makes entries of families.
struct AllEntries;

impl FamilyVisitor for AllEntries {
    /// None for families of so many elements: a scenario lists its elements.
    type Output = Option<Entry>;

    fn visit<F: LawFamily>(&mut self) -> Option<Entry> {
        let is_of_speed = match F::kind() {
            LawKind::Elements => return None,
            LawKind::Bristle => false,
            LawKind::Sliding | LawKind::PiecewiseLinear => !OF_ACCELERATION.contains(&F::NAME),
        };
        let make = |given: Given| made(&given, |values| F::at(values).map(Law::<F, _>::new));
        Some(Entry { name: F::NAME, slots: || Slot::numbers(F::NAME, F::PARAMETERS), make, is_of_speed })
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
    is_of_speed: false,
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
    is_of_speed: false,
};

const SMOOTHED: Entry = Entry {
    name: "smoothed",
    slots: || vec![Slot::of("law", "", "", Shape::Law), Slot::of("smoothing_width", "ε", "m/s", Shape::Number)],
    make: |mut given| {
        let (inner, law) = contact(given.inner()?)?;
        let Some(smooth) = law.into_sliding() else {
            return Err(ScenarioError::NotSliding { law: inner, known: named(|entry| entry.is_of_speed) });
        };
        made(&given, |values| Smoothed::new(AnySliding::new(smooth), values[0]).map(Law::<OfSmoothed, _>::new))
    },
    is_of_speed: true,
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
    format!("the laws are {}", named(|_| true))
}

/// The names of the laws of which this is true.
fn named(is_meant: impl Fn(&Entry) -> bool) -> String {
    let names: Vec<&str> = laws().iter().filter(|entry| is_meant(entry)).map(|entry| entry.name).collect();
    names.join(", ")
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
