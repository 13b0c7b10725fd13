//! One quantity of a file, as a certificate, a data sheet or observations state it.

use std::error::Error;

use fmm_model::coverage_factor;
use fmm_uq::{Distribution, Input, Observations};
use serde::{Deserialize, Deserializer};

use super::file::two;

/// One quantity of the file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InputEntry {
    pub(super) name: String,
    #[serde(default = "pure")]
    unit: String,
    pub(super) value: Option<f64>,
    u: Option<Amount>,
    #[serde(rename = "U")]
    expanded: Option<Amount>,
    k: Option<f64>,
    level: Option<Amount>,
    degrees_of_freedom: Option<f64>,
    #[serde(default, deserialize_with = "two_numbers")]
    limits: Option<[f64; 2]>,
    distribution: Option<String>,
    pub(super) observations: Option<Vec<f64>>,
}

/// The unit of a quantity of which none is given.
pub(super) fn pure() -> String {
    "1".to_owned()
}

/// A number, or a text such as "1 %".
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, expecting = "a number is needed, or a text such as \"1 %\"")]
enum Amount {
    Number(f64),
    Text(String),
}

fn two_numbers<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 2]>, D::Error> {
    two("limits are two numbers", deserializer).map(Some)
}

impl Amount {
    /// The share that a text states in percent; `what` calls it in the error.
    fn percent(text: &str, what: &str) -> Result<f64, String> {
        let number = text.trim().strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
        let number = number.filter(|number| number.is_finite());
        number
            .map(|number| number / 100.0)
            .ok_or_else(|| format!("{what} is a number, or a text in percent such as \"1 %\", but is {text:?}"))
    }

    /// An uncertainty (unit of the quantity) of a quantity of this `value`.
    fn uncertainty(&self, what: &str, value: f64) -> Result<f64, String> {
        match self {
            Self::Number(number) => Ok(*number),
            Self::Text(text) => {
                let share = Self::percent(text, what)?;
                if value == 0.0 && share != 0.0 {
                    return Err(format!("{what} is in percent of a value that is 0; give it in the unit of the value"));
                }
                Ok(share * value.abs())
            }
        }
    }

    /// A probability (1).
    fn probability(&self, what: &str) -> Result<f64, String> {
        let number = match self {
            Self::Number(number) => *number,
            Self::Text(text) => Self::percent(text, what)?,
        };
        if number > 0.0 && number < 1.0 {
            return Ok(number);
        }
        Err(format!("{what} is a probability such as 0.95 or \"95 %\", but is {number}"))
    }
}

impl InputEntry {
    pub(super) fn input(self) -> Result<Input, Box<dyn Error>> {
        let name = &self.name;
        let stated = self.value.is_some() || self.u.is_some() || self.expanded.is_some();
        let known = [stated, self.limits.is_some(), self.observations.is_some()];
        match known.iter().filter(|known| **known).count() {
            0 => return Err(format!("{name} needs value and u, value and U, limits or observations").into()),
            1 => {}
            _ => return Err(format!("{name} has more than one of value and u, limits and observations").into()),
        }
        if self.distribution.is_some() && self.limits.is_none() {
            return Err(format!("{name} has a distribution, which belongs to limits; give lower and upper, or leave it out: value and u are normal").into());
        }
        if self.degrees_of_freedom.is_some() && self.observations.is_some() {
            return Err(
                format!("the degrees_of_freedom of {name} are those of its observations; leave them out").into()
            );
        }
        if self.k.is_some() && self.expanded.is_none() {
            return Err(format!("the k of {name} belongs to U, an expanded uncertainty; u needs none").into());
        }
        let is_normal = self.distribution.as_deref() == Some("normal");
        if self.level.is_some() && self.expanded.is_none() && !is_normal {
            let what = format!("the level of {name} belongs to U, or to limits with distribution = \"normal\"");
            return Err(what.into());
        }
        let input = match (self.limits, &self.observations) {
            (Some(limits), _) => {
                let distribution = self.within(limits)?;
                Input::of(self.name, distribution, self.unit)?
            }
            (_, Some(observations)) => {
                let observations = Observations::new(observations).map_err(|error| format!("{name}: {error}"))?;
                return Ok(Input::mean_of(self.name, &observations, self.unit)?);
            }
            _ => {
                let (value, u) = self.stated()?;
                Input::new(self.name, value, u, self.unit)?
            }
        };
        Ok(match self.degrees_of_freedom {
            Some(freedom) => input.with_degrees_of_freedom(freedom)?,
            None => input,
        })
    }

    /// The value, and its standard uncertainty.
    fn stated(&self) -> Result<(f64, f64), String> {
        let name = &self.name;
        let value = self.value.ok_or_else(|| format!("{name} needs a value beside its uncertainty"))?;
        match (&self.u, &self.expanded) {
            (Some(_), Some(_)) => Err(format!("{name} has both u and U; give one of them")),
            (Some(u), None) => Ok((value, u.uncertainty(&format!("u of {name}"), value)?)),
            (None, Some(expanded)) => {
                let expanded = expanded.uncertainty(&format!("U of {name}"), value)?;
                Ok((value, expanded / self.factor()?))
            }
            (None, None) => Err(format!(
                "{name} needs u, its standard uncertainty, which may be 0, or U, its expanded uncertainty, with k or \
                 level"
            )),
        }
    }

    /// The factor by which an expanded uncertainty is the larger one.
    fn factor(&self) -> Result<f64, String> {
        let name = &self.name;
        match (self.k, &self.level) {
            (Some(k), None) if k > 0.0 && k.is_finite() => Ok(k),
            (Some(k), None) => Err(format!("k of {name} must be positive and finite, but is {k}")),
            (None, Some(level)) => {
                let level = level.probability(&format!("the level of {name}"))?;
                let freedom = self.degrees_of_freedom.unwrap_or(f64::INFINITY);
                coverage_factor(level, freedom)
                    .ok_or_else(|| format!("the degrees_of_freedom of {name} must be positive, but are {freedom}"))
            }
            (Some(_), Some(_)) => Err(format!("U of {name} has both k and level; give one of them")),
            (None, None) => Err(format!("U of {name} needs its k, such as 2, or its level, such as \"95 %\"")),
        }
    }

    /// The distribution within limits.
    fn within(&self, [lower, upper]: [f64; 2]) -> Result<Distribution, Box<dyn Error>> {
        let name = &self.name;
        Ok(match self.distribution.as_deref() {
            None | Some("rectangular") => Distribution::rectangular(lower, upper)?,
            Some("triangular") => Distribution::triangular(lower, upper)?,
            Some("arc sine") => Distribution::arc_sine(lower, upper)?,
            Some("normal") => {
                let level = self.level.as_ref().ok_or_else(|| {
                    format!(
                        "the limits of {name} need a level, such as \"99 %\": a normal distribution goes beyond any"
                    )
                })?;
                let level = level.probability(&format!("the level of {name}"))?;
                let k = coverage_factor(level, f64::INFINITY).unwrap_or(f64::NAN);
                // Refuses limits in the wrong order.
                let between = Distribution::rectangular(lower, upper)?;
                Distribution::normal(between.mean(), 0.5 * (upper - lower) / k)?
            }
            Some(other) => {
                let what = format!(
                    "there is no distribution {other:?} for {name}; there are rectangular, triangular, arc sine and \
                     normal"
                );
                return Err(what.into());
            }
        })
    }
}
