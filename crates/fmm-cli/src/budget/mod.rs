//! The uncertainty of a result that follows from others by a formula: `fmm budget FILE.toml`.
//!
//! Reads inputs and formulas, propagates to first and second order, repeats it by trials, and says whether the simpler
//! answer holds.

mod file;

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use fmm_model::{Interval, Rounded};
use fmm_uq::{
    Budget, Expanded, Gum, IntervalKind, MonteCarlo, Propagation, Statement, TrialStatement, UncertaintyError, validate,
};
use serde::Serialize;

use crate::answer::{Answer, Detail, Document};
use crate::host::Host;
use crate::output::Form;
use file::{Correlation, Measurement};

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
    /// None where u is zero or its degrees of freedom are not defined.
    statement: Option<Statement>,
    /// Result of the trials, if it has a standard deviation.
    trials: Option<TrialStatement>,
    /// Why it has none, such as an input that is known by two observations.
    no_deviation: Option<String>,
    /// The interval of the trials (unit of the result).
    interval: Interval,
    /// Digits of u, 2 at most, to which the interval by derivatives is that of the trials (JCGM 101:2008, clause 8).
    validated_digits: u32,
}

/// All results, and how they go together.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Answers {
    results: Vec<Stated>,
    correlations: Vec<Correlation>,
}

pub(crate) fn budget(arguments: &Arguments, host: &Host<'_>) -> Result<Answers, Box<dyn Error>> {
    let measurement = host.document(&arguments.file, Measurement::of)?;
    let trials = (arguments.trials, arguments.seed);
    host.while_busy("trials", || answers(&measurement, arguments.level, trials))?
}

impl Answer for Answers {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        Ok(text(self).trim_end().to_owned())
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("budget-1", self).pretty()
    }
}

fn answers(measurement: &Measurement, level: f64, (trials, seed): (u64, u64)) -> Result<Answers, Box<dyn Error>> {
    let Measurement { inputs, results } = measurement;
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
        answers.push(Stated {
            formula: result.formula.text().to_owned(),
            statement: budget.statement(level).ok(),
            validated_digits: expanded.and_then(validated).unwrap_or(0),
            budget,
            trials,
            no_deviation,
            interval,
        });
    }
    Ok(Answers { results: answers, correlations })
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

fn text(answers: &Answers) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    for answer in &answers.results {
        let varies = answer.interval.low < answer.interval.high;
        let verdict = match (answer.validated_digits, &answer.statement) {
            _ if !varies && answer.budget.standard_uncertainty() > 0.0 => {
                "the trials do not vary although u is not zero: the digits in which they differ are lost beside larger numbers, and \
                 nothing confirms the interval above; write the formula so that the large numbers cancel first"
            }
            _ if !varies => "the trials do not vary: the result does not depend on what is uncertain",
            (DIGITS.., _) => "the trials confirm the interval above to two digits of u",
            (1, _) => "the trials confirm the interval above to one digit of u; to two, state theirs",
            (0, Some(_)) => "the trials do not confirm the interval above; state theirs",
            (0, None) => "there is no interval above; state that of the trials",
        };
        let _ = writeln!(
            text,
            "{} = {}\n\n{}",
            answer.budget.name(),
            answer.formula,
            answer.budget.at_level(answer.interval.level)
        );
        let trials = answer.trials.as_ref().map_or_else(|| interval(answer), ToString::to_string);
        let _ = writeln!(text, "by trials:\n{trials}\n{verdict}\n");
    }
    for Correlation { between: [first, second], coefficient } in &answers.correlations {
        let _ = writeln!(text, "r({first}, {second}) = {coefficient:.3}");
    }
    text
}

