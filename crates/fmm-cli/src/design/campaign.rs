//! Plan of the next tests from the document of a campaign: its machine, its friction, its noise, its loads and
//! releases.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write;

use fmm_model::Rounded;
use serde::Deserialize;

use crate::batch::FRICTION;

/// Parts of campaign.json that a plan needs.
#[derive(Debug, Deserialize)]
pub(super) struct Campaign {
    summary: Summary,
    records: Vec<Record>,
}

#[derive(Debug, Deserialize)]
struct Summary {
    quantities: Vec<Quantity>,
}

#[derive(Debug, Deserialize)]
struct Quantity {
    name: String,
    unit: String,
    loads: Option<(f64, f64)>,
    records: usize,
    mean: f64,
    u: f64,
    shared_u: f64,
}

#[derive(Debug, Deserialize)]
struct Record {
    found: Option<Found>,
}

#[derive(Debug, Deserialize)]
struct Found {
    law: String,
    /// Mass, stiffness, damping and load as they were declared: value and standard uncertainty.
    declared: BTreeMap<String, (f64, f64)>,
    rms_residual: f64,
    unit: String,
    amplitude: f64,
    rate_hz: f64,
    duration_s: f64,
    doubts: Vec<String>,
}

/// Tests of the plan.
pub(super) const TESTS: usize = 3;
/// Loads and releases that differ by less than this factor are one (1), by judgement.
const ALIKE: f64 = 1.02;

impl Campaign {
    /// The plan as a file of its own, and what more records like these would make of the uncertainty.
    pub(super) fn plan(&self) -> Result<(String, String), String> {
        let sound =
            || self.records.iter().filter_map(|record| record.found.as_ref()).filter(|found| found.doubts.is_empty());
        let first = sound()
            .next()
            .ok_or("no record of the campaign is free of doubt, so that there is nothing to plan from")?;
        let mean = |name: &str| self.summary.quantities.iter().find(|one| one.loads.is_none() && one.name == name);
        let measure = FRICTION.iter().find_map(|name| mean(name));
        let measure = measure.ok_or("the campaign has no consensus of a friction that all its records share")?;
        let frequency =
            mean("natural_frequency_hz").ok_or("the campaign has no consensus of a natural frequency")?.mean;
        let (law, damping) = match first.law.as_str() {
            "coulomb" => ("coulomb", None),
            "coulomb_viscous" | "coulomb + linear" => {
                ("coulomb + linear", mean("damping_per_mass").map(|one| one.mean))
            }
            other => {
                return Err(format!(
                    "a plan from a campaign takes coulomb or coulomb_viscous, but this one is by {other}: write the \
                     plan as a file, as `fmm design --help` shows"
                ));
            }
        };
        let (quantity, order) = motion(&first.unit)?;
        let mut text = "[machine]\n".to_owned();
        // Writing to a string does not fail.
        let [mass, stiffness] = ["mass", "stiffness"].map(|name| first.declared.get(name).copied());
        let _ = mass.map(|known| writeln!(text, "mass = {}", amount(known)));
        // Beside a mass, the tests find the stiffness: the plan takes its value only.
        let kept_u = |u: f64| if mass.is_some() { 0.0 } else { u };
        let _ = stiffness.map(|(value, u)| writeln!(text, "stiffness = {}", amount((value, kept_u(u)))));
        let loads = distinct(sound().filter_map(|found| found.declared.get("normal_load").copied()));
        // Mass and stiffness tell the frequency, and a plan takes no more than two of the three.
        if mass.is_none() || stiffness.is_none() {
            let _ = writeln!(text, "frequency = {frequency}");
        }
        let _ = loads.last().map(|load| writeln!(text, "normal_load = {}", amount(*load)));
        let damping = damping.map_or_else(String::new, |damping| format!(", damping_per_mass = {damping}"));
        // Without a load, mu is the name of the friction per mass, as in every law of a plan.
        let _ = writeln!(text, "\n[guess]\nlaw = \"{law}\"\nvalues = {{ mu = {}{damping} }}", measure.mean);
        let noise = median(sound().map(|found| found.rms_residual));
        let _ = writeln!(text, "\n[sensor]\nquantity = \"{quantity}\"\nnoise = {noise:e}");
        // Releases as they were, and half of the least.
        let released = sound().map(|found| (found.amplitude / (TAU * frequency).powi(order), 0.0));
        let released = distinct(released);
        let ends = [
            released.first().map(|least| 0.5 * least.0),
            released.first().map(|least| least.0),
            released.last().map(|most| most.0),
        ];
        let mut releases: Vec<String> = ends.into_iter().flatten().map(|release| format!("{release:.3e}")).collect();
        releases.dedup();
        let _ = writeln!(text, "\n[[candidates]]\nrelease = [{}]", releases.join(", "));
        if loads.len() > 1 {
            let loads: Vec<String> = loads.iter().map(|load| amount(*load)).collect();
            let _ = writeln!(text, "normal_load = [{}]", loads.join(", "));
        }
        let (rate, duration) =
            (median(sound().map(|found| found.rate_hz)), median(sound().map(|found| found.duration_s)));
        let _ = writeln!(
            text,
            "rate = {rate}\nduration = {duration}\n\n[choose]\naim = \"{}\"\ntests = {TESTS}",
            measure.name
        );
        Ok((text, more(measure)))
    }
}

/// u of the consensus now, and with more records that scatter as these do.
fn more(measure: &Quantity) -> String {
    let Quantity { name, unit, records, u, shared_u, .. } = measure;
    let own = (u * u - shared_u * shared_u).max(0.0);
    let with = |further: usize| (own * *records as f64 / (records + further) as f64 + shared_u * shared_u).sqrt();
    let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
    let text = |u: f64| format!("{}{unit}", Rounded::significant(u, 2));
    format!(
        "the consensus of {name} has u = {} by {records} records; {TESTS} more that scatter as these do make it {}, as \
         many again {}; what they share keeps it above {}",
        text(*u),
        text(with(TESTS)),
        text(with(*records)),
        text(*shared_u)
    )
}

/// Quantity of a record in this `unit`, and the order of its derivative of the position.
pub(super) fn motion(unit: &str) -> Result<(&'static str, i32), String> {
    match unit {
        "m" => Ok(("displacement", 0)),
        "m/s" => Ok(("velocity", 1)),
        "m/s²" => Ok(("acceleration", 2)),
        other => Err(format!("a plan needs records in m, m/s or m/s², and these are in {other}")),
    }
}

/// A number, with its standard uncertainty if it has one.
pub(super) fn amount((value, u): (f64, f64)) -> String {
    if u > 0.0 { format!("{{ value = {value}, u = {u} }}") } else { value.to_string() }
}

/// The numbers that differ, from the smallest on.
fn distinct(numbers: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut sorted: Vec<(f64, f64)> = numbers.collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    sorted.dedup_by(|next, kept| next.0 <= ALIKE * kept.0);
    sorted
}

fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}
