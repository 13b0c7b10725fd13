//! Lists of laws and of file formats: `fmm laws` and `fmm formats`.

use std::error::Error;

use serde::Serialize;

use crate::answer::{Answer, Detail, Document};
use crate::scenario;
use crate::scenario::{Entry, Slot};

/// The laws with their parameters, as text.
fn text() -> String {
    let mut lines = vec![
        "A parameter goes by its name or its symbol. With a normal load of 1 a coefficient is a force.".to_owned(),
    ];
    for entry in scenario::laws() {
        lines.push(format!("\n{}", entry.name));
        for slot in (entry.slots)() {
            let description = slot.description();
            let mut others = slot.keys();
            others.retain(|key| !description.contains(key.as_str()));
            let others = if others.is_empty() { String::new() } else { format!(", also {}", others.join(", ")) };
            lines.push(format!("    {description}{others}"));
        }
    }
    lines.join("\n")
}

/// The laws with their parameters.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Laws {
    laws: Vec<Law>,
}

#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Law {
    /// Name for `--law`.
    name: &'static str,
    parameters: Vec<Parameter>,
}

#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Parameter {
    name: &'static str,
    symbol: &'static str,
    unit: &'static str,
    /// Value of a scenario that gives none.
    default: Option<f64>,
    /// Names by which a file may call it.
    keys: Vec<String>,
}

pub(crate) fn laws() -> Laws {
    let law = |entry: Entry| {
        let parameter = |slot: Slot| {
            let keys = slot.keys();
            let Slot { name, symbol, unit, default, .. } = slot;
            Parameter { name, symbol, unit, default, keys }
        };
        Law { name: entry.name, parameters: (entry.slots)().into_iter().map(parameter).collect() }
    };
    Laws { laws: scenario::laws().into_iter().map(law).collect() }
}

impl Answer for Laws {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        Ok(text())
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("laws-1", self).pretty()
    }
}

/// Names of the formats and what they are.
const FORMATS: [(&str, &str); 8] = [
    (
        "text",
        "columns of numbers with or without a header: CSV, TSV, LVM and the like; any separator, decimal points or \
         commas, UTF-8 or UTF-16",
    ),
    ("workbook", "sheets of XLS, XLSX, XLSB, ODS"),
    ("json", "JSON: arrays, lists of rows, one object a line (.json, .jsonl)"),
    ("wav", "sound (.wav), whole numbers as they are stored"),
    ("matlab", "MATLAB 4 to 7 (.mat), and 7.3, which is HDF5"),
    ("hdf5", "HDF5 (.h5)"),
    ("numpy", "NumPy (.npy, .npz)"),
    ("universal", "Universal File, data sets 58 and 58b (.uff, .unv, .58)"),
];

/// The file formats that are read.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Formats {
    formats: Vec<Format>,
}

#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Format {
    name: &'static str,
    /// Files of this format, in words.
    files: &'static str,
}

pub(crate) fn formats() -> Formats {
    Formats { formats: FORMATS.map(|(name, files)| Format { name, files }).into() }
}

impl Answer for Formats {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        let lines: Vec<String> =
            self.formats.iter().map(|Format { name, files }| format!("{name:<10} {files}\n")).collect();
        Ok(format!(
            "A format is told by what a file begins with, whatever its name; gzip may compress it, and of a ZIP \
             archive the largest file is read.\n\n{}\n\
             A channel is chosen by its name, its number or its quantity; `fmm identify FILE` says what was found in a \
             file and what must be said.",
            lines.concat()
        ))
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("formats-1", self).pretty()
    }
}
