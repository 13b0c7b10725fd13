//! The results in words.

use std::collections::BTreeMap;
use std::fmt::Write;

use fmm_model::{Interval, Rounded};

use super::file::Correlation;
use super::{DIGITS, Row, Stated, Swept};

/// The values of a row: "load = 5, speed = 0.1".
pub(super) fn written(values: &BTreeMap<String, f64>) -> String {
    let of = |(name, value): (&String, &f64)| format!("{name} = {}", Rounded::every_digit(*value));
    values.iter().map(of).collect::<Vec<_>>().join(", ")
}

/// The results for one set of inputs.
pub(super) fn text(answers: &Row) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    for answer in &answers.results {
        let varies = answer.interval.low < answer.interval.high;
        let verdict = match (answer.validated_digits, &answer.statement) {
            _ if !varies && answer.budget.standard_uncertainty() > 0.0 => {
                "the trials do not vary although u is not zero: the digits in which they differ are lost beside larger \
                 numbers, and nothing confirms the interval above; write the formula so that the large numbers cancel \
                 first"
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
        let _ = writeln!(text, "by trials:\n{trials}\n{verdict}");
        let _ = match &answer.conformity {
            Some(conformity) => writeln!(text, "{}", conformity.text(&answer.budget)),
            None => writeln!(text),
        };
    }
    for plane in &answers.complex {
        let [[real, both], [_, imaginary]] = plane.covariance;
        let _ = writeln!(
            text,
            "{} ({}): covariance matrix of real and imaginary part [[{real:.4e}, {both:.4e}], [{both:.4e}, \
             {imaginary:.4e}]]",
            plane.name, plane.unit
        );
        if let Some(k) = plane.coverage_factor {
            let percent = 100.0 * plane.level;
            let _ = writeln!(text, "the ellipse (z − Z)ᵀ V⁻¹ (z − Z) = k² with k = {k:.3} holds it with {percent} %");
        }
    }
    for Correlation { between: [first, second], coefficient } in &answers.correlations {
        let _ = writeln!(text, "r({first}, {second}) = {coefficient:.3}");
    }
    text
}

/// The results of a sweep, one line each; nothing without one.
pub(super) fn overview(sweep: &[Swept]) -> String {
    if sweep.is_empty() {
        return String::new();
    }
    let mut lines: Vec<Vec<String>> =
        vec![["row", "result", "value and u", "interval by trials", ""].map(str::to_owned).into()];
    for Swept { values, row } in sweep {
        for answer in &row.results {
            let Interval { low, high, .. } = answer.interval;
            let rounded = Rounded::new(answer.budget.estimate(), Some(answer.budget.standard_uncertainty()));
            let verdict = answer
                .conformity
                .as_ref()
                .map_or("", |conformity| if conformity.is_accepted() { "accepted" } else { "not accepted" });
            let name = format!("{} ({})", answer.budget.name(), answer.budget.unit());
            lines.push(vec![
                written(values),
                name,
                rounded.to_string(),
                rounded.interval(low, high),
                verdict.to_owned(),
            ]);
        }
    }
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..5).map(width).collect();
    let line = |line: &Vec<String>| {
        let cells = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    lines.iter().map(line).collect()
}

/// The interval of the trials of a result that has no standard deviation.
fn interval(answer: &Stated) -> String {
    let Interval { low, high, level, .. } = answer.interval;
    let (budget, percent) = (&answer.budget, 100.0 * level);
    let limits = Rounded::new(budget.estimate(), Some(budget.standard_uncertainty())).interval(low, high);
    let why = answer.no_deviation.as_deref().unwrap_or_default();
    format!("{percent} % interval {limits} {}\n{why}", budget.unit())
}
