//! A campaign as a page.

use std::fmt::Write;
use std::path::Path;

use fmm_model::Rounded;

use super::campaign::Campaign;
use super::dependence::{Dependence, FRICTION, Line, is_under};
use super::manifest::EXCLUDE;
use super::pooled;
use super::row::{Outcome, Row, Stated, quantities};
use super::sheet::{Field, citation};
use super::summary::{Quantity, Summary};
use super::table::{
    apart_lines, group_lines, is_main, joint_lines, name, probability, records_line, result_line, statement,
};
use crate::figure::{Panel, Role, drawn, label};
use crate::files;
use crate::output::of_size;
use crate::page::{
    bullets, cell, escaped, figure, optional_cell, page as whole_page, paragraphs, row_heading, section, table,
    text_cell, words,
};

/// The page of a campaign.
pub(crate) fn page(campaign: &Campaign, rows: &[Row], summary: &Summary) -> String {
    const TITLE: &str = "Friction of a campaign";
    // The result first, and of other measures of friction what is in the tables.
    let main = summary.main();
    let is_told = |quantity: &&Quantity| is_main(&quantity.name) && !is_friction(&quantity.name);
    let of_result = |quantity: &&Quantity| main.is_some_and(|main| main.name == quantity.name);
    let shown = || {
        let first = summary.quantities.iter().filter(of_result);
        first.chain(summary.quantities.iter().filter(move |quantity| is_told(quantity) && !of_result(quantity)))
    };
    let pictures = shown().enumerate().map(|(i, quantity)| picture(rows, summary, quantity, i));
    let apart = bullets(apart_lines(summary));
    let apart = if apart.is_empty() { apart } else { section("Records that stand apart", &apart) };
    let counted = escaped(&records_line(summary));
    let verdict = match result_line(summary) {
        Some(result) => format!("<p class=\"verdict\">{}</p>\n<p>{counted}.</p>\n", escaped(&result)),
        None => format!("<p class=\"verdict\">{counted}</p>\n"),
    };
    let body = format!(
        "<h1>{TITLE}</h1>\n{verdict}{}{apart}\
         <section><h2>Together</h2>\n<p>Consensus with random effects; its interval is that of Hartung and Knapp, \
         which holds for few records. \
         U = 2 u. The mean without effects takes the records to differ by their uncertainties only. What records \
         share, such as one mass, \
         does not average out. What differs with the load by design has a consensus for each \
         load.</p>\n{}{}</section>\n{}{}{}\
         <section><h2>Records</h2>\n{}</section>\n\
         <section><h2>How this was made</h2>\n<dl><dt>Program</dt><dd><code>fmm \
         {}</code></dd><dt>Measured</dt><dd>{}</dd>\
         <dt>Options for all</dt><dd><code>{}</code></dd></dl></section>\n",
        budget(summary),
        statements(shown()),
        together(summary),
        pictures.collect::<String>() + &summary.friction_curve.as_ref().map_or_else(String::new, pooled::section),
        summary.joint.as_ref().map_or_else(String::new, |_| section("Joint fit", &paragraphs(joint_lines(summary)))),
        [dependences(summary), sheet(summary)].concat(),
        records(campaign, rows),
        env!("CARGO_PKG_VERSION"),
        escaped(&dates(campaign)),
        escaped(&campaign.options.join(" ")),
    );
    whole_page(TITLE, &body)
}

/// The days that the manifest gives.
fn dates(campaign: &Campaign) -> String {
    let is_day = |column: &&str| matches!(column.to_lowercase().as_str(), "date" | "day" | "measured");
    let Some(column) = campaign.columns().into_iter().find(is_day) else {
        return "not given; a column `date` of the manifest says it".to_owned();
    };
    let mut days: Vec<&str> =
        campaign.entries.iter().filter_map(|entry| entry.description.get(column)).map(String::as_str).collect();
    days.retain(|day| !day.is_empty());
    days.sort_unstable();
    match (days.first(), days.last()) {
        (Some(first), Some(last)) if first != last => format!("{first} to {last}"),
        (Some(day), _) => (*day).to_owned(),
        _ => "not given".to_owned(),
    }
}

