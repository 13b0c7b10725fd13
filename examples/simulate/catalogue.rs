//! The laws by their names.

use fmm_friction::{
    AccelerationCoulomb, Berger, BoucWen, BristleLaw, Coulomb, CoulombStatic, CoulombViscous, Dahl, ExponentialPair,
    Gms, Hyperbolic, Karnopp, LawError, LawFamily, LuGre, MakkarDixon, MaxwellSlip, PiecewiseLinearLaw, PowerLaw,
    RegularisedStribeck, Shifted, SlidingLaw, Smoothed, Stribeck, StribeckLorentzian, Viscous,
};
use fmm_sim::Simulated;

use super::ScenarioError;
use super::contact::{Affine, AnySliding, Bristled, Contact, Sliding};
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

/// Every law that a scenario can name.
pub(crate) const CATALOGUE: &[Entry] = &[
    affine::<Viscous>(),
    affine::<Coulomb>(),
    affine::<CoulombStatic>(),
    affine::<CoulombViscous>(),
    affine::<AccelerationCoulomb>(),
    sliding::<Stribeck>(),
    sliding::<StribeckLorentzian>(),
    sliding::<Hyperbolic>(),
    sliding::<Berger>(),
    sliding::<PowerLaw>(),
    sliding::<ExponentialPair>(),
    sliding::<Karnopp>(),
    sliding::<MakkarDixon>(),
    sliding::<Shifted<MakkarDixon>>(),
    sliding::<RegularisedStribeck>(),
    bristled::<Dahl>(),
    bristled::<LuGre>(),
    bristled::<BoucWen>(),
    MAXWELL_SLIP,
    GMS,
    SMOOTHED,
];

const fn affine<F: Simulated>() -> Entry
where
    F::At<f64>: PiecewiseLinearLaw<f64> + SlidingLaw<f64> + 'static,
{
    Entry { name: F::NAME, slots: slots::<F>, make: |given| made(&given, Affine::<F>::of) }
}

const fn sliding<F: Simulated>() -> Entry
where
    F::At<f64>: SlidingLaw<f64> + 'static,
{
    Entry { name: F::NAME, slots: slots::<F>, make: |given| made(&given, Sliding::<F>::of) }
}

const fn bristled<F: Simulated>() -> Entry
where
    F::At<f64>: BristleLaw<f64> + 'static,
{
    Entry { name: F::NAME, slots: slots::<F>, make: |given| made(&given, Bristled::<F>::of) }
}

const MAXWELL_SLIP: Entry = Entry {
    name: "maxwell_slip",
    slots: || vec![Slot::of("stiffness", "κ", "1/m", Shape::List), Slot::of("level", "w", "1", Shape::List)],
    make: |given| {
        let elements = given.pairs()?;
        made(&given, |_| MaxwellSlip::new(&elements))
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
            Gms::new(Stribeck::at(curve)?, attraction[0], &elements)
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
        made(&given, |values| Smoothed::new(AnySliding::new(smooth), values[0]))
    },
};

fn slots<F: LawFamily>() -> Vec<Slot> {
    Slot::numbers(F::NAME, F::PARAMETERS)
}

fn made<C: Contact + 'static>(given: &Given, make: impl FnOnce(&[f64]) -> Result<C, LawError>) -> Made {
    let law = given.law();
    match make(&given.numbers()?) {
        Ok(contact) => Ok(Box::new(contact)),
        Err(source) => Err(ScenarioError::Law { law, source }),
    }
}

/// The names of all laws, for a message.
fn known() -> String {
    let names: Vec<&str> = CATALOGUE.iter().map(|entry| entry.name).collect();
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
    let Some(entry) = CATALOGUE.iter().find(|entry| entry.name == name) else {
        return Err(ScenarioError::UnknownLaw { law: name, known: known() });
    };
    let Field::Object(parameters) = field else {
        return Err(ScenarioError::NotOneLaw { known: known() });
    };
    let given = Given::sort(entry.name, (entry.slots)(), parameters)?;
    Ok((entry.name, (entry.make)(given)?))
}
