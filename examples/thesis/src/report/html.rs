//! Pieces of the page: tables, findings, figures, errata.

use std::collections::BTreeSet;

use fmm_cli::page::{cell, escaped, figure as picture, marked, table, text_cell};

use super::errata::Erratum;
use crate::{Drawing, Finding, Table, Target};

/// A table of the thesis beside ours.
pub(super) fn printed_table(content: &Table) -> String {
    let headings: Vec<&str> = content.headings.iter().map(String::as_str).collect();
    let rows = content.rows.iter().map(|row| row.iter().map(|text| text_cell(text)).collect());
    format!(
        "<figure class=\"table\"><figcaption>{}</figcaption>\n{}</figure>\n",
        escaped(&content.caption),
        table("printed", &headings, rows)
    )
}

/// The row of a target; `anchor` makes it the place to which its identifier leads.
pub(super) fn target_row(target: &Target, anchor: bool, errata: &[Erratum]) -> Vec<String> {
    let [id, quantity, thesis, ours, difference, required, kind, _, note] = target.cells();
    let (class, verdict) = match (target.passes(), target.is_required()) {
        (false, _) => ("missed", "missed"),
        (true, true) => ("met", "met"),
        (true, false) => ("shown", "shown"),
    };
    let about = errata.iter().filter(|erratum| erratum.targets.contains(&id));
    let about: Vec<String> = about.map(|erratum| reference(&erratum.id)).collect();
    let place = if anchor { format!(" id=\"{}\"", escaped(&id)) } else { String::new() };
    let note = if note.is_empty() { String::new() } else { format!("<div class=\"note\">{}</div>", escaped(&note)) };
    vec![
        format!("<th scope=\"row\"{place}>{}</th>", escaped(&id)),
        cell(&format!("{}{note}", escaped(&quantity))),
        text_cell(&thesis),
        text_cell(&ours),
        text_cell(&difference),
        text_cell(&required),
        cell(&escaped(&kind)),
        format!("<td class=\"{class}\">{verdict}</td>"),
        cell(&about.join(", ")),
    ]
}

/// A statement, its evidence, and the errata it concerns; those in `shown` already stand above and are only named.
pub(super) fn finding<'a>(finding: &'a Finding, errata: &[Erratum], shown: &mut BTreeSet<&'a str>) -> String {
    let (new, old): (Vec<&str>, Vec<&str>) = finding.errata.iter().partition(|&&id| shown.insert(id));
    let new = errata.iter().filter(|erratum| new.contains(&erratum.id.as_str())).map(short_erratum);
    let old: Vec<String> = old.into_iter().map(reference).collect();
    let old = if old.is_empty() { String::new() } else { format!("<p class=\"erratum\">{}</p>\n", old.join(", ")) };
    format!(
        "<div class=\"finding\"><p class=\"statement\">{}</p>\n<p>{}</p>\n{}{old}</div>\n",
        escaped(&finding.statement),
        escaped(&finding.evidence),
        new.collect::<Vec<_>>().concat()
    )
}

/// An erratum in a few words, beside what it concerns.
pub(super) fn short_erratum(erratum: &Erratum) -> String {
    format!(
        "<p class=\"erratum\">{} <b>Printed:</b> {} <b>Right:</b> {}</p>\n",
        reference(&erratum.id),
        marked(&sentence(&erratum.printed)),
        marked(&sentence(&erratum.right))
    )
}

/// An erratum with its evidence and all that shows it; `known` are the targets of the page.
pub(super) fn whole_erratum(erratum: &Erratum, known: impl Fn(&str) -> bool) -> String {
    let targets = erratum.targets.iter().map(|id| if known(id) { reference(id) } else { escaped(id) });
    let tests = erratum.tests.iter().map(|test| format!("<code>{}</code>", escaped(test)));
    let shown: Vec<String> = targets.chain(tests).collect();
    format!(
        "<section class=\"whole\" id=\"{id}\"><h3>{id}. {}</h3>\n<dl><dt>Printed</dt><dd>{}</dd><dt>Right</dt><dd>{}</dd>\
         <dt>Evidence</dt><dd>{}</dd><dt>Shown by</dt><dd>{}</dd></dl></section>\n",
        marked(&erratum.title),
        marked(&erratum.printed),
        marked(&erratum.right),
        marked(&erratum.evidence),
        shown.join(", "),
        id = escaped(&erratum.id),
    )
}

/// A picture with its caption; `id` must be unique within the page.
pub(super) fn figure(drawing: &Drawing, id: &str) -> String {
    picture(&drawing.svg, &drawing.caption, id)
}

/// A link to a target or an erratum.
pub(super) fn reference(id: &str) -> String {
    let id = escaped(id);
    format!("<a href=\"#{id}\">{id}</a>")
}

/// With a full stop, if it does not end with one.
fn sentence(text: &str) -> String {
    if text.ends_with('.') { text.to_owned() } else { format!("{text}.") }
}
