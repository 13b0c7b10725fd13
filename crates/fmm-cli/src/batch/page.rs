//! A campaign as a page.

use std::fmt::Write;

use fmm_model::Rounded;

use super::campaign::Campaign;
use super::dependence::{Dependence, Line};
use super::row::{Outcome, Row, quantities};
use super::sheet::Field;
use super::summary::{Quantity, Summary};
use super::table::{doubt_lines, group_lines, joint_lines, quantity_text, statement};
use crate::figure::{Panel, Role, drawn, label};
use crate::page::{
    cell, escaped, figure, optional_cell, page as whole_page, paragraphs, row_heading, section, table, text_cell,
};

/// The page of a campaign.
pub(crate) fn page(campaign: &Campaign, rows: &[Row], summary: &Summary) -> String {
    const TITLE: &str = "Friction of a campaign";
    let pictures = summary.quantities.iter().enumerate().map(|(i, quantity)| picture(rows, quantity, i));
    let body = format!(
        "<h1>{TITLE}</h1>\n<p class=\"verdict\">{} of {} records identified</p>\n{}\n\
         <section><h2>Together</h2>\n<p>Consensus with random effects; its interval is that of Hartung and Knapp, which holds for few records. \
         The mean without effects takes the records to differ by their uncertainties only. What records share, such as one mass, does not \
         average out.</p>\n{}{}</section>\n{}{}{}\
         <section><h2>Records</h2>\n{}</section>\n\
         <section><h2>How this was made</h2>\n<dl><dt>Program</dt><dd><code>fmm {}</code></dd><dt>Options for all</dt><dd><code>{}</code></dd></dl></section>\n",
        summary.found,
        summary.records,
        statements(summary),
        together(summary),
        pictures.collect::<String>(),
        summary.joint.as_ref().map_or_else(String::new, |_| section("Joint fit", &paragraphs(joint_lines(summary)))),
        dependences(summary),
        sheet(summary),
        records(campaign, rows),
        env!("CARGO_PKG_VERSION"),
        escaped(&campaign.options.join(" ")),
    );
    whole_page(TITLE, &body)
}

/// Consensus of the records, in sentences.
fn statements(summary: &Summary) -> String {
    let mut statements = paragraphs(doubt_lines(summary));
    for quantity in &summary.quantities {
        // Writing to a string does not fail.
        let _ = writeln!(statements, "<p class=\"statement\">{}</p>", escaped(&statement(quantity)));
        let groups = quantity.precision.iter();
        statements.push_str(&paragraphs(groups.flat_map(|group| group_lines(quantity, group))));
    }
    statements
}

/// Consensus of the records, as a table.
fn together(summary: &Summary) -> String {
    let row = |quantity: &Quantity| {
        let Quantity { mean, u, interval_95: [low, high], weighted_mean: [weighted, claimed], joint, .. } = *quantity;
        let influential = quantity.most_influential.as_ref();
        vec![
            row_heading(&quantity.name.replace('_', " ")),
            text_cell(&quantity_text(quantity, mean, u)),
            text_cell(&Rounded::new(mean, Some(u)).interval(low, high)),
            text_cell(&format!("{:.1e}", quantity.shared_u)),
            text_cell(&format!("{:.3e}", quantity.between)),
            text_cell(&format!("{:.3e}", quantity.between_der_simonian_laird)),
            text_cell(&format!("{:.2e}", quantity.p)),
            text_cell(&format!("{:.0} %", 100.0 * quantity.i_squared)),
            text_cell(&quantity_text(quantity, weighted, claimed)),
            optional_cell(joint.map(|(value, u)| Rounded::new(value, u).to_string())),
            text_cell(&influential.map_or_else(String::new, |(file, moved)| format!("{file}: {moved:+.2} u"))),
            text_cell(&format!("{} (+{})", quantity.records, quantity.left_out)),
        ]
    };
    let headings = [
        "quantity",
        "consensus ± u",
        "95 % interval",
        "of u shared by records",
        "τ (Mandel-Paule)",
        "τ (DerSimonian-Laird)",
        "p",
        "I²",
        "mean without effects",
        "joint fit",
        "without it the mean moves by",
        "records (left out)",
    ];
    table("findings", &headings, summary.quantities.iter().map(row))
}