/// Sources of the uncertainty of the result.
fn budget(summary: &Summary) -> String {
    let Some(quantity) = summary.main() else { return String::new() };
    let square = quantity.u * quantity.u;
    let of_records = (square - quantity.shared_u * quantity.shared_u).max(0.0).sqrt();
    let own = format!("scatter and uncertainties of {} records", quantity.records);
    let shared = quantity.shared.iter().map(|part| {
        let Stated { source, value, u } = &part.input;
        let stated = Rounded::new(*value, Some(*u));
        (format!("{source}, {stated}, shared by {} records", part.records), part.u)
    });
    let row = |(source, u): (String, f64)| {
        let share = if square > 0.0 { 100.0 * u * u / square } else { 0.0 };
        vec![row_heading(&source), text_cell(&of_size(u)), text_cell(&format!("{share:.1} %"))]
    };
    let all = vec![row_heading("all, u"), text_cell(&of_size(quantity.u)), text_cell("100 %")];
    let rows = std::iter::once((own, of_records)).chain(shared).map(row).chain([all]);
    let what = format!("Budget of {}", words(&quantity.name));
    section(&what, &table("budget", &["source", &label("u", &quantity.unit), "share of u²"], rows))
}

/// Consensus of the records, in sentences.
fn statements<'a>(shown: impl Iterator<Item = &'a Quantity>) -> String {
    let mut statements = String::new();
    for quantity in shown {
        // Writing to a string does not fail.
        let _ = writeln!(statements, "<p class=\"statement\">{}</p>", escaped(&statement(quantity)));
        let groups = quantity.precision.iter();
        statements.push_str(&paragraphs(groups.flat_map(|group| group_lines(quantity, group))));
    }
    statements
}

/// Consensus of the records, as two tables: results, and statistics.
fn together(summary: &Summary) -> String {
    if summary.quantities.is_empty() {
        return "<p>No quantity has a consensus.</p>\n".to_owned();
    }
    let heading = |quantity: &Quantity| row_heading(&label(words(&name(quantity)), &quantity.unit));
    let result = |quantity: &Quantity| {
        let Quantity { mean, u, interval_95: [low, high], .. } = *quantity;
        let rounded = Rounded::new(mean, Some(u));
        vec![
            heading(quantity),
            text_cell(&rounded.to_string()),
            text_cell(&of_size(2.0 * u)),
            text_cell(&rounded.interval(low, high)),
            text_cell(&of_size(quantity.shared_u)),
            text_cell(&match quantity.left_out {
                0 => quantity.records.to_string(),
                left_out => format!("{} (+{left_out})", quantity.records),
            }),
        ]
    };
    let statistics =
        |quantity: &Quantity| {
            let [weighted, claimed] = quantity.weighted_mean;
            let influential = quantity.most_influential.as_ref();
            vec![
                heading(quantity),
                text_cell(&of_size(quantity.between)),
                text_cell(&of_size(quantity.between_der_simonian_laird)),
                text_cell(probability(quantity.p).trim_start_matches("= ")),
                text_cell(&format!("{:.0} %", 100.0 * quantity.i_squared)),
                text_cell(&Rounded::new(weighted, Some(claimed)).to_string()),
                optional_cell(quantity.joint.map(|(value, u)| Rounded::new(value, u).to_string())),
                text_cell(&influential.map_or_else(String::new, |(file, moved)| {
                    format!("{}: {moved:+.2} u", files::name(Path::new(file)))
                })),
            ]
        };
    let results = ["quantity", "consensus ± u", "U (k = 2)", "95 % interval", "of u shared", "records (left out)"];
    let further = [
        "quantity",
        "τ (Mandel-Paule)",
        "τ (DerSimonian-Laird)",
        "p",
        "I²",
        "mean without effects",
        "joint fit",
        "without it the mean moves by",
    ];
    [
        table("findings", &results, summary.quantities.iter().map(result)),
        "<p>How the records differ:</p>\n".to_owned(),
        table("findings", &further, summary.quantities.iter().map(statistics)),
    ]
    .concat()
}

