//! Tests that may be made: kinds of test over grids of numbers.

use std::collections::BTreeMap;
use std::error::Error;

use fmm_identify::Known;
use fmm_identify::design::{PlannedSensor, PlannedTest};
use fmm_model::{ModelError, Rounded};
use fmm_record::{Quantity, Record};
use serde::Deserialize;

use crate::input::motion_called;

/// A number, or one with its standard uncertainty.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "a number, or { value = …, u = … }")]
pub(super) enum Amount {
    Exact(f64),
    With { value: f64, u: f64 },
}

/// One, or a list.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "a number, or a list of numbers")]
pub(super) enum Range<T> {
    One(T),
    Several(Vec<T>),
}

impl Amount {
    pub(super) fn known(self) -> Result<Known, Box<dyn Error>> {
        Ok(match self {
            Self::Exact(value) => Known::exact(value)?,
            Self::With { value, u } => Known::new(value, u)?,
        })
    }

    pub(super) const fn value(self) -> f64 {
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

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OfSensor {
    quantity: String,
    noise: Range<f64>,
    #[serde(default)]
    gain_u: f64,
}

/// One kind of test over a grid of numbers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Candidates {
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

fn yes() -> bool {
    true
}

fn one() -> f64 {
    1.0
}

/// Tests in a file at most.
const MOST: usize = 10_000;

impl OfSensor {
    fn sensor(&self, noise: f64) -> Result<PlannedSensor, Box<dyn Error>> {
        let unknown =
            format!("there is no sensor of {:?}; there are displacement, velocity and acceleration", self.quantity);
        let quantity = motion_called(&self.quantity).ok_or(unknown)?;
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
    pub(super) fn add(
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
                    "a {of} of {frequency} Hz cannot be seen at the rate of {rate} Hz: its frequency must be below \
                     half the rate, {half} Hz"
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