/// The interval of the trials of a result that has no standard deviation.
fn interval(answer: &Stated) -> String {
    let Interval { low, high, level, .. } = answer.interval;
    let (budget, percent) = (&answer.budget, 100.0 * level);
    let limits = Rounded::new(budget.estimate(), Some(budget.standard_uncertainty())).interval(low, high);
    let why = answer.no_deviation.as_deref().unwrap_or_default();
    format!("{percent} % interval {limits} {}\n{why}", budget.unit())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// JCGM 100:2008, H.1: a gauge block of 50 mm.
    const GAUGE_BLOCK: &str = r#"
[[input]]
name = "l_s"
unit = "nm"
value = 50000623
u = 25
degrees_of_freedom = 18
[[input]]
name = "d"
unit = "nm"
value = 215
u = 9.7
degrees_of_freedom = 25.6
[[input]]
name = "α_s"
unit = "1/K"
value = 11.5e-6
u = 1.2e-6
[[input]]
name = "θ"
unit = "K"
value = -0.1
u = 0.41
[[input]]
name = "δα"
unit = "1/K"
value = 0
u = 5.8e-7
degrees_of_freedom = 50
[[input]]
name = "δθ"
unit = "K"
value = 0
u = 0.029
degrees_of_freedom = 2
[[result]]
name = "length"
unit = "nm"
formula = "l_s + d - l_s*(δα*θ + α_s*δθ)"
"#;

    #[test]
    fn the_gauge_block_of_the_gum() {
        let measurement = Measurement::of_toml(GAUGE_BLOCK).unwrap();
        let answers = answers(&measurement, 0.99, (100_000, 1)).unwrap();
        let answer = &answers.results[0];
        assert_eq!(answer.budget.estimate(), 50_000_838.0);
        let statement = answer.statement.as_ref().unwrap();
        // Printed: u = 32 nm, U = 93 nm, ν_eff = 16.
        assert_eq!(statement.standard_uncertainty.round(), 32.0);
        assert_eq!(statement.expanded_uncertainty.round(), 93.0);
        assert_eq!(statement.effective_degrees_of_freedom.map(f64::floor), Some(16.0));
        let text = text(&answers);
        // The level that was asked for, as in the example, and no other.
        assert!(text.contains("U = 93 nm (k = 2.92, 99 %, ν_eff = 16.7)") && !text.contains("95 %"), "{text}");
        // JCGM 101:2008, 9.5: with a δθ of so few degrees of freedom the result has no standard deviation.
        assert!(answer.trials.is_none() && text.contains("δθ has, has no standard deviation"), "{text}");
        assert!(text.contains("length = l_s + d - l_s*(δα*θ + α_s*δθ)") && text.contains("by trials:"), "{text}");
    }

    /// A linear model of normal inputs, where both ways are the same.
    #[test]
    fn an_interval_that_holds_is_told() {
        let file = "[[input]]\nname = \"a\"\nunit = \"m\"\nvalue = 1\nu = 0.3\n\
                    [[result]]\nname = \"y\"\nunit = \"m\"\nformula = \"2*a\"\n";
        let answers = answers(&Measurement::of_toml(file).unwrap(), 0.95, (1_000_000, 1)).unwrap();
        assert_eq!(answers.results[0].validated_digits, 2);
        assert!(text(&answers).contains("confirm the interval above to two digits"));
    }

    /// JCGM 101:2008, 9.2.4: where one rectangular input dominates, the Gaussian interval is too wide.
    #[test]
    fn an_interval_that_does_not_hold_is_told() {
        let input =
            |name: &str, half: f64| format!("[[input]]\nname = \"{name}\"\nunit = \"1\"\nlimits = [-{half}, {half}]\n");
        let (narrow, wide) = (3f64.sqrt(), 300f64.sqrt());
        let file = [input("a", narrow), input("b", narrow), input("c", narrow), input("d", wide)].concat()
            + "[[result]]\nname = \"sum\"\nunit = \"1\"\nformula = \"a + b + c + d\"\n\
               [[result]]\nname = \"narrow\"\nunit = \"1\"\nformula = \"a + b + c\"\n";
        let answers = answers(&Measurement::of_toml(&file).unwrap(), 0.95, (200_000, 1)).unwrap();
        let [sum, narrow] = &answers.results[..] else { panic!("two results") };
        assert!(sum.validated_digits == 1 && (sum.interval.high - 17.0).abs() < 0.1, "{}", sum.interval.high);
        // Three alike are nearly normal, but not to two digits.
        assert!((narrow.interval.high - 3.4).abs() < 0.05);
        // r = 3/√(3 · 103).
        assert!((answers.correlations[0].coefficient - 3.0 / 309f64.sqrt()).abs() < 1e-12);
        assert!(text(&answers).contains("to two, state theirs"));
    }

    /// From JSON: u² = u_a² + u_b² − 2 r u_a u_b, with u_a = 0.3 and u_b = 0.4.
    #[test]
    fn correlated_inputs_and_observations_are_read() {
        let file = r#"{
            "input": [
                {"name": "a", "unit": "m", "value": 5, "u": 0.3},
                {"name": "b", "unit": "m", "value": 2, "u": 0.4},
                {"name": "c", "unit": "m", "observations": [1, 2, 3, 4]}
            ],
            "correlation": [{"between": ["a", "b"], "coefficient": 0.5}],
            "result": [
                {"name": "difference", "unit": "m", "formula": "a - b"},
                {"name": "mean", "unit": "m", "formula": "c"}
            ]
        }"#;
        let answers = answers(&Measurement::of_json(file).unwrap(), 0.95, (100_000, 1)).unwrap();
        let [difference, mean] = &answers.results[..] else { panic!("two results") };
        assert!((difference.budget.standard_uncertainty() - 0.13f64.sqrt()).abs() < 1e-12);
        // The mean of 1, 2, 3, 4 has u = √(5/12) and three degrees of freedom.
        let statement = mean.statement.as_ref().unwrap();
        assert!((statement.estimate, statement.effective_degrees_of_freedom) == (2.5, Some(3.0)));
        assert!((statement.standard_uncertainty - (5.0 / 12.0_f64).sqrt()).abs() < 1e-12);
        assert_eq!(answers.correlations[0].coefficient, 0.0);
    }

    /// Half widths of 3 over √3, √6 and √2 (JCGM 100:2008, 4.3.7 and 4.3.9; JCGM 101:2008, 6.4.6), from files of both
    /// kinds.
    #[test]
    fn limits_are_those_of_their_distribution() {
        let folder = std::env::temp_dir();
        let u = |distribution: &str, ending: &str| {
            let path = folder.join(format!("fmm-budget-{}-{ending}.{ending}", std::process::id()));
            let file = if ending == "JSON" {
                format!(
                    r#"{{"input": [{{"name": "a", "unit": "m", "limits": [1, 7], "distribution": "{distribution}"}}],
                         "result": [{{"name": "y", "unit": "m", "formula": "a"}}]}}"#
                )
            } else {
                format!(
                    "[[input]]\nname = \"a\"\nunit = \"m\"\nlimits = [1, 7]\ndistribution = \"{distribution}\"\n\
                     [[result]]\nname = \"y\"\nunit = \"m\"\nformula = \"a\"\n"
                )
            };
            std::fs::write(&path, file).unwrap();
            let read = Host::default().document(&path, Measurement::of);
            std::fs::remove_file(&path).unwrap();
            read.unwrap().inputs.as_slice()[0].standard_uncertainty()
        };
        for ending in ["toml", "JSON"] {
            for (distribution, divisor) in [("rectangular", 3.0_f64), ("triangular", 6.0), ("arc sine", 2.0)] {
                let found = u(distribution, ending);
                assert!((found - 3.0 / divisor.sqrt()).abs() < 1e-12, "{distribution}: {found}");
            }
        }
    }

    #[test]
    fn results_without_an_interval_by_derivatives_are_told() {
        let input = "[[input]]\nname = \"b\"\nunit = \"m\"\nvalue = 2\nu = 0.1\n";
        let told = |formula: &str| {
            let file = format!("{input}[[result]]\nname = \"y\"\nunit = \"m\"\nformula = \"{formula}\"\n");
            text(&answers(&Measurement::of_toml(&file).unwrap(), 0.95, (10_000, 1)).unwrap())
        };
        assert!(told("b - b").contains("the trials do not vary: the result does not depend on what is uncertain"));
        // 0.1 m is lost beside 1e20 m.
        let lost = told("b + 1e20 - 1e20");
        assert!(lost.contains("digits in which they differ are lost") && !lost.contains("does not depend"), "{lost}");
        // Flat where it is linearised: the derivatives see nothing.
        assert!(told("(b - 2)^2").contains("there is no interval above"));
    }

    #[test]
    fn what_is_wrong_in_a_file_is_named() {
        let refused = |text: &str| Measurement::of_toml(text).unwrap_err().to_string();
        let input = "[[input]]\nname = \"m\"\nunit = \"kg\"\n";
        let result = "[[result]]\nname = \"F\"\nunit = \"N\"\nformula = \"9.81*m\"\n";
        for (file, part) in [
            (format!("{input}value = 2\n{result}"), "m needs u"),
            (format!("{input}u = 2\n{result}"), "m needs value and u, limits or observations"),
            (format!("{input}value = 2\nu = 0.1\nlimits = [1, 3]\n{result}"), "m has more than one of"),
            (format!("{input}value = 2\nu = -0.1\n{result}"), "standard uncertainty of m"),
            (format!("{input}value = 2\nu = 0.1\nsigma = 3\n{result}"), "sigma"),
            (format!("{input}limits = [1, 3]\ndistribution = \"gauss\"\n{result}"), "no distribution \"gauss\""),
            (format!("{input}value = 2\nu = 0.1\ndistribution = \"triangular\"\n{result}"), "belongs to limits"),
            (format!("{input}limits = [1, 3]\ndegrees_of_freedom = 3\n{result}"), "degrees_of_freedom of m"),
            (format!("{input}observations = [2.0]\n{result}"), "at least 2 observations"),
            (format!("{input}value = 2\nu = 0.1\n{}", result.replace("*m", "*M")), "no quantity M; there is m"),
            (format!("{input}value = 2\nu = 0.1\n"), "result"),
            (format!("{input}value = 2\nu = 0.1\n{result}{result}"), "two results are called F"),
            ("input = 3".to_owned(), "input"),
            (format!("{input}value = 2\nu = -1e300\n{result}"), "zero or positive and finite, but is -1e300 kg"),
            (format!("{input}limits = [1, 2, 3]\n{result}"), "limits are two numbers, but 3 are given"),
            (format!("{input}limits = [1]\n{result}"), "limits are two numbers, but 1 is given"),
            (
                format!(
                    "{input}value = 2\nu = 0.1\n[[correlation]]\nbetween = [\"m\", \"m\", \"n\"]\ncoefficient = 0\n{result}"
                ),
                "between two names, but 3 are given",
            ),
        ] {
            let error = refused(&file);
            assert!(error.contains(part), "{file}\n{error}");
        }
        let json = r#"{"input": [{"name": "m", "unit": "kg", "limits": [1, 2, 3]}], "result": []}"#;
        let error = Measurement::of_json(json).unwrap_err().to_string();
        assert!(error.contains("limits are two numbers, but 3 are given"), "{error}");
    }
}
