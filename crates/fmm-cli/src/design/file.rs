//! The file of a plan: machine, guess, sensor, and the tests that may be made as ranges.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use fmm_identify::{Aim, Candidate, Guess, Known, Machine, PlannedSensor, PlannedTest};
use fmm_model::{ModelError, Oscillator, Rounded};
use fmm_record::{Quantity, Record};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use crate::files;
use crate::scenario::{Entries, Field, given_twice, laws};

/// What a file asks for.
#[derive(Debug)]
pub(super) struct Wanted {
    pub(super) guess: Guess,
    pub(super) tests: Vec<PlannedTest>,
    /// For each test the value of each number that the file varies, by name.
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
    #[serde(deserialize_with = "numbers")]
    values: BTreeMap<String, f64>,
    /// Relative standard uncertainty of the values.
    within: Option<f64>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct OfSensor {
    quantity: String,
    noise: Range<f64>,
    #[serde(default)]
    gain_u: f64,
}

/// One kind of test over a grid of numbers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Candidates {
    release: Option<Range<f64>>,
    blow: Option<Range<f64>>,
    pulse: Option<Range<f64>>,
    force: Option<Range<f64>>,
    base: Option<Range<f64>>,
    frequency: Option<Range<f64>>,
    normal_load: Option<Range<Amount>>,
    added_mass: Option<Range<Amount>>,
    added_stiffness: Option<Range<Amount>>,
    rate: Range<f64>,
    duration: Range<f64>,
    sensor: Option<OfSensor>,
    #[serde(default = "yes")]
    contact: bool,
    #[serde(default = "yes")]
    offset: bool,
    #[serde(default = "one")]
    cost: f64,
}

/// What is to be chosen.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Choose {
    pub(super) aim: String,
    pub(super) tests: Option<usize>,
    pub(super) budget: Option<f64>,
    pub(super) robust: Option<Robust>,
    #[serde(default = "draws")]
    pub(super) draws: usize,
    #[serde(default = "seed")]
    pub(super) seed: u64,
}

/// Over what may be guessed wrong: the mean of ln u, or the worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Robust {
    Mean,
    Worst,
}

/// A number, or one with its standard uncertainty.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "a number, or { value = …, u = … }")]
enum Amount {
    Exact(f64),
    With { value: f64, u: f64 },
}

/// One, or a list.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "a number, or a list of numbers")]
enum Range<T> {
    One(T),
    Several(Vec<T>),
}

fn yes() -> bool {
    true
}