/// True for a measure of friction.
fn is_friction(name: &str) -> bool {
    FRICTION.iter().any(|ending| name.ends_with(ending))
}

/// True for a column that a page has room for: uncertainties of inputs are in the budget, reasons in a list.
fn is_shown(column: &str) -> bool {
    column != EXCLUDE && !column.ends_with("_u") && !column.ends_with("-u")
}

/// A row for each record, and the warnings below.
fn records(campaign: &Campaign, rows: &[Row]) -> String {
    let names = quantities(&rows.iter().collect::<Vec<_>>());
    // A page has room for one measure of friction: the one that tells most.
    let measure = FRICTION.iter().find_map(|ending| names.iter().find(|(name, _)| name.ends_with(ending))).copied();
    let names: Vec<(&str, &str)> =
        names.into_iter().filter(|name| is_main(name.0) && (!is_friction(name.0) || Some(*name) == measure)).collect();
    let cell_of = |row: &Row, column: &str| row.description.get(column).cloned().unwrap_or_default();
    // What is alike in all is said once.
    let (alike, columns): (Vec<&str>, Vec<&str>) =
        campaign.columns().into_iter().filter(|column| is_shown(column)).partition(|column| {
            let mut cells = rows.iter().map(|row| cell_of(row, column));
            let first = cells.next();
            rows.len() > 1 && cells.all(|cell| Some(cell) == first)
        });
    let laws = || rows.iter().filter_map(Row::found).map(|found| found.law.as_str());
    let one_law = laws().all(|law| Some(law) == laws().next());
    let row = |row: &Row| {
        let mut cells = vec![format!(
            "<th scope=\"row\" title=\"{}\">{}</th>",
            escaped(&row.file.display().to_string()),
            escaped(&files::name(&row.file))
        )];
        cells.extend(columns.iter().map(|column| text_cell(&cell_of(row, column))));
        match &row.outcome {
            Outcome::Found(found) => {
                let told = |quantity| row.told(quantity).map(|told| Rounded::new(told.value, told.u).to_string());
                cells.extend((!one_law).then(|| text_cell(&found.law)));
                cells.extend(names.iter().map(|quantity| text_cell(&told(*quantity).unwrap_or_default())));
                cells.push(match (found.doubts.is_empty(), found.warnings.len()) {
                    (false, _) => "<td class=\"missed\">doubtful</td>".to_owned(),
                    (true, count) => text_cell(&count.to_string()),
                });
            }
            Outcome::Refused(why) => {
                cells.push(format!(
                    "<td class=\"missed\" colspan=\"{}\">{}</td>",
                    names.len() + 1 + usize::from(!one_law),
                    escaped(why)
                ));
            }
        }
        cells
    };
    let mut headings: Vec<String> = vec!["record".to_owned()];
    headings.extend(columns.iter().map(ToString::to_string));
    headings.extend((!one_law).then(|| "law".to_owned()));
    headings.extend(names.iter().map(|(name, unit)| label(words(name), unit)));
    headings.push("warnings".to_owned());
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let alike: Vec<String> = alike
        .into_iter()
        .filter_map(|column| Some((column, cell_of(rows.first()?, column))))
        .filter(|(_, cell)| !cell.is_empty())
        .map(|(column, cell)| format!("{column} = {cell}"))
        .chain(laws().next().filter(|_| one_law).map(|law| format!("law = {law}")))
        .collect();
    let alike = if alike.is_empty() {
        String::new()
    } else {
        format!("<p>Of all records: {}.</p>\n", escaped(&alike.join(", ")))
    };
    let warned = rows.iter().filter_map(|row| {
        let found = row.found().filter(|found| !found.warnings.is_empty())?;
        Some(format!(
            "<details><summary>{}: {} warnings</summary>\n{}</details>\n",
            escaped(&files::name(&row.file)),
            found.warnings.len(),
            bullets(found.warnings.iter().cloned())
        ))
    });
    format!(
        "{alike}{}<p>All quantities, with all digits, are in the table campaign.csv and in the document \
         campaign.json.</p>\n{}",
        table("records", &headings, rows.iter().map(row)),
        warned.collect::<String>()
    )
}

