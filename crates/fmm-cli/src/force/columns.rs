//! Meaning of the columns of a table of forces: by options, by units, and by words in their names.

use std::fmt;

use fmm_record::{Column, Label, Quantity, WrittenUnit};
use serde::Serialize;

/// Meaning of a column.
pub(super) struct Role {
    option: &'static str,
    quantity: Quantity,
    /// Words of the quantity itself.
    words: [&'static str; 2],
    /// Required dimension in words, and its SI units.
    needed: &'static str,
    units: &'static [&'static str],
}

// Volts, amperes and counts can stand for any quantity, and friction can be given in them.
pub(super) const POSITION: Role = Role {
    option: "--position",
    quantity: Quantity::Displacement,
    words: ["position", "displacement"],
    needed: "length or angle, such as mm or deg",
    units: &["m", "rad", "V", "A", "counts"],
};
pub(super) const VELOCITY: Role = Role {
    option: "--velocity",
    quantity: Quantity::Velocity,
    words: ["velocity", "speed"],
    needed: "velocity, such as mm/s or deg/s",
    units: &["m/s", "rad/s", "V", "A", "counts"],
};
pub(super) const FORCE: Role = Role {
    option: "--force",
    quantity: Quantity::Force,
    words: ["force", "torque"],
    needed: "force or torque, such as N or N m",
    units: &["N", "N m", "V", "A", "counts"],
};
pub(super) const LOAD: Role = Role {
    option: "--load",
    quantity: Quantity::Force,
    words: ["normal", "load"],
    needed: "force, such as N",
    units: &["N"],
};

/// Words of a friction force, of which the unit may be that of any sensor.
const ALONG: [&str; 5] = ["friction", "lateral", "tangential", "shear", "traction"];
/// Words of what is no force at all, though friction is in its name.
const RATIOS: [&str; 2] = ["coeff", "cof"];
/// Words of what acts or goes across the motion.
const ACROSS: [&str; 5] = ["normal", "depth", "penetration", "indent", "wear"];
/// Symbols of a normal load.
const SYMBOLS: [&str; 4] = ["fn", "f_n", "fz", "f_z"];

/// Distance of a label from what a role means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Distance {
    /// A word of friction.
    Friction,
    /// A word of the quantity.
    Named,
    /// The unit, or another word, of the quantity.
    Alike,
    /// A load, which may be the measured force, or what presses the contact.
    Load,
    /// Across the motion, which is never guessed.
    Across,
}

/// True for a name with one of these words.
fn has(name: &str, words: &[&str]) -> bool {
    words.iter().any(|word| name.contains(word))
}

/// The column of normal loads that a name says, if it does.
fn names_normal_load(label: &Label) -> bool {
    let name = label.name().to_lowercase();
    let symbol = name.split(['[', '(', '/', ' ']).next().unwrap_or_default();
    label.quantity() == Some(Quantity::Force) && (has(&name, &ACROSS) || SYMBOLS.contains(&symbol))
}

impl Role {
    /// The unit of a column: the one in its name, or else the one `said` by an option.
    pub(super) fn unit(&self, label: &Label, said: Option<&WrittenUnit>) -> Result<Option<WrittenUnit>, String> {
        let (name, option) = (label.name(), self.option);
        if let (Some(written), Some(said)) = (label.unit(), said)
            && !said.is_same_as(written)
        {
            return Err(format!(
                "channel \"{name}\" is in {written}, not in {said} as {option}-unit says; leave that out"
            ));
        }
        let unit = label.unit().or(said).cloned();
        unit.map(|unit| self.accepted(&format!("channel \"{name}\" is in"), unit)).transpose()
    }

    /// A unit that can be that of such a column; `origin` says whose it is.
    pub(super) fn accepted(&self, origin: &str, unit: WrittenUnit) -> Result<WrittenUnit, String> {
        if self.units.contains(&unit.si()) {
            return Ok(unit);
        }
        Err(format!("{origin} {unit}, but {} needs a unit of {}", self.option, self.needed))
    }

    /// Distance of a column with this label from the role; `None` for one that cannot be it.
    fn distance(&self, label: &Label) -> Option<Distance> {
        let name = label.name().to_lowercase();
        let is_along = self.quantity == Quantity::Force && has(&name, &ALONG) && !has(&name, &RATIOS);
        let may_be = label.unknown_unit().is_none() && label.unit().is_none_or(|unit| self.units.contains(&unit.si()));
        match label.quantity() {
            _ if is_along && may_be => Some(Distance::Friction),
            Some(quantity) if quantity != self.quantity => None,
            None => None,
            _ if has(&name, &ACROSS) || names_normal_load(label) => Some(Distance::Across),
            _ if has(&name, &["load"]) && !has(&name, &["cell"]) => Some(Distance::Load),
            _ if has(&name, &self.words) => Some(Distance::Named),
            _ => Some(Distance::Alike),
        }
    }