fn one() -> f64 {
    1.0
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

/// Tests in a file at most.
const MOST: usize = 10_000;

impl Amount {
    fn known(self) -> Result<Known, Box<dyn Error>> {
        Ok(match self {
            Self::Exact(value) => Known::exact(value)?,
            Self::With { value, u } => Known::new(value, u)?,
        })
    }

    const fn value(self) -> f64 {
        match self {
            Self::Exact(value) | Self::With { value, .. } => value,
        }
    }
}

impl<T: Clone> Range<T> {
    fn values(&self) -> Vec<T> {
        match self {
            Self::One(value) => vec![value.clone()],
            Self::Several(values) => values.clone(),
        }
    }
}

impl Choose {
    /// What is to be small.
    pub(super) fn aim(&self) -> Aim {
        match self.aim.as_str() {
            "determinant" => Aim::Determinant,
            "mean variance" => Aim::MeanVariance,
            name => Aim::finding(name),
        }
    }
}

impl Wanted {
    /// Reads the file, which is JSON if its name ends so, and TOML otherwise.
    pub(super) fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        Ok(Self::of(files::document(path)?).map_err(files::named(path))?)
    }

    #[cfg(test)]
    pub(super) fn of_toml(text: &str) -> Result<Self, Box<dyn Error>> {
        Self::of(toml::from_str(text)?)
    }

    fn of(file: File) -> Result<Self, Box<dyn Error>> {
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
        let guess = Guess::new(machine, &candidate, frequency, &values, &beside)?;
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

impl OfSensor {
    fn sensor(&self, noise: f64) -> Result<PlannedSensor, Box<dyn Error>> {
        let quantity = match self.quantity.as_str() {
            "displacement" => Quantity::Displacement,
            "velocity" => Quantity::Velocity,
            "acceleration" => Quantity::Acceleration,
            other => {
                return Err(format!(
                    "there is no sensor of {other:?}; there are displacement, velocity and acceleration"
                )
                .into());
            }
        };
        Ok(PlannedSensor::new(quantity, noise)?.with_gain_uncertainty(self.gain_u)?)
    }
}

/// Names and values of what is varied, one list each.
type Axes = Vec<(&'static str, Vec<Amount>)>;

impl Candidates {
    fn axes(&self, sensor: &OfSensor) -> Axes {
        let exact = |range: &Range<f64>| range.values().into_iter().map(Amount::Exact).collect::<Vec<_>>();
        let optional = |range: &Option<Range<f64>>| range.as_ref().map(exact);
        let amounts = |range: &Option<Range<Amount>>| range.as_ref().map(Range::values);
        let axes = [
            ("release", optional(&self.release)),
            ("blow", optional(&self.blow)),
            ("pulse", optional(&self.pulse)),
            ("force", optional(&self.force)),
            ("base", optional(&self.base)),
            ("frequency", optional(&self.frequency)),
            ("normal_load", amounts(&self.normal_load)),
            ("added_mass", amounts(&self.added_mass)),
            ("added_stiffness", amounts(&self.added_stiffness)),
            ("rate", Some(exact(&self.rate))),
            ("duration", Some(exact(&self.duration))),
            ("noise", Some(exact(&sensor.noise))),
        ];
        axes.into_iter().filter_map(|(name, values)| Some((name, values?))).collect()
    }

    /// Adds the tests of the grid, the last number changing first.
    fn add(
        &self,
        sensor: &OfSensor,
        tests: &mut Vec<PlannedTest>,
        settings: &mut Vec<BTreeMap<&'static str, f64>>,
    ) -> Result<(), Box<dyn Error>> {
        let sensor = self.sensor.as_ref().unwrap_or(sensor);
        let axes = self.axes(sensor);
        let count = axes.iter().try_fold(1usize, |count, (_, values)| count.checked_mul(values.len()));
        let count = count.filter(|count| count.saturating_add(tests.len()) <= MOST);
        let count = count.ok_or_else(|| format!("the candidates are more than {MOST} tests; give fewer numbers"))?;
        if count == 0 {
            return Err("[[candidates]] has a list without a number".into());
        }
        for number in 0..count {
            let mut rest = number;
            let mut point: BTreeMap<&'static str, Amount> = BTreeMap::new();
            for (name, values) in axes.iter().rev() {
                point.insert(name, values[rest % values.len()]);
                rest /= values.len();
            }
            let varied = axes.iter().filter(|(name, values)| values.len() > 1 || is_kind(name));
            let name =
                varied.map(|(name, _)| format!("{} {}{}", name.replace('_', " "), point[name].value(), unit(name)));
            let name = name.collect::<Vec<_>>().join(", ");
            tests.push(self.test(&point, sensor)?.named(name));
            settings.push(point.into_iter().map(|(name, amount)| (name, amount.value())).collect());
        }
        Ok(())
    }

    fn test(&self, point: &BTreeMap<&'static str, Amount>, sensor: &OfSensor) -> Result<PlannedTest, Box<dyn Error>> {
        let number = |name: &str| point.get(name).map(|amount| amount.value());
        let needed =
            |name: &str, of: &str| number(name).ok_or_else(|| format!("[[candidates]] with a {of} needs {name}"));
        let (rate, duration) = (needed("rate", "test")?, needed("duration", "test")?);
        let seen_by = sensor.sensor(needed("noise", "sensor")?)?;
        let harmonic = |amplitude: f64, of: &str, quantity: Quantity, unit: &str| -> Result<Record, Box<dyn Error>> {
            let frequency = needed("frequency", of)?;
            ModelError::require_positive("frequency of a sine", frequency, "Hz")?;
            if !(frequency < 0.5 * rate) {
                let [frequency, rate, half] = [frequency, rate, 0.5 * rate].map(Rounded::every_digit);
                return Err(format!(
                    "a {of} of {frequency} Hz cannot be seen at the rate of {rate} Hz: its frequency must be below half the rate, {half} Hz"
                )
                .into());
            }
            let count = rate * duration;
            if !(16.0..=1e7).contains(&count) {
                let count = Rounded::every_digit(count);
                return Err(format!("a test has 16 to 10 million samples, not {count}").into());
            }
            let at = |i: usize| amplitude * (std::f64::consts::TAU * frequency * i as f64 / rate).sin();
            Ok(Record::sampled(rate, (0..=count.ceil() as usize).map(at).collect(), quantity, unit)?)
        };
        let kinds = ["release", "blow", "force", "base"].into_iter().filter_map(|kind| Some((kind, number(kind)?)));
        let kinds: Vec<_> = kinds.collect();
        if let [(kind, _)] = kinds[..] {
            let stray = OF_KINDS.iter().find(|(field, takers)| point.contains_key(field) && !takers.contains(&kind));
            if let Some((field, takers)) = stray {
                let takers = takers.join(" and ");
                return Err(format!("[[candidates]] with a {kind} takes no {field}, which belongs to {takers}").into());
            }
        }
        if !self.contact && self.normal_load.is_some() {
            return Err(
                "[[candidates]] with contact = false takes no normal_load, which belongs to tests with the contact"
                    .into(),
            );
        }
        let test =
            match kinds[..] {
                [("release", position)] => PlannedTest::release(position, seen_by, rate, duration)?,
                [("blow", peak)] => PlannedTest::impact(peak, needed("pulse", "blow")?, seen_by, rate, duration)?,
                [("force", amplitude)] => {
                    PlannedTest::pushed(&harmonic(amplitude, "force", Quantity::Force, "N")?, 0.0, seen_by, rate)?
                }
                [("base", amplitude)] => {
                    PlannedTest::carried(&harmonic(amplitude, "base", Quantity::Acceleration, "m/s²")?, seen_by, rate)?
                }
                _ => return Err(
                    "[[candidates]] needs one of release, blow, force and base, to say what sets the machine in motion"
                        .into(),
                ),
            };
        let mut test = test.costing(self.cost)?;
        if let Some(load) = point.get("normal_load") {
            test = test.under_load(load.known()?)?;
        }
        if let Some(mass) = point.get("added_mass") {
            test = test.with_added_mass(mass.known()?)?;
        }
        if let Some(stiffness) = point.get("added_stiffness") {
            test = test.with_added_stiffness(stiffness.known()?)?;
        }
        if !self.contact {
            test = test.without_contact();
        }
        Ok(if self.offset { test } else { test.without_offset() })
    }
}

/// Fields that only some kinds of test take, and these kinds.
const OF_KINDS: [(&str, &[&str]); 2] = [("pulse", &["blow"]), ("frequency", &["force", "base"])];

fn is_kind(name: &str) -> bool {
    matches!(name, "release" | "blow" | "force" | "base")
}

/// The unit of a number that a file varies, after a space.
pub(super) fn unit(name: &str) -> &'static str {
    match name {
        "release" => " m",
        "blow" | "force" | "normal_load" => " N",
        "base" => " m/s²",
        "pulse" | "duration" => " s",
        "frequency" | "rate" => " Hz",
        "added_mass" => " kg",
        "added_stiffness" => " N/m",
        _ => "",
    }
}