/// Friction against what differs between the records.
fn dependences(summary: &Summary) -> String {
    if summary.dependences.is_empty() {
        return String::new();
    }
    let shown = summary.dependences.iter().enumerate().map(|(index, dependence)| {
        let Dependence { quantity, unit, against, against_unit, statement, line, points, .. } = dependence;
        let Some(Line { band, .. }) = line else { return format!("<p>{}</p>\n", escaped(statement)) };
        let name = words(against);
        let x_label = if against_unit.is_empty() { name } else { label(name, against_unit) };
        let part = |value: fn(&(f64, f64, f64, f64)) -> f64| band.iter().map(move |at| (at.0, value(at)));
        let panel = Panel::new(x_label, label(words(quantity), unit), 300.0)
            .with_bars("records", points)
            .with(Role::Fitted, "line, with an effect of each record", part(|at| at.1))
            .with(Role::Reference, "its 95 % interval", part(|at| at.2))
            .with(Role::Reference, "", part(|at| at.3));
        figure(&drawn(&[panel]), statement, &format!("dependence-{index}"))
    });
    format!(
        "<section><h2>Friction against load, amplitude and more</h2>\n<p>Lines with random effects: the records may \
         differ beside the line by more than their uncertainties. The intervals are those of Knapp and Hartung. The \
         coefficient of a line over the load allows for a force without load and has nothing in its u of what records \
         share: the result is the consensus above, not this one.</p>\n{}</section>\n",
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
        "<section><h2>Record sheet</h2>\n<p>What a friction coefficient is handed on with, by the fields of ASTM G115 \
         as far as they are public.</p>\n{}{}</section>\n",
        paragraphs(citation(fields).map(|reference| format!("Cite the data as: {reference}."))),
        table("sheet", &["part", "field", "value"], fields.iter().map(row))
    )
}

/// Each record's value, and the consensus with its interval.
fn picture(rows: &[Row], summary: &Summary, quantity: &Quantity, index: usize) -> String {
    let belongs = |row: &Row| quantity.loads.is_none_or(|loads| is_under(row, loads));
    let told = rows.iter().enumerate().filter(|(_, row)| belongs(row)).filter_map(|(place, row)| {
        let value = row.told((&quantity.name, &quantity.unit))?;
        Some(((place as f64 + 1.0, value.value, value.u?), row.counts(summary.counts_doubtful)))
    });
    let (counted, doubtful): (Vec<_>, Vec<_>) = told.partition(|(_, counts)| *counts);
    let points = |told: Vec<((f64, f64, f64), bool)>| told.into_iter().map(|(point, _)| point).collect::<Vec<_>>();
    let ends = |value: f64| [(1.0, value), (rows.len() as f64, value)];
    let [low, high] = quantity.interval_95;
    let panel = Panel::new("number of the record", label(words(&name(quantity)), &quantity.unit), 280.0);
    let panel = panel
        .with_bars("records", &points(counted))
        .with(Role::Fitted, "consensus", ends(quantity.mean))
        .with(Role::Reference, "its 95 % interval", ends(low))
        .with(Role::Reference, "", ends(high));
    let doubtful: Vec<(f64, f64)> = doubtful.into_iter().map(|((place, value, _), _)| (place, value)).collect();
    let panel =
        if doubtful.is_empty() { panel } else { panel.with(Role::FittedPoints, "doubtful, not counted", doubtful) };
    figure(&drawn(&[panel]), &statement(quantity), &format!("quantity-{index}"))
}
