//! Lists of laws and of file formats: `fmm laws` and `fmm formats`.

use std::error::Error;

use serde_json::json;

use crate::output::{print, print_json};
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

/// The laws as a list of names and parameters.
fn document() -> serde_json::Value {
    let law = |entry: &Entry| {
        let parameters = (entry.slots)().into_iter().map(|slot| {
            let Slot { name, symbol, unit, default, .. } = slot;
            json!({ "name": name, "symbol": symbol, "unit": unit, "default": default, "keys": slot.keys() })
        });
        json!({ "name": entry.name, "parameters": parameters.collect::<Vec<_>>() })
    };
    scenario::laws().iter().map(law).collect()
}

/// Lists the laws with their parameters.
pub(crate) fn laws(json: bool) -> Result<(), Box<dyn Error>> {
    if json { print_json(&document()) } else { print(text()) }
}

/// Names of the formats and what they are.
const FORMATS: [(&str, &str); 8] = [
    (
        "text",
        "columns of numbers with or without a header: CSV, TSV, LVM and the like; any separator, decimal points or commas, UTF-8 or UTF-16",
    ),
    ("workbook", "sheets of XLS, XLSX, XLSB, ODS"),
    ("json", "JSON: arrays, lists of rows, one object a line (.json, .jsonl)"),
    ("wav", "sound (.wav), whole numbers as they are stored"),
    ("matlab", "MATLAB 4 to 7 (.mat), and 7.3, which is HDF5"),
    ("hdf5", "HDF5 (.h5)"),
    ("numpy", "NumPy (.npy, .npz)"),
    ("universal", "Universal File, data sets 58 and 58b (.uff, .unv, .58)"),
];

/// Lists the formats.
pub(crate) fn formats(json: bool) -> Result<(), Box<dyn Error>> {
    if json {
        let formats = FORMATS.map(|(name, files)| json!({ "name": name, "files": files }));
        return print_json(&formats);
    }
    let lines = FORMATS.map(|(name, files)| format!("{name:<10} {files}\n"));
    print(format_args!(
        "A format is told by what a file begins with, whatever its name; gzip may compress it, and of a ZIP archive the largest file is read.\n\n{}\n\
         A channel is chosen by its name, its number or its quantity; `fmm identify FILE` says what was found in a file and what must be said.",
        lines.concat()
    ))
}
