//! The uncertainty of a result that follows from others by a formula: `fmm budget FILE.toml`.
//!
//! Reads inputs and formulas, propagates to first and second order, repeats it by trials, and says whether the simpler
//! answer holds.

mod decision;
mod file;
mod input;
#[cfg(test)]
mod tests;
mod text;

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use fmm_model::Interval;
use fmm_uq::{
    Budget, Expanded, Gum, Inputs, IntervalKind, MonteCarlo, Propagation, Statement, TrialStatement, UncertaintyError,
    validate,
};
use serde::Serialize;

use crate::answer::{Answer, Detail, Document};
use crate::host::Host;
use crate::output::Form;
use decision::Conformity;
use file::{Complex, Correlation, Measurement};
use text::{overview, text, written};

/// States the uncertainty of a result.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The measurement, as TOML or, by its ending, as JSON
    file: PathBuf,
    /// Coverage probability of intervals
    #[arg(long, default_value_t = 0.95)]
    level: f64,
    /// Number of trials of the Monte Carlo, 10 000 to 10 000 000
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(10_000..=10_000_000))]
    trials: u64,
    /// Seed of the trials
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    pub(crate) form: Form,
}

pub(crate) const HELP: &str = include_str!("help.txt");

/// Significant digits of u to which the two intervals must agree.
const DIGITS: u32 = 2;

/// One result: what follows by derivatives, what by trials, and whether the first may stand for the second.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Stated {
    formula: String,
    budget: Budget,
    /// Expanded uncertainty; none if u is zero or its degrees of freedom are not defined.
    statement: Option<Statement>,
    /// Result of the trials, if it has a standard deviation.
    trials: Option<TrialStatement>,
    /// Why it has none, such as an input that is known by two observations.
    no_deviation: Option<String>,
    /// The interval of the trials (unit of the result).
    interval: Interval,
    /// Digits of u, 2 at most, to which the interval by derivatives is that of the trials (JCGM 101:2008, clause 8).
    validated_digits: u32,
    /// Decision on the tolerance of the result, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    conformity: Option<Conformity>,
}

/// Real and imaginary part of a complex result together.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Plane {
    name: String,
    unit: String,
    real: f64,
    imaginary: f64,
    /// Covariance matrix of real and imaginary part (unit squared).
    covariance: [[f64; 2]; 2],
    /// Factor of the ellipse that holds both with this level (JCGM 102:2011, 6.5); none where it has no extent.
    coverage_factor: Option<f64>,
    level: f64,
}

/// The results for one set of inputs, and how they go together.
#[derive(Default, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Row {
    results: Vec<Stated>,
    correlations: Vec<Correlation>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    complex: Vec<Plane>,
}

/// The results for one row of a sweep.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Swept {
    /// Values of the quantities of the sweep.
    values: BTreeMap<String, f64>,
    #[serde(flatten)]
    row: Row,
}

/// All results; those of a sweep by its rows.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answers {
    #[serde(flatten)]
    row: Row,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    sweep: Vec<Swept>,
}

pub(crate) fn budget(arguments: &Arguments, host: &Host<'_>) -> Result<Answers, Box<dyn Error>> {
    let measurement = host.document(&arguments.file, Measurement::of)?;
    let trials = (arguments.trials, arguments.seed);
    host.while_busy("trials", || {
        if measurement.sweep.is_empty() {
            return Ok(Answers { row: answers(&measurement, arguments.level, trials)?, sweep: Vec::new() });
        }
        let row = |(values, inputs): &(BTreeMap<String, f64>, Inputs)| {
            let row = answers_of(&measurement, inputs, arguments.level, trials)
                .map_err(|error| format!("in the row of {}: {error}", written(values)))?;
            Ok::<_, Box<dyn Error>>(Swept { values: values.clone(), row })
        };
        Ok(Answers { row: Row::default(), sweep: measurement.sweep.iter().map(row).collect::<Result<_, _>>()? })
    })?
}

