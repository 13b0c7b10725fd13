//! The record sheet of a campaign: what a friction coefficient must be handed on with, so that others can use it.
//!
//! Its fields are those that ASTM G115 (guide for measuring and reporting friction coefficients) asks for, as far as is
//! public.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::de::{DeTable, DeValue};

use super::cells::{at, cells};

/// What a manifest says under `[sheet]`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sheet {
    /// By key of [`FIELDS`].
    pub(super) given: BTreeMap<String, String>,
    /// Under `[sheet.further]`.
    pub(super) further: BTreeMap<String, String>,
}

/// Part, key and words of each field that can be given.
pub(super) const FIELDS: &[(&str, &str, &str)] = &[
    ("Test", "laboratory", "laboratory"),
    ("Test", "operator", "operator"),
    ("Test", "date", "date"),
    ("Test", "purpose", "purpose"),
    ("Device", "device", "test device"),
    ("Device", "geometry", "geometry of the contact"),
    ("Device", "contact_area", "contact area or dimensions"),
    ("Moving specimen", "moving_material", "material"),
    ("Moving specimen", "moving_composition", "composition"),
    ("Moving specimen", "moving_treatment", "treatment or coating"),
    ("Moving specimen", "moving_hardness", "hardness"),
    ("Moving specimen", "moving_finish", "surface finish"),
    ("Moving specimen", "moving_roughness", "roughness"),
    ("Fixed specimen", "fixed_material", "material"),
    ("Fixed specimen", "fixed_composition", "composition"),
    ("Fixed specimen", "fixed_treatment", "treatment or coating"),
    ("Fixed specimen", "fixed_hardness", "hardness"),
    ("Fixed specimen", "fixed_finish", "surface finish"),
    ("Fixed specimen", "fixed_roughness", "roughness"),
    ("Conditions", "motion", "type of motion"),
    ("Conditions", "normal_load", "normal load or pressure"),
    ("Conditions", "velocity", "sliding velocity"),
    ("Conditions", "temperature", "temperature"),
    ("Conditions", "humidity", "relative humidity"),
    ("Conditions", "atmosphere", "atmosphere"),
    ("Conditions", "lubricant", "lubricant"),
    ("Procedure", "cleaning", "cleaning of the specimens"),
    ("Procedure", "run_in", "run-in"),
    ("Procedure", "duration", "duration or number of cycles"),
    ("Measurement", "friction_measurement", "how friction is measured"),
    ("Measurement", "coefficient", "static or kinetic"),
];

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
                _ if FIELDS.iter().any(|(_, field, _)| *field == name) => {
                    known.insert(key.clone(), value.clone());
                }
                _ => {
                    let fields: Vec<&str> = FIELDS.iter().map(|(_, field, _)| *field).collect();
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
}
