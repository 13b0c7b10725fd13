//! A campaign as text, CSV, JSON and a page.

use std::error::Error;
use std::fmt::Write;

use fmm_model::Rounded;

use super::campaign::Campaign;
use super::row::Row;
use super::summary::{ByGroup, Quantity, Summary};
use crate::figure::{Layer, Panel, Role, drawn, label};
use crate::page::{escaped, figure, page as whole_page, table, text_cell};

/// Names of all quantities with their units, in the order in which they first appear.
fn names(rows: &[Row]) -> Vec<(&str, &str)> {
    let mut names: Vec<(&str, &str)> = Vec::new();
    for value in rows.iter().filter_map(|row| row.found.as_ref()).flat_map(|found| &found.findings) {
        if !names.iter().any(|(name, _)| *name == value.name) {
            names.push((&value.name, &value.unit));
        }
    }
    names
}

/// One line for each record, with all digits.
pub(crate) fn csv(campaign: &Campaign, rows: &[Row]) -> Result<String, Box<dyn Error>> {
    let names = names(rows);
    let columns: Vec<&String> =
        campaign.entries.first().map_or_else(Vec::new, |entry| entry.description.keys().collect());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut head: Vec<String> = vec!["file".to_owned()];
    head.extend(columns.iter().map(|column| (*column).clone()));
    head.extend(["law", "refused", "half_swings", "rms_residual", "warnings"].map(str::to_owned));
    head.extend(names.iter().flat_map(|(name, unit)| [format!("{name} [{unit}]"), format!("u({name}) [{unit}]")]));
    writer.write_record(&head)?;
    for row in rows {
        let mut line = vec![row.file.display().to_string()];
        line.extend(columns.iter().map(|column| row.description.get(*column).cloned().unwrap_or_default()));
        let found = row.found.as_ref();
        line.push(found.map_or_else(String::new, |found| found.law.clone()));
        line.push(row.refused.clone().unwrap_or_default());
        line.push(found.map_or_else(String::new, |found| found.half_swings.to_string()));
        line.push(found.map_or_else(String::new, |found| found.rms_residual.to_string()));
        line.push(found.map_or_else(String::new, |found| found.warnings.len().to_string()));
        for (name, unit) in &names {
            let value = row.value(name).filter(|value| value.unit == *unit);
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

fn quantity_text(quantity: &Quantity, value: f64, u: f64) -> String {
    let text = Rounded::new(value, Some(u)).to_string();
    if quantity.unit == "1" { text } else { format!("{text} {}", quantity.unit) }
}

/// The statement on a quantity in a sentence.
fn statement(quantity: &Quantity) -> String {
    let Quantity { mean, u, interval_95: [low, high], records, between, homogeneity_p, .. } = quantity;
    let interval = Rounded::new(*mean, Some(*u)).interval(*low, *high);
    let differ = if *homogeneity_p < 0.05 {
        let share = 100.0 * between / mean.abs();
        let p = if *homogeneity_p < 1e-9 { "p < 1e-9".to_owned() } else { format!("p = {homogeneity_p:.1e}") };
        format!("the records differ beyond their uncertainties ({p}), by {share:.2} % in standard deviation")
    } else {
        format!("the records agree within their uncertainties (p = {homogeneity_p:.2})")
    };
    format!(
        "{} = {}, 95 % within {interval}, from {records} records; {differ}",
        quantity.name,
        quantity_text(quantity, *mean, *u)
    )
}

fn group_lines(quantity: &Quantity, group: &ByGroup) -> Vec<String> {
    let ByGroup { groups, repeatability, between, reproducibility, p_value, farthest, widest, .. } = group;
    let unit = if quantity.unit == "1" { String::new() } else { format!(" {}", quantity.unit) };
    let mut lines = vec![format!(
        "by {} groups: s_r = {repeatability:.3e}{unit}, between {between:.3e}{unit}, s_R = {reproducibility:.3e}{unit}; groups alike: p = \
         {p_value:.2e}",
        groups.len()
    )];
    for (outlier, what) in [(farthest, "lies far off"), (widest, "scatters more than the others")] {
        if let Some((name, p)) = outlier.as_ref().filter(|(_, p)| *p < 0.05) {
            lines.push(format!("group {name} {what} (p = {p:.1e})"));
        }
    }
    lines
}

/// For the eye.
pub(crate) fn text(rows: &[Row], summary: &Summary) -> String {
    let names = names(rows);
    let mut text = String::new();
    let width = rows.iter().map(|row| row.file.display().to_string().len()).max().unwrap_or(0).min(60);
    for row in rows {
        let file = row.file.display().to_string();
        // Writing to a string does not fail.
        let _ = match (&row.found, &row.refused) {
            (Some(found), _) => {
                let values = names
                    .iter()
                    .filter_map(|(name, _)| row.value(name))
                    .map(|value| format!("{} = {} {}", value.name, Rounded::new(value.value, value.u), value.unit));
                let doubts = match found.warnings.len() {
                    0 => String::new(),
                    1 => "  (1 warning)".to_owned(),
                    count => format!("  ({count} warnings)"),
                };
                writeln!(text, "{file:<width$}  {}: {}{doubts}", found.law, values.collect::<Vec<_>>().join(", "))
            }
            (None, refused) => {
                writeln!(text, "{file:<width$}  refused: {}", refused.as_deref().unwrap_or("nothing was found"))
            }
        };
    }
    let _ = writeln!(text, "\n{} of {} records identified", summary.found, summary.records);
    for quantity in &summary.quantities {
        let _ = writeln!(text, "  {}", statement(quantity));
        for line in quantity.precision.iter().flat_map(|group| group_lines(quantity, group)) {
            let _ = writeln!(text, "    {line}");
        }
    }
    text.trim_end().to_owned()
}

/// The page of a campaign.
pub(crate) fn page(campaign: &Campaign, rows: &[Row], summary: &Summary) -> String {
    const TITLE: &str = "Friction of a campaign";
    let mut statements = String::new();
    for quantity in &summary.quantities {
        // Writing to a string does not fail.
        let _ = writeln!(statements, "<p class=\"statement\">{}</p>", escaped(&statement(quantity)));
        for line in quantity.precision.iter().flat_map(|group| group_lines(quantity, group)) {
            let _ = writeln!(statements, "<p>{}</p>", escaped(&line));
        }
    }
    let summaries = summary.quantities.iter().map(|quantity| {
        let [weighted, claimed] = quantity.weighted_mean;
        let influential = quantity.most_influential.as_ref();
        vec![
            format!("<th scope=\"row\">{}</th>", escaped(&quantity.name.replace('_', " "))),
            text_cell(&quantity_text(quantity, quantity.mean, quantity.u)),
            text_cell(
                &Rounded::new(quantity.mean, Some(quantity.u))
                    .interval(quantity.interval_95[0], quantity.interval_95[1]),
            ),
            text_cell(&format!("{:.3e}", quantity.between)),
            text_cell(&format!("{:.3e}", quantity.between_der_simonian_laird)),
            text_cell(&format!("{:.2e}", quantity.homogeneity_p)),
            text_cell(&format!("{:.0} %", 100.0 * quantity.i_squared)),
            text_cell(&quantity_text(quantity, weighted, claimed)),
            text_cell(&influential.map_or_else(String::new, |(file, moved)| format!("{file}: {moved:+.2} u"))),
            text_cell(&format!("{} (+{})", quantity.records, quantity.left_out)),
        ]
    });
    let headings = [
        "quantity",
        "consensus ± u",
        "95 % interval",
        "τ (Mandel-Paule)",
        "τ (DerSimonian-Laird)",
        "p of homogeneity",
        "I²",
        "mean without effects",
        "without it the mean moves by",
        "records (left out)",
    ];
    let summaries = table("findings", &headings, summaries);
    let pictures: String =
        summary.quantities.iter().enumerate().map(|(i, quantity)| picture(rows, quantity, i)).collect();
    let names = names(rows);
    let columns: Vec<&String> =
        campaign.entries.first().map_or_else(Vec::new, |entry| entry.description.keys().collect());
    let lines = rows.iter().map(|row| {
        let mut cells = vec![format!("<th scope=\"row\">{}</th>", escaped(&row.file.display().to_string()))];
        cells.extend(columns.iter().map(|column| text_cell(row.description.get(*column).map_or("", String::as_str))));
        match (&row.found, &row.refused) {
            (Some(found), _) => {
                cells.push(text_cell(&found.law));
                cells.extend(names.iter().map(|(name, _)| {
                    text_cell(
                        &row.value(name)
                            .map_or_else(String::new, |value| Rounded::new(value.value, value.u).to_string()),
                    )
                }));
                cells.push(text_cell(&found.warnings.join(" · ")));
            }
            (None, refused) => cells.push(format!(
                "<td class=\"missed\" colspan=\"{}\">{}</td>",
                names.len() + 2,
                escaped(refused.as_deref().unwrap_or("nothing was found"))
            )),
        }
        cells
    });
    let mut headings: Vec<String> = vec!["record".to_owned()];
    headings.extend(columns.iter().map(|column| (*column).clone()));
    headings.push("law".to_owned());
    headings.extend(names.iter().map(|(name, unit)| label(name.replace('_', " "), unit)));
    headings.push("warnings".to_owned());
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let body = format!(
        "<h1>{TITLE}</h1>\n<p class=\"verdict\">{} of {} records identified</p>\n{statements}\n\
         <section><h2>Together</h2>\n<p>Consensus with random effects; its interval is that of Hartung and Knapp, which holds for few records. \
         The mean without effects takes the records to differ by their uncertainties only.</p>\n{summaries}{pictures}</section>\n\
         <section><h2>Records</h2>\n{}</section>\n\
         <section><h2>How this was made</h2>\n<dl><dt>Program</dt><dd><code>fmm {}</code></dd><dt>Options for all</dt><dd><code>{}</code></dd></dl></section>\n",
        summary.found,
        summary.records,
        table("records", &headings, lines),
        env!("CARGO_PKG_VERSION"),
        escaped(&campaign.options.join(" ")),
    );
    whole_page(TITLE, &body)
}

/// Each record's value with two standard uncertainties, and the consensus with its interval.
fn picture(rows: &[Row], quantity: &Quantity, index: usize) -> String {
    let told = rows.iter().enumerate().filter_map(|(place, row)| {
        let value = row.value(&quantity.name).filter(|value| value.unit == quantity.unit)?;
        Some((place as f64 + 1.0, value.value, value.u?))
    });
    let told: Vec<(f64, f64, f64)> = told.collect();
    let ends = |value: f64| vec![(1.0, value), (rows.len() as f64, value)];
    let [low, high] = quantity.interval_95;
    let mut panel = Panel::new("number of the record", label(quantity.name.replace('_', " "), &quantity.unit), 280.0)
        .with(Layer::new(
            Role::Points,
            "records, with two standard uncertainties",
            told.iter().map(|(x, y, _)| (*x, *y)).collect(),
        ))
        .with(Layer::new(Role::Fitted, "consensus", ends(quantity.mean)))
        .with(Layer::new(Role::Reference, "its 95 % interval", ends(low)))
        .with(Layer::new(Role::ReferenceAgain, "", ends(high)));
    // Of many, bars say nothing and weigh much.
    for (x, y, u) in told.iter().filter(|_| told.len() <= 100) {
        panel = panel.with(Layer::new(Role::MeasuredAgain, "", vec![(*x, y - 2.0 * u), (*x, y + 2.0 * u)]));
    }
    figure(&drawn(&[panel]), &statement(quantity), &format!("quantity-{index}"))
}