impl Answer for Answers {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        let mut all = text(&self.row);
        // Writing to a string does not fail.
        for Swept { values, row } in &self.sweep {
            let _ = writeln!(all, "== {}\n\n{}", written(values), text(row));
        }
        all += &overview(&self.sweep);
        Ok(all.trim_end().to_owned())
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("budget-1", self).pretty()
    }
}

fn answers(measurement: &Measurement, level: f64, trials: (u64, u64)) -> Result<Row, Box<dyn Error>> {
    answers_of(measurement, &measurement.inputs, level, trials)
}

/// The answers for some `inputs` of the measurement.
fn answers_of(
    measurement: &Measurement,
    inputs: &Inputs,
    level: f64,
    (trials, seed): (u64, u64),
) -> Result<Row, Box<dyn Error>> {
    let results = &measurement.results;
    let by_derivatives = Gum::new(inputs).propagate(|x| measurement.values(x))?;
    let run = MonteCarlo::new(inputs, trials)?.with_seed(seed);
    let sample = run.run(|x| measurement.values(x))?;
    let correlations = correlations(measurement, &by_derivatives);
    let mut answers = Vec::new();
    for (place, (result, budget)) in results.iter().zip(by_derivatives.outputs()).enumerate() {
        let budget = budget.clone().named(&result.name, &result.unit);
        let (trials, no_deviation) = match run.statement(&sample, place, IntervalKind::Symmetric, level) {
            Ok(trials) => (Some(trials.named(&result.name, &result.unit)), None),
            Err(UncertaintyError::NoAnswer { what }) => (None, Some(what)),
            Err(other) => return Err(other.into()),
        };
        let interval = sample.symmetric_interval(place, level)?;
        let expanded = budget.expanded(level).ok();
        let u = trials.as_ref().map_or(budget.standard_uncertainty(), |trials| trials.standard_uncertainty);
        let agree = |expanded: &Expanded, digits: u32| {
            validate(expanded.interval(), interval, u, digits).is_ok_and(|validation| validation.is_valid())
        };
        let validated = |expanded: Expanded| (1..=DIGITS).rev().find(|digits| agree(&expanded, *digits));
        let tolerance = result.tolerance.as_ref();
        let decide = |tolerance: &decision::Tolerance| tolerance.decide(&budget, sample.values(place)?, level);
        let conformity = tolerance.map(decide).transpose()?;
        answers.push(Stated {
            formula: result.formula.text().to_owned(),
            statement: budget.statement(level).ok(),
            validated_digits: expanded.and_then(validated).unwrap_or(0),
            budget,
            trials,
            no_deviation,
            interval,
            conformity,
        });
    }
    let complex = measurement.complex.iter().map(|complex| plane(measurement, inputs, complex, level));
    Ok(Row { results: answers, correlations, complex: complex.collect::<Result<_, _>>()? })
}

/// Real and imaginary part of a complex result together.
fn plane(measurement: &Measurement, inputs: &Inputs, complex: &Complex, level: f64) -> Result<Plane, UncertaintyError> {
    let parts = &measurement.results[complex.place..complex.place + 2];
    let both = Gum::new(inputs).first_order_only().propagate(|x| {
        parts.iter().map(|part| part.formula.evaluate(x)).collect::<Result<Vec<_>, UncertaintyError>>()
    })?;
    let estimate = |part: usize| both.outputs()[part].estimate();
    Ok(Plane {
        name: complex.name.clone(),
        unit: complex.unit.clone(),
        real: estimate(0),
        imaginary: estimate(1),
        covariance: [0, 1].map(|i| [0, 1].map(|j| both.covariance(i, j))),
        coverage_factor: both.ellipsoid(level).ok().map(|ellipse| ellipse.coverage_factor),
        level,
    })
}

fn correlations(measurement: &Measurement, propagation: &Propagation) -> Vec<Correlation> {
    let names: Vec<&str> = measurement.results.iter().map(|result| result.name.as_str()).collect();
    let pairs = (0..names.len()).flat_map(|i| (i + 1..names.len()).map(move |j| (i, j)));
    pairs
        .map(|(i, j)| Correlation {
            between: [names[i].to_owned(), names[j].to_owned()],
            coefficient: propagation.correlation(i, j),
        })
        .collect()
}
