//! The record sheet of a campaign: what a friction coefficient must be handed on with, so that others can use it.
//!
//! Its fields are those that ASTM G115 (guide for measuring and reporting friction coefficients) asks for, as far as is
//! public.

use std::collections::BTreeMap;

use fmm_model::Rounded;
use fmm_uq::Moments;
use serde::{Deserialize, Serialize};
use toml::de::{DeTable, DeValue};

use super::dependence::{FRICTION, LOAD, number_in};
use super::manifest::{at, cells};
use super::row::{Row, in_unit, quantities};
use crate::figure::ends;

/// Entries of a manifest under `[sheet]`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Sheet {
    /// By key of [`FIELDS`].
    given: BTreeMap<String, String>,
    /// Under `[sheet.further]`.
    further: BTreeMap<String, String>,
}

/// Part, key, words and term of each field that can be given. Terms are classes of the TriboDataFAIR ontology 0.1.1
/// (`tdo:`), or properties of a data set of schema.org; empty where neither has one.
const FIELDS: &[(&str, &str, &str, &str)] = &[
    ("Test", "laboratory", "laboratory", "tdo:ResearchInstitutionName"),
    ("Test", "operator", "operator", "tdo:OperatorPersonalIdentifiers"),
    ("Test", "date", "date", "schema:temporalCoverage"),
    ("Test", "purpose", "purpose", "schema:description"),
    ("Device", "device", "test device", "tdo:EquipmentNonSpecificIdentificatoryName"),
    ("Device", "geometry", "geometry of the contact", "tdo:PrescribedTypeOfTribologicalContact"),
    ("Device", "contact_area", "contact area or dimensions", ""),
    ("Moving specimen", "moving_material", "material", "tdo:MaterialName"),
    ("Moving specimen", "moving_composition", "composition", ""),
    ("Moving specimen", "moving_treatment", "treatment or coating", ""),
    ("Moving specimen", "moving_hardness", "hardness", ""),
    ("Moving specimen", "moving_finish", "surface finish", ""),
    ("Moving specimen", "moving_roughness", "roughness", ""),
    ("Fixed specimen", "fixed_material", "material", "tdo:MaterialName"),
    ("Fixed specimen", "fixed_composition", "composition", ""),
    ("Fixed specimen", "fixed_treatment", "treatment or coating", ""),
    ("Fixed specimen", "fixed_hardness", "hardness", ""),
    ("Fixed specimen", "fixed_finish", "surface finish", ""),
    ("Fixed specimen", "fixed_roughness", "roughness", ""),
    ("Conditions", "motion", "type of motion", "tdo:TribologicalMotionType"),
    ("Conditions", "normal_load", "normal load or pressure", "tdo:NormalLoadSetpoint"),
    ("Conditions", "velocity", "sliding velocity", ""),
    ("Conditions", "temperature", "temperature", "tdo:UncontrolledEnvironmentTemperature"),
    ("Conditions", "humidity", "relative humidity", "tdo:UncontrolledEnvironmentRelativeHumidity"),
    ("Conditions", "atmosphere", "atmosphere", "tdo:SurroundingMediumType"),
    ("Conditions", "lubricant", "lubricant", "tdo:InterfacialMediumRelatedName"),
    ("Procedure", "cleaning", "cleaning of the specimens", "tdo:SpecimenCleaningProcedureType"),
    ("Procedure", "run_in", "run-in", ""),
    ("Procedure", "duration", "duration or number of cycles", ""),
    ("Measurement", "friction_measurement", "how friction is measured", "tdo:MeasuringMethod"),
    ("Measurement", "coefficient", "static or kinetic", ""),
    (DATA, "title", "title", "schema:name"),
    (DATA, "authors", "authors", "schema:creator"),
    (DATA, "published", "year of publication", "schema:datePublished"),
    (DATA, "identifier", "DOI or address", "schema:identifier"),
    (DATA, "licence", "licence", "schema:license"),
];

/// The data that the sheet describes, and how they are cited.
const DATA: &str = "Data";

/// A field of the sheet as it is printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Field {
    pub(crate) part: &'static str,
    /// Name in a manifest; empty for results.
    pub(crate) key: String,
    /// Class or property of linked data; empty where there is none.
    pub(crate) term: &'static str,
    pub(crate) name: String,
    /// `None` where nothing is known.
    pub(crate) value: Option<String>,
    /// True if the value follows from the records.
    pub(crate) is_found: bool,
}

const RESULTS: &str = "Results";
const FURTHER: &str = "Further";