/// A row for each record.
fn records(campaign: &Campaign, rows: &[Row]) -> String {
    let (names, columns) = (quantities(rows), campaign.columns());
    let row = |row: &Row| {
        let mut cells = vec![row_heading(&row.file.display().to_string())];
        cells.extend(columns.iter().map(|column| text_cell(row.description.get(*column).map_or("", String::as_str))));
        match &row.outcome {
            Outcome::Found(found) => {
                let told = |quantity| row.told(quantity).map(|told| Rounded::new(told.value, told.u).to_string());
                cells.push(text_cell(&found.law));
                cells.extend(names.iter().map(|quantity| text_cell(&told(*quantity).unwrap_or_default())));
                cells.push(text_cell(&found.warnings.join(" · ")));
            }
            Outcome::Refused(why) => {
                cells.push(format!("<td class=\"missed\" colspan=\"{}\">{}</td>", names.len() + 2, escaped(why)));
            }
        }
        cells
    };
    let mut headings: Vec<String> = vec!["record".to_owned()];
    headings.extend(columns.iter().map(ToString::to_string));
    headings.push("law".to_owned());
    headings.extend(names.iter().map(|(name, unit)| label(name.replace('_', " "), unit)));
    headings.push("warnings".to_owned());
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    table("records", &headings, rows.iter().map(row))
}

/// Friction against what differs between the records.
fn dependences(summary: &Summary) -> String {
    if summary.dependences.is_empty() {
        return String::new();
    }
    let shown = summary.dependences.iter().enumerate().map(|(index, dependence)| {
        let Dependence { quantity, unit, against, against_unit, statement, line, points, .. } = dependence;
        let Some(Line { band, .. }) = line else { return format!("<p>{}</p>\n", escaped(statement)) };
        let name = against.replace('_', " ");
        let x_label = if against_unit.is_empty() { name } else { label(name, against_unit) };
        let part = |value: fn(&(f64, f64, f64, f64)) -> f64| band.iter().map(move |at| (at.0, value(at)));
        let panel = with_records(Panel::new(x_label, label(quantity.replace('_', " "), unit), 300.0), points)
            .with(Role::Fitted, "line, with an effect of each record", part(|at| at.1))
            .with(Role::Reference, "its 95 % interval", part(|at| at.2))
            .with(Role::Reference, "", part(|at| at.3));
        figure(&drawn(&[panel]), statement, &format!("dependence-{index}"))
    });
    format!(
        "<section><h2>Friction against load, amplitude and more</h2>\n<p>Lines with random effects: the records may differ beside the line by \
         more than their uncertainties. The intervals are those of Knapp and Hartung.</p>\n{}</section>\n",
        shown.collect::<String>()
    )
}

/// The record sheet, if the manifest has one.
fn sheet(summary: &Summary) -> String {
    let Some(fields) = &summary.sheet else { return String::new() };
    let row = |field: &Field| {
        let value = match &field.value {
            Some(value) if field.is_found => {
                cell(&format!("{} <span class=\"note\">by the records</span>", escaped(value)))
            }
            Some(value) => text_cell(value),
            None => cell("<span class=\"note\">not given</span>"),
        };
        vec![text_cell(field.part), row_heading(&field.name), value]
    };
    format!(
        "<section><h2>Record sheet</h2>\n<p>What a friction coefficient is handed on with, by the fields of ASTM G115 as far as they are \
         public.</p>\n{}</section>\n",
        table("sheet", &["part", "field", "value"], fields.iter().map(row))
    )
}

/// Records as points (place, value, standard uncertainty) with bars of two standard uncertainties.
fn with_records(panel: Panel, points: &[(f64, f64, f64)]) -> Panel {
    let dots = points.iter().map(|(x, y, _)| (*x, *y));
    let panel = panel.with(Role::Points, "records, with two standard uncertainties", dots);
    // Of many, bars say nothing and weigh much.
    points
        .iter()
        .filter(|_| points.len() <= 100)
        .fold(panel, |panel, (x, y, u)| panel.with(Role::Measured, "", [(*x, y - 2.0 * u), (*x, y + 2.0 * u)]))
}

/// Each record's value, and the consensus with its interval.
fn picture(rows: &[Row], quantity: &Quantity, index: usize) -> String {
    let told = rows.iter().enumerate().filter_map(|(place, row)| {
        let value = row.told((&quantity.name, &quantity.unit))?;
        Some((place as f64 + 1.0, value.value, value.u?))
    });
    let told: Vec<(f64, f64, f64)> = told.collect();
    let ends = |value: f64| [(1.0, value), (rows.len() as f64, value)];
    let [low, high] = quantity.interval_95;
    let panel = Panel::new("number of the record", label(quantity.name.replace('_', " "), &quantity.unit), 280.0);
    let panel = with_records(panel, &told)
        .with(Role::Fitted, "consensus", ends(quantity.mean))
        .with(Role::Reference, "its 95 % interval", ends(low))
        .with(Role::Reference, "", ends(high));
    figure(&drawn(&[panel]), &statement(quantity), &format!("quantity-{index}"))
}
