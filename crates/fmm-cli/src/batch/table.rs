//! A campaign as text, CSV and JSON.

use std::error::Error;
use std::fmt::Write;

use fmm_model::Rounded;
use serde::Serialize;

use super::campaign::Campaign;
use super::dependence::FRICTION;
use super::pooled::{self, Pooled};
use super::row::{Found, Outcome, Row, Told, curve_quantities, in_unit, quantities};
use super::sheet::Field;
use super::summary::{ByGroup, Outlying, Quantity, Summary};
use crate::answer::Document;
use crate::output::of_size;

/// One line for each record, with all digits.
pub(crate) fn csv(campaign: &Campaign, rows: &[Row]) -> Result<String, Box<dyn Error>> {
    let mut names = quantities(&rows.iter().collect::<Vec<_>>());
    names.extend(curve_quantities(rows));
    let columns = campaign.columns();
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut head: Vec<String> = vec!["file".to_owned()];
    head.extend(columns.iter().map(ToString::to_string));
    head.extend(
        ["law", "refused", "half_swings", "amplitude", "rms_residual", "record_unit", "warnings"].map(str::to_owned),
    );
    head.extend(names.iter().flat_map(|(name, unit)| [format!("{name} [{unit}]"), format!("u({name}) [{unit}]")]));
    writer.write_record(&head)?;
    for row in rows {
        let mut line = vec![row.file.display().to_string()];
        line.extend(columns.iter().map(|column| row.description.get(*column).cloned().unwrap_or_default()));
        line.extend(match &row.outcome {
            Outcome::Found(Found { law, half_swings, amplitude, rms_residual, unit, warnings, .. }) => [
                law.clone(),
                String::new(),
                half_swings.to_string(),
                amplitude.to_string(),
                rms_residual.to_string(),
                unit.clone(),
                warnings.len().to_string(),
            ],
            Outcome::Refused(why) => {
                let mut cells = [const { String::new() }; 7];
                cells[1].clone_from(why);
                cells
            }
        });
        for (name, unit) in &names {
            let value = row.told((name, unit));
            line.push(value.map_or_else(String::new, |value| value.value.to_string()));
            line.push(value.and_then(|value| value.u).map_or_else(String::new, |u| u.to_string()));
        }
        writer.write_record(&line)?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// A campaign for programs.
#[derive(Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Content<'a> {
    summary: &'a Summary,
    records: &'a [Row],
}

/// Everything, for other programs.
pub(crate) fn document(rows: &[Row], summary: &Summary) -> Result<String, Box<dyn Error>> {
    Document::new("batch-1", Content { summary, records: rows }).pretty()
}

pub(super) fn quantity_text(quantity: &Quantity, value: f64, u: f64) -> String {
    in_unit(Rounded::new(value, Some(u)), &quantity.unit)
}

/// The statement on a quantity in a sentence.
pub(super) fn statement(quantity: &Quantity) -> String {
    let Quantity { mean, u, interval_95: [low, high], records, between, p, .. } = quantity;
    let interval = Rounded::new(*mean, Some(*u)).interval(*low, *high);
    let differ = if *p < 0.05 {
        let share = 100.0 * between / mean.abs();
        let p = probability(*p);
        format!("the records differ beyond their uncertainties (p {p}), by {share:.2} % in standard deviation")
    } else {
        format!("the records agree within their uncertainties (p = {p:.2})")
    };
    format!(
        "{} = {}, 95 % within {interval}, from {records} records{}; {differ}",
        name(quantity),
        quantity_text(quantity, *mean, *u),
        shared(quantity)
    )
}

/// The name of a quantity, with the load that it belongs to.
pub(super) fn name(quantity: &Quantity) -> String {
    match quantity.loads {
        None => quantity.name.clone(),
        Some((low, high)) if low == high => format!("{} under {low} N", quantity.name),
        Some((low, high)) => format!("{} under {low} N to {high} N", quantity.name),
    }
}

/// Result of the campaign in a sentence: friction with its expanded uncertainty for k = 2.
pub(super) fn result_line(summary: &Summary) -> Option<String> {
    let quantity = summary.main()?;
    let Quantity { mean, u, interval_95: [low, high], .. } = *quantity;
    let stated = Rounded::new(mean, Some(2.0 * u));
    let text = stated.to_string();
    // A common power of ten belongs to both.
    let (value, expanded) = text.split_once(" ± ").unwrap_or((&text, ""));
    let (value, power) = match value.strip_prefix('(') {
        Some(value) => (value, expanded.split_once(')').map_or("", |(_, power)| power)),
        None => (value, ""),
    };
    let expanded = expanded.split(')').next().unwrap_or_default();
    Some(format!(
        "{} = {}, U = {} (k = 2); 95 % within {} by Student's t, from {} records",
        quantity.name.replace('_', " "),
        in_unit(format_args!("{value}{power}"), &quantity.unit),
        in_unit(format_args!("{expanded}{power}"), &quantity.unit),
        stated.interval(low, high),
        quantity.records
    ))
}

/// The number of records that were identified, count, and were left out.
pub(super) fn records_line(summary: &Summary) -> String {
    let Summary { records, found, counted, .. } = summary;
    let counted = if counted < found { format!(", of which {counted} count") } else { String::new() };
    let excluded = match summary.excluded.len() {
        0 => String::new(),
        count => format!("; {count} left out by the manifest"),
    };
    format!("{found} of {records} records identified{counted}{excluded}")
}

/// A small probability behind its letter.
pub(super) fn probability(p: f64) -> String {
    match p {
        p if p < 1e-9 => "< 1e-9".to_owned(),
        p if p < 0.01 => format!("= {p:.1e}"),
        p => format!("= {p:.2}"),
    }
}

/// Shared part of u, if there is one.
fn shared(quantity: &Quantity) -> String {
    if quantity.shared.is_empty() {
        return String::new();
    }
    let mut sources: Vec<&str> = quantity.shared.iter().map(|part| part.input.source.as_str()).collect();
    sources.dedup();
    let u = in_unit(of_size(quantity.shared_u), &quantity.unit);
    format!(" (of u shared by records: {u} by {})", sources.join(", "))
}

/// Name, value, uncertainty and unit.
fn named_value(told: &Told) -> String {
    format!("{} = {}", told.name, in_unit(Rounded::new(told.value, told.u), &told.unit))
}

/// Joint fit in sentences.
pub(super) fn joint_lines(summary: &Summary) -> Vec<String> {
    let together = match &summary.joint {
        None => return Vec::new(),
        Some(Outcome::Refused(why)) => return vec![format!("no joint fit: {why}")],
        Some(Outcome::Found(together)) => together,
    };
    let values: Vec<String> = together.findings.iter().map(named_value).collect();
    let load = together.reference_load.map_or_else(String::new, |load| {
        format!(" (levels at a load of {load} N; the law is in proportion to it, linear damping beside the law is not)")
    });
    let mut lines = vec![
        format!("joint fit of {} records by {}: {}{load}", together.records, together.law, values.join(", ")),
        "the joint fit takes machine and law for the same in all records: what differs between them is not in its \
         uncertainties"
            .to_owned(),
    ];
    let differ: Vec<&str> = summary
        .quantities
        .iter()
        .filter(|quantity| quantity.joint.is_some() && quantity.p < 0.05)
        .map(|quantity| quantity.name.as_str())
        .collect();
    if !differ.is_empty() {
        lines.push(format!(
            "the records differ beyond their uncertainties in {}: there the joint uncertainties are too small, and the \
             consensus counts",
            differ.join(", ")
        ));
    }
    lines.extend(together.warnings.iter().map(|warning| format!("warning of the joint fit: {warning}")));
    lines
}

/// The records that stand apart: left out by the manifest, doubted, or far from the others.
pub(super) fn apart_lines(summary: &Summary) -> Vec<String> {
    let excluded = summary.excluded.iter().map(|record| format!("{}: {}", record.file, record.reason));
    let counted = if summary.counts_doubtful { "counted as was asked" } else { "not counted" };
    let doubted = summary
        .doubted
        .iter()
        .map(|record| format!("doubtful, {counted}: {}: {}", record.file, record.doubts.join("; ")));
    let mut lines: Vec<String> = excluded.chain(doubted).collect();
    // Of a record one line, by the quantity that tells most.
    let by_information = FRICTION.iter().copied().chain(["natural_frequency_hz", "damping_ratio"]);
    let quantities =
        by_information.flat_map(|ending| summary.quantities.iter().filter(move |one| one.name.ends_with(ending)));
    let quantities = quantities.chain(summary.friction_curve.iter().flat_map(Pooled::stated));
    let mut named: Vec<&str> = Vec::new();
    for (quantity, record) in
        quantities.flat_map(|quantity| quantity.outlying.iter().map(move |record| (quantity, record)))
    {
        let Outlying { file, relative, p } = record;
        if named.contains(&file.as_str()) {
            continue;
        }
        named.push(file);
        lines.push(format!(
            "far from the others, but counted: {file}: its {} lies {:+.1} % off (p {}); look at this record, and leave \
             it out by `exclude` in the manifest if there is a reason",
            name(quantity),
            100.0 * relative,
            probability(*p)
        ));
    }
    if summary.found > 1 && summary.counted < 2 {
        lines.push(
            "fewer than two records are free of doubt, so that there is no consensus; --count-doubtful counts the \
             others as well"
                .to_owned(),
        );
    }
    lines
}

/// Quantities that a table has room for; all of them are in the document and in campaign.csv.
pub(super) fn is_main(name: &str) -> bool {
    FRICTION.iter().any(|ending| name.ends_with(ending)) || ["natural_frequency_hz", "damping_ratio"].contains(&name)
}

/// Fields of the record sheet without a value.
pub(super) fn sheet_line(fields: &[Field]) -> String {
    let missing: Vec<String> = fields
        .iter()
        .filter(|field| field.value.is_none())
        .map(|field| format!("{} ({})", field.name, field.part.to_lowercase()))
        .collect();
    if missing.is_empty() {
        "record sheet: every field is given".to_owned()
    } else {
        format!("record sheet, not given: {}", missing.join(", "))
    }
}

pub(super) fn group_lines(quantity: &Quantity, group: &ByGroup) -> Vec<String> {
    let ByGroup { groups, repeatability, between, reproducibility, p, farthest, widest, .. } = group;
    let [within, between, all] =
        [repeatability, between, reproducibility].map(|s| in_unit(of_size(*s), &quantity.unit));
    let count = groups.len();
    let mut lines = vec![format!(
        "by {count} groups: s_r = {within}, between {between}, s_R = {all}; groups alike: p {}",
        probability(*p)
    )];
    for (outlier, what) in [(farthest, "lies far off"), (widest, "scatters more than the others")] {
        if let Some((name, p)) = outlier.as_ref().filter(|(_, p)| *p < 0.05) {
            lines.push(format!("group {name} {what} (p {})", probability(*p)));
        }
    }
    lines
}

/// Form for the eye.
pub(crate) fn text(rows: &[Row], summary: &Summary) -> String {
    let names: Vec<(&str, &str)> =
        quantities(&rows.iter().collect::<Vec<_>>()).into_iter().filter(|(name, _)| is_main(name)).collect();
    let mut text = String::new();
    let width = rows.iter().map(|row| row.file.display().to_string().len()).max().unwrap_or(0).min(60);
    for row in rows {
        let file = row.file.display().to_string();
        // Writing to a string does not fail.
        let _ = match &row.outcome {
            Outcome::Found(found) => {
                let values = names.iter().filter_map(|quantity| row.told(*quantity)).map(named_value);
                let doubtful = if found.doubts.is_empty() { "" } else { "  (doubtful)" };
                let doubts = match found.warnings.len() {
                    0 => String::new(),
                    1 => "  (1 warning)".to_owned(),
                    count => format!("  ({count} warnings)"),
                };
                writeln!(
                    text,
                    "{file:<width$}  {}: {}{doubts}{doubtful}",
                    found.law,
                    values.collect::<Vec<_>>().join(", ")
                )
            }
            Outcome::Refused(why) if row.is_excluded => writeln!(text, "{file:<width$}  {why}"),
            Outcome::Refused(why) => writeln!(text, "{file:<width$}  refused: {why}"),
        };
    }
    let _ = writeln!(text, "\n{}", records_line(summary));
    for line in result_line(summary).into_iter().chain(apart_lines(summary)) {
        let _ = writeln!(text, "  {line}");
    }
    for quantity in &summary.quantities {
        let _ = writeln!(text, "  {}", statement(quantity));
        for line in quantity.precision.iter().flat_map(|group| group_lines(quantity, group)) {
            let _ = writeln!(text, "    {line}");
        }
    }
    let curves = summary.friction_curve.iter().flat_map(pooled::lines);
    let dependences = summary.dependences.iter().map(|dependence| dependence.statement.clone());
    let sheet = summary.sheet.as_deref().map(sheet_line);
    for line in curves.chain(dependences).chain(joint_lines(summary)).chain(sheet) {
        let _ = writeln!(text, "  {line}");
    }
    text.trim_end().to_owned()
}
