//! File of a plan: machine, guess, sensor, tests and choice.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt;

use fmm_identify::design::{Aim, Guess, PlannedTest};
use fmm_identify::{Candidate, Machine};
use fmm_model::{Oscillator, Rounded};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::candidates::{Amount, Candidates, OfSensor};
use crate::scenario::{Entries, Field, given_twice, laws};

/// Content of a plan.
#[derive(Debug)]
pub(super) struct Wanted {
    pub(super) guess: Guess,
    pub(super) tests: Vec<PlannedTest>,
    /// Values of the numbers that the file varies, by name, for each test.
    pub(super) settings: Vec<BTreeMap<&'static str, f64>>,
    pub(super) choose: Choose,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    machine: OfMachine,
    guess: Guessed,
    sensor: OfSensor,
    candidates: Vec<Candidates>,
    choose: Choose,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OfMachine {
    mass: Option<Amount>,
    stiffness: Option<Amount>,
    frequency: Option<f64>,
    normal_load: Option<Amount>,
    damping: Option<Amount>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Guessed {
    law: String,
    #[serde(default, deserialize_with = "numbers")]
    values: BTreeMap<String, f64>,
    /// Values by the names of a fit, in place of those of the law.
    #[serde(default, deserialize_with = "numbers")]
    findings: BTreeMap<String, f64>,
    /// Relative standard uncertainty of the values.
    within: Option<f64>,
}

/// Choice to be made.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Choose {
    pub(super) aim: OfAim,
    pub(super) tests: Option<usize>,
    pub(super) budget: Option<f64>,
    pub(super) robust: Option<Robust>,
    #[serde(default = "draws")]
    pub(super) draws: usize,
    #[serde(default = "seed")]
    pub(super) seed: u64,
}

/// Quantity that is to become certain.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, deny_unknown_fields, expecting = "a name in quotes, or { friction_at = … } with a speed in m/s")]
pub(super) enum OfAim {
    Name(String),
    FrictionAt { friction_at: f64 },
}

/// Over what may be guessed wrong: the mean of ln u, or the worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Robust {
    Mean,
    Worst,
}

fn draws() -> usize {
    24
}

fn seed() -> u64 {
    1
}

/// Numbers by their names, each name once: a map would keep the last that JSON has.
fn numbers<'de, D: Deserializer<'de>>(deserializer: D) -> Result<BTreeMap<String, f64>, D::Error> {
    let Field::Object(Entries(entries)) = Field::deserialize(deserializer)? else {
        return Err(D::Error::custom("values are numbers by their names"));
    };
    let number = |(key, field)| match field {
        Field::Number(number) => Ok((key, number)),
        _ => Err(D::Error::custom(format_args!("{key} must be a number"))),
    };
    entries.into_iter().map(number).collect()
}

impl OfAim {
    /// Aim of the choice.
    pub(super) fn aim(&self) -> Aim {
        match self {
            Self::Name(name) => match name.as_str() {
                "determinant" => Aim::Determinant,
                "mean variance" => Aim::MeanVariance,
                name => Aim::finding(name),
            },
            Self::FrictionAt { friction_at } => Aim::FrictionAt(*friction_at),
        }
    }
}

impl fmt::Display for OfAim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => f.write_str(name),
            Self::FrictionAt { friction_at: 0.0 } => f.write_str("friction at rest"),
            Self::FrictionAt { friction_at } => write!(f, "friction at {} m/s", Rounded::every_digit(*friction_at)),
        }
    }
}

impl Wanted {
    #[cfg(test)]
    pub(super) fn of_toml(text: &str) -> Result<Self, Box<dyn Error>> {
        Self::of(toml::from_str(text)?)
    }

    /// The plan of a file.
    pub(super) fn of(file: File) -> Result<Self, Box<dyn Error>> {
        if file.choose.tests.is_some() == file.choose.budget.is_some() {
            return Err("[choose] needs tests, their number, or budget, what they may cost: one of the two".into());
        }
        if !(1..=1000).contains(&file.choose.draws) {
            return Err(format!("[choose] draws must be 1 to 1000, not {}", file.choose.draws).into());
        }
        let guess = file.guess.guess(&file.machine)?;
        if file.choose.robust.is_some() && file.guess.within.is_none() {
            return Err(
                "[choose] robust needs within in [guess], the relative standard uncertainty of the values".into()
            );
        }
        let (mut tests, mut settings) = (Vec::new(), Vec::new());
        for candidates in &file.candidates {
            candidates.add(&file.sensor, &mut tests, &mut settings)?;
        }
        Ok(Self { guess, tests, settings, choose: file.choose })
    }
}