    /// The column that is `given` by the option, or else the nearest one by its label, with a sentence if another may
    /// be meant as well; `None` if there is no such column.
    pub(super) fn column(
        &self,
        given: Option<&String>,
        labels: &[Label],
        remarks: &mut Vec<String>,
    ) -> Result<Option<Column>, String> {
        if let Some(name) = given {
            return Ok(Some(Column::from(name.as_str())));
        }
        let distances: Vec<Option<Distance>> = labels.iter().map(|label| self.distance(label)).collect();
        let Some(least) = distances.iter().flatten().min() else { return Ok(None) };
        let nearest = labels.iter().zip(&distances).filter(|(_, distance)| distance.as_ref() == Some(least));
        let nearest: Vec<&str> = nearest.map(|(label, _)| label.name()).collect();
        let (what, option) = (self.option.trim_start_matches('-'), self.option);
        if *least == Distance::Across {
            return Err(format!(
                "the only column that may be the {what} is \"{}\", which is across the motion by its name; name the \
                 {what} by {option}",
                nearest[0]
            ));
        }
        if let [first, others @ ..] = &nearest[..]
            && !others.is_empty()
        {
            let others = others.join("\", \"");
            remarks.push(format!(
                "\"{first}\" was taken for the {what}, which may be \"{others}\" as well: say it by {option}"
            ));
        }
        Ok(Some(Column::Name(nearest[0].to_owned())))
    }
}

/// Names of the columns that were used, and sentences about them.
#[derive(Debug, Default, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Columns {
    /// `None` for equal steps by an option, or for steady states without a time.
    pub(super) time: Option<String>,
    pub(super) position: Option<String>,
    pub(super) velocity: Option<String>,
    pub(super) force: Option<String>,
    pub(super) load: Option<String>,
    pub(super) channels: Vec<String>,
    pub(super) unused: Vec<String>,
    #[serde(skip)]
    pub(crate) remarks: Vec<String>,
}

impl Columns {
    fn used(&self) -> impl Iterator<Item = (&'static str, &String)> {
        let all = [
            ("time", &self.time),
            ("position", &self.position),
            ("velocity", &self.velocity),
            ("force", &self.force),
            ("normal load", &self.load),
        ];
        let channels = self.channels.iter().map(|name| ("channel", name));
        all.into_iter().filter_map(|(what, name)| Some((what, name.as_ref()?))).chain(channels)
    }

    /// Says which units nothing states: of each column whether it is stated, its name, the unit taken, and the option.
    pub(super) fn note_units(&mut self, columns: [Option<(bool, String, String, &str)>; 4]) {
        let silent: Vec<_> = columns.into_iter().flatten().filter(|(is_stated, ..)| !is_stated).collect();
        if silent.is_empty() {
            return;
        }
        let taken: Vec<String> = silent.iter().map(|(_, name, unit, _)| format!("{unit} for \"{name}\"")).collect();
        let mut options: Vec<&str> = silent.iter().map(|(.., option)| *option).collect();
        options.dedup();
        self.remarks.push(format!(
            "no unit is stated, and {} were taken; say others by {}, or in the names of the columns",
            taken.join(", "),
            options.join(", ")
        ));
    }

    /// Finds which of the columns with these labels were not used.
    pub(super) fn leave(&mut self, labels: &[Label]) {
        let is_used = |label: &&Label| self.used().any(|(_, name)| name == label.name());
        let unused: Vec<&Label> = labels.iter().filter(|label| !is_used(label)).collect();
        let is_load = |label: &Label| names_normal_load(label) || has(&label.name().to_lowercase(), &["load"]);
        let load = unused.iter().find(|label| self.load.is_none() && is_load(label));
        let remark = load.map(|load| {
            format!(
                "\"{}\" was not used; if it is the normal load, say so by --load, and levels are coefficients",
                load.name()
            )
        });
        let names = unused.iter().map(|label| label.name().to_owned()).collect();
        self.unused = names;
        self.remarks.extend(remark);
    }
}

impl fmt::Display for Columns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let used: Vec<String> = self.used().map(|(what, name)| format!("{what} \"{name}\"")).collect();
        write!(f, "{}", used.join(", "))?;
        if self.unused.is_empty() { Ok(()) } else { write!(f, "; not used: \"{}\"", self.unused.join("\", \"")) }
    }
}
