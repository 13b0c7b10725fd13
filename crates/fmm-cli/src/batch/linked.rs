//! Linked data of a campaign: its record sheet, records and results as JSON-LD, for data bases that others search.
//!
//! Classes and relations are those of the TriboDataFAIR ontology 0.1.1 (Garabedian et al.,
//! doi:10.1038/s41597-022-01429-9, CC BY 4.0), data sets are described by schema.org, uncertainties by QUDT. By the
//! ontology's order of definitions the fixed specimen is the base body and the moving one the counter body.

use std::error::Error;

use serde_json::{Map, Value, json};

use super::campaign::Campaign;
use super::row::{Outcome, Row, Told};
use super::sheet::Field;
use super::summary::{Quantity, Summary};
use super::table::name;

/// Address of the ontology that stands for `tdo:`.
const ONTOLOGY: &str =
    "https://raw.githubusercontent.com/nick-garabedian/TriboDataFAIR-Ontology/v0.1.1/TriboDataFAIR_Ontology.owl#";

/// Name of the experiment within the document.
const EXPERIMENT: &str = "#experiment";

/// Parts of the sheet, the relation of the experiment to what they describe, its class, and its relation to their
/// fields.
const PARTS: &[(&[&str], &str, &str, &str)] = &[
    (&["Test"], "tdo:hasIdentifier", "tdo:ProcessGeneralIdentifyingInformation", "tdo:isComprisedOf"),
    (&["Device"], "tdo:employsEquipment", "tdo:Tribometer", "tdo:hasIdentifier"),
    (&["Moving specimen"], "tdo:stressesAsCounterBody", "tdo:BlockSpecimen", "tdo:hasTechnicalSpecification"),
    (&["Fixed specimen"], "tdo:stressesAsBaseBody", "tdo:BlockSpecimen", "tdo:hasTechnicalSpecification"),
    (
        &["Conditions", "Procedure", "Measurement"],
        "tdo:isControlledBy",
        "tdo:TribologicalExperimentProcessInputsArray",
        "tdo:isComprisedOf",
    ),
];

/// The campaign as one document.
///
/// # Errors
/// If it cannot be written as text.
pub(crate) fn document(campaign: &Campaign, rows: &[Row], summary: &Summary) -> Result<String, Box<dyn Error>> {
    let fields = summary.sheet.clone().unwrap_or_else(|| {
        let counted: Vec<&Row> = rows.iter().filter(|row| row.counts(summary.counts_doubtful)).collect();
        campaign.sheet.clone().unwrap_or_default().fields(rows, &counted)
    });
    let mut experiment = Map::from_iter([
        ("@id".to_owned(), json!(EXPERIMENT)),
        ("@type".to_owned(), json!(["tdo:TribologicalExperiment", "schema:Dataset"])),
    ]);
    let given = fields.iter().filter(|field| field.value.is_some());
    let (of_data, mut others): (Vec<&Field>, Vec<&Field>) = given.partition(|field| field.term.starts_with("schema:"));
    experiment.extend(of_data.iter().map(|field| (field.term.to_owned(), json!(field.value))));
    if let Some(place) = others.iter().position(|field| field.key == LUBRICANT) {
        let medium = json!({ "@type": "tdo:InterfacialMedium", "tdo:hasIdentifier": entry(others.remove(place)) });
        experiment.insert("tdo:makesUseOfConsumable".to_owned(), medium);
    }
    for (parts, relation, class, inner) in PARTS {
        let entries: Vec<Value> = others.extract_if(.., |field| parts.contains(&field.part)).map(entry).collect();
        if !entries.is_empty() {
            experiment.insert((*relation).to_owned(), json!({ "@type": class, *inner: entries }));
        }
    }
    let others: Vec<Value> = others.into_iter().map(entry).collect();
    experiment.insert("schema:additionalProperty".to_owned(), json!(others));
    experiment.insert("tdo:generatesFile".to_owned(), rows.iter().map(record).collect());
    experiment.insert("schema:variableMeasured".to_owned(), summary.quantities.iter().map(consensus).collect());
    let software = json!({
        "@type": "tdo:SoftwareUsedArrayItem",
        "tdo:isComprisedOf": [
            { "@type": "tdo:SoftwareName", "tdo:hasText": "fmm" },
            { "@type": "tdo:SoftwareVersion", "tdo:hasText": env!("CARGO_PKG_VERSION") },
        ],
    });
    let processing = json!({
        "@type": "tdo:DataProcessing",
        "tdo:takesDataFromProcess": { "@id": EXPERIMENT },
        "tdo:isComprisedOf": { "@type": "tdo:SoftwareUsedArray", "tdo:isComprisedOf": [software] },
    });
    let context = json!({
        "tdo": ONTOLOGY,
        "schema": "https://schema.org/",
        "qudt": "http://qudt.org/schema/qudt/",
    });
    let whole = json!({ "@context": context, "@graph": [experiment, processing] });
    Ok(serde_json::to_string_pretty(&whole)?)
}

