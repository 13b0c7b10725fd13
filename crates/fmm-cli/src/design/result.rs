//! Plan of the next tests from the document of one record: its machine, its law, its noise, its release.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write;

use serde::Deserialize;

use super::campaign::{TESTS, amount, motion};
use crate::batch::FRICTION;

/// Parts of a document of `fmm identify` that a plan needs.
#[derive(Debug, Deserialize)]
pub(super) struct Found {
    preferred: String,
    #[serde(default)]
    declared: BTreeMap<String, (f64, f64)>,
    models: Vec<Model>,
    preparation: Preparations,
}

/// One record, or a list of several.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Preparations {
    One(Preparation),
    Several(Vec<Preparation>),
}

#[derive(Debug, Deserialize)]
struct Model {
    law: String,
    rms_residual: f64,
    parameters: BTreeMap<String, Finding>,
}

#[derive(Debug, Deserialize)]
struct Finding {
    value: f64,
    u: Option<f64>,
    unit: String,
    status: String,
}

#[derive(Debug, Deserialize)]
struct Preparation {
    from_s: f64,
    to_s: f64,
    rate_hz: f64,
    unit: String,
    first_amplitude: f64,
}

/// Releases of the plan over that of the record (1).
const RELEASES: [f64; 3] = [0.5, 1.0, 2.0];

impl Found {
    /// The plan as a file of its own, and what the record told.
    pub(super) fn plan(&self) -> Result<(String, String), String> {
        let model = self.models.iter().find(|model| model.law == self.preferred);
        let record = match &self.preparation {
            Preparations::One(record) => Some(record),
            Preparations::Several(records) => records.first(),
        };
        let (Some(model), Some(record)) = (model, record) else {
            return Err(
                "the document lacks its record or the model of its preferred law; give one that `fmm identify \
                        --json` wrote"
                    .to_owned(),
            );
        };
        let Some(frequency) = model.parameters.get("natural_frequency_hz").map(|finding| finding.value) else {
            return Err(
                "a plan is made for a machine with a spring, and the document has no natural frequency".to_owned()
            );
        };
        // The level of a law, or its sliding one.
        let level = |name: &str| model.parameters.get_key_value(name);
        let measure = FRICTION.iter().find_map(|name| level(name).or_else(|| level(&format!("sliding_{name}"))));
        let (aim, measure) = measure.ok_or("the preferred law has no level of friction, so that there is no aim")?;
        let (quantity, order) = motion(&record.unit)?;
        let mut text = "[machine]\n".to_owned();
        // Writing to a string does not fail. Beside a mass or a stiffness the frequency is that of the fit.
        for name in ["mass", "stiffness", "normal_load", "damping"] {
            let _ = self.declared.get(name).map(|known| writeln!(text, "{name} = {}", amount(*known)));
        }
        let _ = writeln!(text, "frequency = {frequency}\n\n[guess]\nlaw = \"{}\"\n\n[guess.findings]", self.preferred);
        let is_of_record = |name: &str| {
            ["initial_", "offset", "drift", "hum", "natural_frequency"].iter().any(|own| name.starts_with(own))
        };
        let fitted = model.parameters.iter().filter(|(_, finding)| finding.status != "derived");
        for (name, finding) in fitted.filter(|(name, _)| !is_of_record(name)) {
            let _ = writeln!(text, "{name} = {:e}", finding.value);
        }
        let release = record.first_amplitude / (TAU * frequency).powi(order);
        let releases = RELEASES.map(|factor| format!("{:.3e}", factor * release)).join(", ");
        let _ = writeln!(
            text,
            "\n[sensor]\nquantity = \"{quantity}\"\nnoise = {:e}\n\n[[candidates]]\nrelease = [{releases}]\nrate = \
             {}\nduration = {:.4}\n\n[choose]\naim = \"{aim}\"\ntests = {TESTS}",
            model.rms_residual,
            record.rate_hz,
            record.to_s - record.from_s
        );
        let unit = if measure.unit == "1" { String::new() } else { format!(" {}", measure.unit) };
        let u = measure.u.map_or_else(|| "no standard uncertainty".to_owned(), |u| format!("u = {u:.2e}{unit}"));
        Ok((text, format!("this record gives {aim} = {:.4e}{unit} with {u}", measure.value)))
    }
}
