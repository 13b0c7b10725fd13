//! Fields of a record sheet: what was given, and what the records themselves say.

use fmm_model::Rounded;
use fmm_uq::Moments;
use serde::Serialize;

use super::dependence::{FRICTION, LOAD, number_in};
use super::row::{Row, quantities};
use super::sheet::{FIELDS, Sheet};

/// A field of the sheet as it is printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Field {
    pub(crate) part: &'static str,
    pub(crate) name: String,
    /// `None` where nothing is known.
    pub(crate) value: Option<String>,
    /// Whether the program knows it from the records.
    pub(crate) is_found: bool,
}

const RESULTS: &str = "Results";
const FURTHER: &str = "Further";

impl Sheet {
    /// All fields in their order, with what the records themselves say.
    pub(crate) fn fields(&self, rows: &[Row]) -> Vec<Field> {
        let field = |(part, key, words): &(&'static str, &str, &str)| {
            let given = self.given.get(*key).cloned();
            let found = if given.is_none() { found(key, rows) } else { None };
            Field { part, name: (*words).to_owned(), is_found: found.is_some(), value: given.or(found) }
        };
        let results = results(rows);
        let results = results.map(|(name, value)| Field { part: RESULTS, name, value: Some(value), is_found: true });
        let further = self.further.iter().map(|(name, value)| {
            let value = Some(value.clone()).filter(|value| !value.is_empty());
            Field { part: FURTHER, name: name.replace('_', " "), value, is_found: false }
        });
        FIELDS.iter().map(field).chain(results).chain(further).collect()
    }
}

/// What the records say of the field of this key.
fn found(key: &str, rows: &[Row]) -> Option<String> {
    let found = || rows.iter().filter_map(Row::found);
    match key {
        "motion" => found().next().map(|_| "reciprocating: a free vibration that decays".to_owned()),
        "normal_load" => range(rows.iter().filter_map(|row| number_in(row, LOAD)), "N"),
        "velocity" => {
            let unit = found().next()?.unit.as_str();
            let is_velocity = unit == "m/s" && found().all(|found| found.unit == unit);
            let largest = range(found().map(|found| found.amplitude), unit).filter(|_| is_velocity)?;
            Some(format!("falls to zero in each record, from {largest} at its beginning"))
        }
        "duration" => range(found().map(|found| found.half_swings as f64), "half swings in each record"),
        "friction_measurement" => {
            let mut laws: Vec<&str> = found().map(|found| found.law.as_str()).collect();
            laws.sort_unstable();
            laws.dedup();
            let laws = (!laws.is_empty()).then(|| laws.join(", "))?;
            Some(format!(
                "inferred, without a sensor of force: the law {laws} is fitted to each record of the motion (fmm {})",
                env!("CARGO_PKG_VERSION")
            ))
        }
        "coefficient" => found().next().map(|_| "kinetic, fitted over the whole decay".to_owned()),
        _ => None,
    }
}

/// The smallest and the largest of these values; `None` without any.
fn range(values: impl Iterator<Item = f64>, unit: &str) -> Option<String> {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let text = |value: f64| Rounded::new(value, None).to_string();
    if low > high {
        None
    } else if low == high {
        Some(format!("{} {unit}", text(low)))
    } else {
        Some(format!("{} to {} {unit}", text(low), text(high)))
    }
}

/// Number of replicates, and the mean with its spread of each measure of friction.
fn results(rows: &[Row]) -> impl Iterator<Item = (String, String)> {
    let found = rows.iter().filter_map(Row::found).count();
    let replicates = ("replicates".to_owned(), format!("{found} identified of {} records", rows.len()));
    let loads: Vec<f64> = rows.iter().filter_map(|row| number_in(row, LOAD)).collect();
    // Forces under different loads have no mean that says anything.
    let measures = if loads.iter().any(|load| *load != loads[0]) { &FRICTION[..1] } else { &FRICTION[..] };
    let measures = quantities(rows).into_iter().filter_map(|(name, unit)| {
        measures.iter().find(|measure| name.ends_with(**measure))?;
        let values: Vec<f64> = rows.iter().filter_map(|row| Some(row.told((name, unit))?.value)).collect();
        let moments = Moments::of(&values)?;
        let (mean, deviation) = (moments.mean(), moments.standard_deviation()?);
        let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
        Some((
            name.replace('_', " "),
            format!(
                "{}{unit}: mean and standard deviation of {} records; coefficient of variation {:.2} %",
                Rounded::new(mean, Some(deviation)),
                values.len(),
                100.0 * deviation / mean.abs()
            ),
        ))
    });
    std::iter::once(replicates).chain(measures.collect::<Vec<_>>())
}