impl Sheet {
    /// Of the table `[sheet]` of a manifest.
    pub(super) fn of_toml(text: &str, table: &DeTable<'_>) -> Result<Self, String> {
        let mut sheet = Self::default();
        let mut known = DeTable::new();
        for (key, value) in table {
            let name = key.get_ref().as_ref();
            match value.get_ref() {
                DeValue::Table(further) if name == "further" => {
                    sheet.further = cells(text, further)?.into_iter().collect();
                }
                _ if FIELDS.iter().any(|(_, field, ..)| *field == name) => {
                    known.insert(key.clone(), value.clone());
                }
                _ => {
                    let fields: Vec<&str> = FIELDS.iter().map(|(_, field, ..)| *field).collect();
                    let what = format!(
                        "`{name}` is no field of a record sheet; put it under [sheet.further], or take one of {}",
                        fields.join(", ")
                    );
                    return Err(at(text, key, &what));
                }
            }
        }
        sheet.given = cells(text, &known)?.into_iter().filter(|(_, value)| !value.is_empty()).collect();
        Ok(sheet)
    }

    /// All fields in their order, with what the records that are `counted` of all `rows` themselves say.
    pub(crate) fn fields(&self, rows: &[Row], counted: &[&Row]) -> Vec<Field> {
        let field = |(part, key, words, term): &(&'static str, &str, &str, &'static str)| {
            let given = self.given.get(*key).cloned();
            let found = if given.is_none() { found(key, counted) } else { None };
            let (key, name) = ((*key).to_owned(), (*words).to_owned());
            Field { part, key, term, name, is_found: found.is_some(), value: given.or(found) }
        };
        let results = results(rows.len(), counted).map(|(name, value)| Field {
            part: RESULTS,
            key: String::new(),
            term: "",
            name,
            value: Some(value),
            is_found: true,
        });
        let further = self.further.iter().map(|(key, value)| Field {
            part: FURTHER,
            key: key.clone(),
            term: "",
            name: key.replace('_', " "),
            value: Some(value.clone()).filter(|value| !value.is_empty()),
            is_found: false,
        });
        FIELDS.iter().map(field).chain(results).chain(further).collect()
    }
}

/// Reference to the data in one line, `None` unless their title or authors are given.
pub(crate) fn citation(fields: &[Field]) -> Option<String> {
    let value = |key: &str| fields.iter().find(|field| field.part == DATA && field.key == key)?.value.as_deref();
    let (title, authors) = (value("title"), value("authors"));
    title.or(authors)?;
    let year = value("published").map(|year| format!("({year})"));
    let head: Vec<&str> = authors.into_iter().chain(year.as_deref()).collect();
    let head = Some(head.join(" ")).filter(|head| !head.is_empty());
    let licence = value("licence").map(|licence| format!("Licence {licence}"));
    let parts = [head.as_deref(), title, value("identifier"), licence.as_deref()];
    Some(parts.into_iter().flatten().collect::<Vec<_>>().join(". "))
}

/// Value of a field that follows from the records.
fn found(key: &str, rows: &[&Row]) -> Option<String> {
    let found = || rows.iter().filter_map(|row| row.found());
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
    let (low, high) = ends(values);
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
fn results(all: usize, rows: &[&Row]) -> impl Iterator<Item = (String, String)> {
    let replicates = ("replicates".to_owned(), format!("{} counted of {all} records", rows.len()));
    let loads: Vec<f64> = rows.iter().filter_map(|row| number_in(row, LOAD)).collect();
    // Forces under different loads have no mean that says anything.
    let measures = if loads.iter().any(|load| *load != loads[0]) { &FRICTION[..1] } else { &FRICTION[..] };
    let measures = quantities(rows).into_iter().filter_map(|(name, unit)| {
        measures.iter().find(|measure| name.ends_with(**measure))?;
        let values: Vec<f64> = rows.iter().filter_map(|row| Some(row.told((name, unit))?.value)).collect();
        let moments = Moments::of(&values)?;
        let (mean, deviation) = (moments.mean(), moments.standard_deviation()?);
        Some((
            name.replace('_', " "),
            format!(
                "{}: mean and standard deviation of {} records; coefficient of variation {:.2} %",
                in_unit(Rounded::new(mean, Some(deviation)), unit),
                values.len(),
                100.0 * deviation / mean.abs()
            ),
        ))
    });
    std::iter::once(replicates).chain(measures.collect::<Vec<_>>())
}
