//! The file of a measurement: inputs, correlations, the results as formulas, and a sweep.

use std::collections::BTreeMap;
use std::error::Error;

use fmm_uq::{Formula, Input, Inputs, Observations, Scalar, UncertaintyError};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::decision::{Tolerance, ToleranceEntry};
use super::input::{InputEntry, pure};

/// Inputs and what follows from them.
#[derive(Debug)]
pub(super) struct Measurement {
    pub(super) inputs: Inputs,
    pub(super) results: Vec<Wanted>,
    /// Place of the real part of each complex result; the imaginary one follows.
    pub(super) complex: Vec<Complex>,
    /// Values of inputs in each row of a sweep, and the inputs with these.
    pub(super) sweep: Vec<(BTreeMap<String, f64>, Inputs)>,
}

/// A result that is asked for.
#[derive(Debug)]
pub(super) struct Wanted {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) formula: Formula,
    pub(super) tolerance: Option<Tolerance>,
}

/// A complex result, of which four real ones are stated.
#[derive(Debug)]
pub(super) struct Complex {
    pub(super) name: String,
    pub(super) unit: String,
    /// Place of its real part among the results.
    pub(super) place: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    input: Vec<InputEntry>,
    #[serde(default)]
    correlation: Vec<Correlation>,
    #[serde(default)]
    simultaneous: Vec<Simultaneous>,
    result: Vec<ResultEntry>,
    #[serde(default)]
    sweep: BTreeMap<String, Vec<f64>>,
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

/// Quantities that were observed together.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Simultaneous {
    quantities: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ResultEntry {
    name: String,
    #[serde(default = "pure")]
    unit: String,
    formula: Option<String>,
    real: Option<String>,
    imaginary: Option<String>,
    magnitude: Option<String>,
    phase: Option<String>,
    tolerance: Option<ToleranceEntry>,
}

fn two_names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[String; 2], D::Error> {
    two("a correlation is between two names", deserializer)
}

/// A list of two values. As an array, TOML would leave out a third without a word.
pub(super) fn two<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    needed: &str,
    deserializer: D,
) -> Result<[T; 2], D::Error> {
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
        let inputs = file.inputs(&BTreeMap::new())?;
        let sweep = file.rows()?.into_iter().map(|row| file.inputs(&row).map(|inputs| (row, inputs)));
        let sweep = sweep.collect::<Result<Vec<_>, _>>()?;
        let names: Vec<&str> = inputs.as_slice().iter().map(Input::name).collect();
        let (mut results, mut complex): (Vec<Wanted>, Vec<Complex>) = (Vec::new(), Vec::new());
        for entry in file.result {
            let (name, unit) = (entry.name.clone(), entry.unit.clone());
            let wanted = entry.wanted(&names)?;
            if wanted.len() > 1 {
                complex.push(Complex { name, unit, place: results.len() });
            }
            for result in wanted {
                if results.iter().any(|other| other.name == result.name) {
                    return Err(format!("two results are called {}", result.name).into());
                }
                results.push(result);
            }
        }
        Ok(Self { inputs, results, complex, sweep })
    }
}

impl File {
    /// The inputs, with other values for some of them.
    fn inputs(&self, values: &BTreeMap<String, f64>) -> Result<Inputs, Box<dyn Error>> {
        let mut entries = self.input.clone();
        for entry in &mut entries {
            if let Some(value) = values.get(&entry.name) {
                entry.value = Some(*value);
            }
        }
        let inputs = entries.into_iter().map(InputEntry::input).collect::<Result<Vec<_>, _>>()?;
        let inputs = Inputs::new(inputs)?;
        let given = self.correlation.iter().map(|Correlation { between: [first, second], coefficient }| {
            (first.as_str(), second.as_str(), *coefficient)
        });
        let mut correlations: Vec<(&str, &str, f64)> = given.collect();
        let mut ensembles = Vec::new();
        for group in &self.simultaneous {
            let observed = group.quantities.iter().map(|name| self.observed(name)).collect::<Result<Vec<_>, _>>()?;
            for (place, (second, of_second)) in observed.iter().enumerate() {
                for (first, of_first) in &observed[..place] {
                    correlations.push((first, second, of_first.correlation(of_second)?));
                }
            }
            if let [(_, first), _, ..] = observed.as_slice() {
                ensembles
                    .push((observed.iter().map(|(name, _)| *name).collect::<Vec<_>>(), first.degrees_of_freedom()));
            } else {
                return Err("simultaneous needs at least two quantities, by their names".into());
            }
        }
        let inputs = if correlations.is_empty() { inputs } else { inputs.with_correlations(&correlations)? };
        let ensemble = |inputs: Inputs, (names, freedom): (Vec<&str>, f64)| inputs.with_ensemble(&names, freedom);
        Ok(ensembles.into_iter().try_fold(inputs, ensemble)?)
    }

