//! The file of a measurement: inputs, correlations, and the results as formulas.

use std::error::Error;

use fmm_uq::{Distribution, Formula, Input, Inputs, Observations, Scalar, UncertaintyError};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

/// Inputs and what follows from them.
#[derive(Debug)]
pub(super) struct Measurement {
    pub(super) inputs: Inputs,
    pub(super) results: Vec<Wanted>,
}

/// A result that is asked for.
#[derive(Debug)]
pub(super) struct Wanted {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) formula: Formula,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    input: Vec<InputEntry>,
    #[serde(default)]
    correlation: Vec<Correlation>,
    result: Vec<ResultEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct InputEntry {
    name: String,
    unit: String,
    value: Option<f64>,
    u: Option<f64>,
    degrees_of_freedom: Option<f64>,
    #[serde(default, deserialize_with = "two_numbers")]
    limits: Option<[f64; 2]>,
    distribution: Option<String>,
    observations: Option<Vec<f64>>,
}

/// The correlation of two quantities.
#[derive(Debug, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Correlation {
    #[serde(deserialize_with = "two_names")]
    pub(super) between: [String; 2],
    pub(super) coefficient: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ResultEntry {
    name: String,
    unit: String,
    formula: String,
}

fn two_numbers<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 2]>, D::Error> {
    two("limits are two numbers", deserializer).map(Some)
}

fn two_names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[String; 2], D::Error> {
    two("a correlation is between two names", deserializer)
}

/// A list of two values. As an array, TOML would leave out a third without a word.
fn two<'de, T: Deserialize<'de>, D: Deserializer<'de>>(needed: &str, deserializer: D) -> Result<[T; 2], D::Error> {
    let values = Vec::<T>::deserialize(deserializer)?;
    values.try_into().map_err(|values: Vec<T>| {
        let count = values.len();
        D::Error::custom(format_args!("{needed}, but {count} {} given", if count == 1 { "is" } else { "are" }))
    })
}

impl Measurement {
    /// The results for these values of the inputs.
    pub(super) fn values<D: Scalar>(&self, inputs: &[D]) -> Result<Vec<D>, UncertaintyError> {
        self.results.iter().map(|result| result.formula.evaluate(inputs)).collect()
    }

    #[cfg(test)]
    pub(super) fn of_toml(text: &str) -> Result<Self, Box<dyn Error>> {
        Self::of(toml::from_str(text)?)
    }

    #[cfg(test)]
    pub(super) fn of_json(text: &str) -> Result<Self, Box<dyn Error>> {
        Self::of(serde_json::from_str(text)?)
    }

    /// The measurement of a file.
    pub(super) fn of(file: File) -> Result<Self, Box<dyn Error>> {
        let inputs = file.input.into_iter().map(InputEntry::input).collect::<Result<Vec<_>, _>>()?;
        let inputs = Inputs::new(inputs)?;
        let correlations = file.correlation.iter().map(|Correlation { between: [first, second], coefficient }| {
            (first.as_str(), second.as_str(), *coefficient)
        });
        let correlations: Vec<(&str, &str, f64)> = correlations.collect();
        let inputs = if correlations.is_empty() { inputs } else { inputs.with_correlations(&correlations)? };
        let names: Vec<&str> = inputs.as_slice().iter().map(Input::name).collect();
        let mut results: Vec<Wanted> = Vec::new();
        for ResultEntry { name, unit, formula } in file.result {
            if results.iter().any(|other| other.name == name) {
                return Err(format!("two results are called {name}").into());
            }
            let formula = Formula::new(&formula, &names).map_err(|error| format!("the result {name}: {error}"))?;
            results.push(Wanted { name, unit, formula });
        }
        Ok(Self { inputs, results })
    }
}

impl InputEntry {
    fn input(self) -> Result<Input, Box<dyn Error>> {
        let Self { name, unit, value, u, degrees_of_freedom, limits, distribution, observations } = self;
        let known = [value.is_some() || u.is_some(), limits.is_some(), observations.is_some()];
        if known.iter().filter(|known| **known).count() > 1 {
            return Err(format!("{name} has more than one of value and u, limits and observations").into());
        }
        if distribution.is_some() && limits.is_none() {
            return Err(format!("the distribution of {name} belongs to limits; value and u are normal").into());
        }
        if degrees_of_freedom.is_some() && value.is_none() {
            return Err(format!("the degrees_of_freedom of {name} belong to value and u").into());
        }
        let input = match (value, u, limits, observations) {
            (Some(value), Some(u), _, _) => {
                let input = Input::new(name, value, u, unit)?;
                match degrees_of_freedom {
                    Some(freedom) => input.with_degrees_of_freedom(freedom)?,
                    None => input,
                }
            }
            (Some(_), None, _, _) => {
                return Err(format!("{name} needs u, its standard uncertainty, which may be 0").into());
            }
            (_, _, Some([lower, upper]), _) => {
                let distribution = match distribution.as_deref() {
                    None | Some("rectangular") => Distribution::rectangular(lower, upper)?,
                    Some("triangular") => Distribution::triangular(lower, upper)?,
                    Some("arc sine") => Distribution::arc_sine(lower, upper)?,
                    Some(other) => {
                        return Err(format!(
                            "there is no distribution {other:?} for {name}; there are rectangular, triangular and arc sine"
                        )
                        .into());
                    }
                };
                Input::of(name, distribution, unit)?
            }
            (_, _, _, Some(observations)) => {
                let observations = Observations::new(&observations).map_err(|error| format!("{name}: {error}"))?;
                Input::mean_of(name, &observations, unit)?
            }
            _ => return Err(format!("{name} needs value and u, limits or observations").into()),
        };
        Ok(input)
    }
}
