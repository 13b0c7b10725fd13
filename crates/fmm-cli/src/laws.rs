//! The laws of friction with their parameters: `fmm laws`.

use std::error::Error;
use std::fmt;

use crate::output::print;
use crate::scenario::laws;

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

pub(crate) fn run() -> Result<(), Box<dyn Error>> {
    print(Laws.to_string().trim_end())
}