    /// The observations of the quantity of this `name`.
    fn observed<'a>(&self, name: &'a str) -> Result<(&'a str, Observations), Box<dyn Error>> {
        let entry = self.input.iter().find(|entry| entry.name == name);
        let observations = entry.and_then(|entry| entry.observations.as_deref());
        let values =
            observations.ok_or_else(|| format!("simultaneous needs observations of {name}, but there are none"))?;
        Ok((name, Observations::new(values).map_err(|error| format!("{name}: {error}"))?))
    }

    /// The values of each row of the sweep.
    fn rows(&self) -> Result<Vec<BTreeMap<String, f64>>, String> {
        let mut rows = Vec::new();
        for (name, values) in &self.sweep {
            let entry = self.input.iter().find(|entry| &entry.name == name);
            if entry.is_none_or(|entry| entry.value.is_none()) {
                return Err(format!("the sweep goes over {name}, which is no input with a value"));
            }
            if rows.is_empty() {
                rows = vec![BTreeMap::new(); values.len()];
            }
            if rows.len() != values.len() || values.is_empty() {
                let (before, here) = (rows.len(), values.len());
                return Err(format!(
                    "each row of the sweep has a value of every quantity, but there are {here} of {name} beside \
                     {before}"
                ));
            }
            for (row, value) in rows.iter_mut().zip(values) {
                row.insert(name.clone(), *value);
            }
        }
        Ok(rows)
    }
}

impl ResultEntry {
    /// The real results that this one is made of: itself, or real and imaginary part, magnitude and phase.
    fn wanted(self, names: &[&str]) -> Result<Vec<Wanted>, Box<dyn Error>> {
        let Self { name, unit, formula, real, imaginary, magnitude, phase, tolerance } = self;
        let read = |text: &str| Formula::new(text, names).map_err(|error| format!("the result {name}: {error}"));
        let parts = match (&formula, &real, &imaginary, &magnitude, &phase) {
            (Some(formula), None, None, None, None) => {
                let tolerance = tolerance.map(|tolerance| tolerance.tolerance(&name)).transpose()?;
                return Ok(vec![Wanted { formula: read(formula)?, name, unit, tolerance }]);
            }
            (None, Some(real), Some(imaginary), None, None) => {
                // Each for itself, so that the error names what is wrong.
                let (real, imaginary) = (read(real)?.text().to_owned(), read(imaginary)?.text().to_owned());
                let magnitude = format!("sqrt(({real})^2 + ({imaginary})^2)");
                let phase = format!("atan2({imaginary}, {real})");
                [real, imaginary, magnitude, phase]
            }
            (None, None, None, Some(magnitude), Some(phase)) => {
                let (magnitude, phase) = (read(magnitude)?.text().to_owned(), read(phase)?.text().to_owned());
                [format!("({magnitude})*cos({phase})"), format!("({magnitude})*sin({phase})"), magnitude, phase]
            }
            _ => {
                let what = format!("{name} needs one of formula, real and imaginary, or magnitude and phase (rad)");
                return Err(what.into());
            }
        };
        if tolerance.is_some() {
            return Err(format!("the tolerance of {name} belongs to a formula, such as that of its magnitude").into());
        }
        let units = [&unit, &unit, &unit, "rad"].map(str::to_owned);
        let kinds = ["real", "imaginary", "magnitude", "phase"];
        let wanted = |((text, unit), kind): ((String, String), &str)| {
            Ok(Wanted { name: format!("{name}_{kind}"), unit, formula: read(&text)?, tolerance: None })
        };
        parts.into_iter().zip(units).zip(kinds).map(wanted).collect()
    }
}
