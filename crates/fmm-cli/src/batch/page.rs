//! A campaign as a page.

use std::fmt::Write;

use fmm_model::Rounded;

use super::campaign::Campaign;
use super::row::{Outcome, Row, quantities};
use super::summary::{Quantity, Summary};
use super::table::{group_lines, quantity_text, statement};
use crate::figure::{Layer, Panel, Role, drawn, label};
use crate::page::{escaped, figure, page as whole_page, table, text_cell};

/// The page of a campaign.
pub(crate) fn page(campaign: &Campaign, rows: &[Row], summary: &Summary) -> String {
    const TITLE: &str = "Friction of a campaign";
    let pictures = summary.quantities.iter().enumerate().map(|(i, quantity)| picture(rows, quantity, i));
    let body = format!(
        "<h1>{TITLE}</h1>\n<p class=\"verdict\">{} of {} records identified</p>\n{}\n\
         <section><h2>Together</h2>\n<p>Consensus with random effects; its interval is that of Hartung and Knapp, which holds for few records. \
         The mean without effects takes the records to differ by their uncertainties only.</p>\n{}{}</section>\n\
         <section><h2>Records</h2>\n{}</section>\n\
         <section><h2>How this was made</h2>\n<dl><dt>Program</dt><dd><code>fmm {}</code></dd><dt>Options for all</dt><dd><code>{}</code></dd></dl></section>\n",
        summary.found,
        summary.records,
        statements(summary),
        together(summary),
        pictures.collect::<String>(),
        records(campaign, rows),
        env!("CARGO_PKG_VERSION"),
        escaped(&campaign.options.join(" ")),
    );
    whole_page(TITLE, &body)
}

/// What the records say together, in sentences.
fn statements(summary: &Summary) -> String {
    let mut statements = String::new();
    for quantity in &summary.quantities {
        // Writing to a string does not fail.
        let _ = writeln!(statements, "<p class=\"statement\">{}</p>", escaped(&statement(quantity)));
        for line in quantity.precision.iter().flat_map(|group| group_lines(quantity, group)) {
            let _ = writeln!(statements, "<p>{}</p>", escaped(&line));
        }
    }
    statements
}

/// What the records say together, as a table.
fn together(summary: &Summary) -> String {
    let row = |quantity: &Quantity| {
        let Quantity { mean, u, interval_95: [low, high], weighted_mean: [weighted, claimed], .. } = *quantity;
        let influential = quantity.most_influential.as_ref();
        vec![
            format!("<th scope=\"row\">{}</th>", escaped(&quantity.name.replace('_', " "))),
            text_cell(&quantity_text(quantity, mean, u)),
            text_cell(&Rounded::new(mean, Some(u)).interval(low, high)),
            text_cell(&format!("{:.3e}", quantity.between)),
            text_cell(&format!("{:.3e}", quantity.between_der_simonian_laird)),
            text_cell(&format!("{:.2e}", quantity.homogeneity_p)),
            text_cell(&format!("{:.0} %", 100.0 * quantity.i_squared)),
            text_cell(&quantity_text(quantity, weighted, claimed)),
            text_cell(&influential.map_or_else(String::new, |(file, moved)| format!("{file}: {moved:+.2} u"))),
            text_cell(&format!("{} (+{})", quantity.records, quantity.left_out)),
        ]
    };
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
    table("findings", &headings, summary.quantities.iter().map(row))
}

/// A row for each record.
fn records(campaign: &Campaign, rows: &[Row]) -> String {
    let (names, columns) = (quantities(rows), campaign.columns());
    let row = |row: &Row| {
        let mut cells = vec![format!("<th scope=\"row\">{}</th>", escaped(&row.file.display().to_string()))];
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

/// Each record's value with two standard uncertainties, and the consensus with its interval.
fn picture(rows: &[Row], quantity: &Quantity, index: usize) -> String {
    let told = rows.iter().enumerate().filter_map(|(place, row)| {
        let value = row.told((&quantity.name, &quantity.unit))?;
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
