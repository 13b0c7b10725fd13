//! The laws of friction with their parameters: `fmm laws`.

use std::error::Error;
use std::fmt;

use crate::output::print;
use crate::scenario::{Entry, Slot, laws};
use serde_json::json;

/// The laws with their parameters.
struct Laws;

impl fmt::Display for Laws {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "A parameter goes by its name or its symbol. With a normal load of 1 a coefficient is a force.")?;
        for entry in laws() {
            writeln!(f, "\n{}", entry.name)?;
            for slot in (entry.slots)() {
                let description = slot.description();
                let mut others = slot.keys();
                others.retain(|key| !description.contains(key.as_str()));
                let others = if others.is_empty() { String::new() } else { format!(", also {}", others.join(", ")) };
                writeln!(f, "    {description}{others}")?;
            }
        }
        Ok(())
    }
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
    laws().iter().map(law).collect()
}

pub(crate) fn run(json: bool) -> Result<(), Box<dyn Error>> {
    if json {
        return print(serde_json::to_string_pretty(&document())?);
    }
    print(Laws.to_string().trim_end())
}