/// Key of the field that is a consumable of the experiment.
const LUBRICANT: &str = "lubricant";

/// A field by its term, and by its name in the sheet.
fn entry(field: &Field) -> Value {
    let mut entry = json!({
        "@type": ["schema:PropertyValue"],
        "schema:name": field.name,
        "schema:value": field.value,
    });
    if !field.key.is_empty() {
        entry["schema:propertyID"] = json!(field.key);
    }
    if !field.term.is_empty() {
        entry["@type"] = json!([field.term, "schema:PropertyValue"]);
        entry["tdo:hasText"] = json!(field.value);
    }
    entry
}

/// A file with what describes it, and its findings or the reason why it has none.
fn record(row: &Row) -> Value {
    let described = row.description.iter().filter(|(_, cell)| !cell.is_empty()).map(
        |(column, cell)| json!({ "@type": "schema:PropertyValue", "schema:propertyID": column, "schema:value": cell }),
    );
    let name = row.file.display().to_string();
    let mut record = json!({
        "@type": "tdo:File",
        "tdo:hasIdentifier": { "@type": "tdo:FileName", "tdo:hasText": name },
        "schema:additionalProperty": described.collect::<Vec<_>>(),
    });
    match &row.outcome {
        Outcome::Found(found) => {
            let told = |told: &Told| quantity(&told.name, &told.unit, told.value, told.u);
            record["schema:variableMeasured"] = found.findings.iter().map(told).collect();
            if let Some((load, _)) = found.declared.get("normal_load") {
                record["tdo:isControlledBy"] = load_of(*load);
            }
            record["schema:measurementTechnique"] = json!(format!("friction law {}", found.law));
        }
        Outcome::Refused(reason) => record["schema:description"] = json!(reason),
    }
    record
}

/// The normal load (N) of a record.
fn load_of(load: f64) -> Value {
    json!({
        "@type": "tdo:NormalLoadSetpoint",
        "tdo:hasQuantification": {
            "@type": "tdo:ForceSetpointMagnitude",
            "tdo:hasRationalNumberValue": load,
            "tdo:hasPhysicalUnit": { "@id": "tdo:NewtonUnit" },
        },
    })
}

/// The consensus of the records on a quantity.
fn consensus(of: &Quantity) -> Value {
    let mut consensus = quantity(&name(of), &of.unit, of.mean, Some(of.u));
    let [low, high] = of.interval_95;
    let interval = json!({
        "@type": "schema:PropertyValue",
        "schema:name": "95 % interval",
        "schema:minValue": low,
        "schema:maxValue": high,
    });
    consensus["schema:valueReference"] = interval;
    consensus
}

/// A value with its unit and its standard uncertainty.
fn quantity(name: &str, unit: &str, value: f64, u: Option<f64>) -> Value {
    let mut quantity = json!({
        "@type": ["schema:PropertyValue", "qudt:QuantityValue"],
        "schema:name": name,
        "schema:value": value,
        "schema:unitText": unit,
        "qudt:numericValue": value,
    });
    if let Some(u) = u {
        quantity["qudt:standardUncertainty"] = json!(u);
    }
    quantity
}