impl OfMachine {
    /// The machine and its natural frequency (Hz).
    fn machine(&self) -> Result<(Machine, f64), Box<dyn Error>> {
        let (machine, frequency) = match (self.mass, self.stiffness, self.frequency) {
            (Some(mass), Some(stiffness), None) => {
                let frequency = Oscillator::new(mass.value(), stiffness.value())?.natural_frequency();
                match stiffness {
                    Amount::With { .. } => {
                        return Err(
                            "[machine] has mass and stiffness, of which the tests find the second: leave out its u"
                                .into(),
                        );
                    }
                    Amount::Exact(_) => (Machine::of_mass(mass.known()?)?, frequency),
                }
            }
            (Some(mass), None, Some(frequency)) => (Machine::of_mass(mass.known()?)?, frequency),
            (None, Some(stiffness), Some(frequency)) => (Machine::of_stiffness(stiffness.known()?)?, frequency),
            (None, None, Some(frequency)) => (Machine::per_unit_mass(), frequency),
            _ => return Err("[machine] needs two of mass, stiffness and frequency, or the frequency alone".into()),
        };
        let machine = match self.damping {
            Some(damping) => machine.with_damping(damping.known()?)?,
            None => machine,
        };
        Ok(match self.normal_load {
            Some(load) => (machine.with_normal_load(load.known()?)?, frequency),
            None => (machine, frequency),
        })
    }
}

impl Guessed {
    fn guess(&self, machine: &OfMachine) -> Result<Guess, Box<dyn Error>> {
        let candidate = Candidate::named(&self.law)?;
        if !self.findings.is_empty() {
            if !self.values.is_empty() {
                return Err("[guess] has values of the law and findings of a fit: give one of them".into());
            }
            let (machine, frequency) = machine.machine()?;
            let found: Vec<(&str, f64)> = self.findings.iter().map(|(name, value)| (name.as_str(), *value)).collect();
            return self.spread(Guess::of_findings(machine, &candidate, frequency, &found)?);
        }
        let law = candidate.law_name();
        let entry = laws().into_iter().find(|entry| entry.name == law);
        let slots = entry.map(|entry| (entry.slots)()).ok_or_else(|| format!("{law} cannot be guessed in a file"))?;
        let mut values = Vec::with_capacity(slots.len());
        for slot in &slots {
            let mut given = self.values.iter().filter(|(key, _)| slot.is(key));
            let value = given.next().map(|(_, value)| *value).or(slot.default);
            if let Some((key, _)) = given.next() {
                return Err(format!("[guess] values: {}", given_twice(law, slot, key)).into());
            }
            values.push(value.ok_or_else(|| format!("[guess] values of {law} lack {}", slot.description()))?);
        }
        let beside: Vec<(&str, f64)> = self
            .values
            .iter()
            .filter(|(key, _)| !slots.iter().any(|slot| slot.is(key)))
            .map(|(key, value)| (key.as_str(), *value))
            .collect();
        let (machine, frequency) = machine.machine()?;
        self.spread(Guess::new(machine, &candidate, frequency, &values, &beside)?)
    }

    /// The `guess` with values that may be off.
    fn spread(&self, guess: Guess) -> Result<Guess, Box<dyn Error>> {
        let Some(within) = self.within else { return Ok(guess) };
        if !(within > 0.0 && within.is_finite()) {
            let given = Rounded::every_digit(within);
            return Err(format!(
                "[guess] within is a relative standard uncertainty, which must be positive and finite, not {given}"
            )
            .into());
        }
        let known: Vec<(String, f64)> = guess
            .parameters()
            .iter()
            .zip(guess.values())
            .skip(1)
            .filter(|(_, value)| **value != 0.0)
            .map(|(parameter, value)| (parameter.name().to_owned(), within * value.abs()))
            .collect();
        let known: Vec<(&str, f64)> = known.iter().map(|(name, u)| (name.as_str(), *u)).collect();
        Ok(guess.within(&known).map_err(|error| format!("[guess] within: {error}"))?)
    }
}
