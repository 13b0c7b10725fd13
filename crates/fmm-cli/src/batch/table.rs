//! A campaign as text, CSV and JSON.

use std::error::Error;
use std::fmt::Write;

use fmm_model::Rounded;

use super::campaign::Campaign;
use super::row::{Found, Outcome, Row, Told, in_unit, quantities};
use super::sheet::Field;
use super::summary::{ByGroup, Quantity, Summary};

/// One line for each record, with all digits.
pub(crate) fn csv(campaign: &Campaign, rows: &[Row]) -> Result<String, Box<dyn Error>> {
    let names = quantities(rows);
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

/// Everything, for other programs.
pub(crate) fn document(rows: &[Row], summary: &Summary) -> Result<String, Box<dyn Error>> {
    Ok(serde_json::to_string_pretty(&serde_json::json!({ "summary": summary, "records": rows }))?)
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
        let less = if *p < 1e-9 { "p < 1e-9".to_owned() } else { format!("p = {p:.1e}") };
        format!("the records differ beyond their uncertainties ({less}), by {share:.2} % in standard deviation")
    } else {
        format!("the records agree within their uncertainties (p = {p:.2})")
    };
    format!(
        "{} = {}, 95 % within {interval}, from {records} records{}; {differ}",
        quantity.name,
        quantity_text(quantity, *mean, *u),
        shared(quantity)
    )
}

/// Shared part of u, if there is one.
fn shared(quantity: &Quantity) -> String {
    if quantity.shared.is_empty() {
        return String::new();
    }
    let mut sources: Vec<&str> = quantity.shared.iter().map(|part| part.input.source.as_str()).collect();
    sources.dedup();
    let u = in_unit(format_args!("{:.1e}", quantity.shared_u), &quantity.unit);
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
        "the joint fit takes machine and law for the same in all records: what differs between them is not in its uncertainties"
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
            "the records differ beyond their uncertainties in {}: there the joint uncertainties are too small, and the consensus counts",
            differ.join(", ")
        ));
    }
    lines.extend(together.warnings.iter().map(|warning| format!("warning of the joint fit: {warning}")));
    lines
}

/// The records that count although their fit is doubted.
pub(super) fn doubt_lines(summary: &Summary) -> impl Iterator<Item = String> {
    summary
        .doubted
        .iter()
        .map(|record| format!("doubted, but counted below: {}: {}", record.file, record.doubts.join("; ")))
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
        [repeatability, between, reproducibility].map(|s| in_unit(format_args!("{s:.3e}"), &quantity.unit));
    let count = groups.len();
    let mut lines =
        vec![format!("by {count} groups: s_r = {within}, between {between}, s_R = {all}; groups alike: p = {p:.2e}")];
    for (outlier, what) in [(farthest, "lies far off"), (widest, "scatters more than the others")] {
        if let Some((name, p)) = outlier.as_ref().filter(|(_, p)| *p < 0.05) {
            lines.push(format!("group {name} {what} (p = {p:.1e})"));
        }
    }
    lines
}

/// For the eye.
pub(crate) fn text(rows: &[Row], summary: &Summary) -> String {
    let names = quantities(rows);
    let mut text = String::new();
    let width = rows.iter().map(|row| row.file.display().to_string().len()).max().unwrap_or(0).min(60);
    for row in rows {
        let file = row.file.display().to_string();
        // Writing to a string does not fail.
        let _ = match &row.outcome {
            Outcome::Found(found) => {
                let values = names.iter().filter_map(|quantity| row.told(*quantity)).map(named_value);
                let doubts = match found.warnings.len() {
                    0 => String::new(),
                    1 => "  (1 warning)".to_owned(),
                    count => format!("  ({count} warnings)"),
                };
                writeln!(text, "{file:<width$}  {}: {}{doubts}", found.law, values.collect::<Vec<_>>().join(", "))
            }
            Outcome::Refused(why) => writeln!(text, "{file:<width$}  refused: {why}"),
        };
    }
    let _ = writeln!(text, "\n{} of {} records identified", summary.found, summary.records);
    for line in doubt_lines(summary) {
        let _ = writeln!(text, "  {line}");
    }
    for quantity in &summary.quantities {
        let _ = writeln!(text, "  {}", statement(quantity));
        for line in quantity.precision.iter().flat_map(|group| group_lines(quantity, group)) {
            let _ = writeln!(text, "    {line}");
        }
    }
    let dependences = summary.dependences.iter().map(|dependence| dependence.statement.clone());
    let sheet = summary.sheet.as_deref().map(sheet_line);
    for line in dependences.chain(joint_lines(summary)).chain(sheet) {
        let _ = writeln!(text, "  {line}");
    }
    text.trim_end().to_owned()
}
