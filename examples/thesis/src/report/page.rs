//! The page: what it says first, the chapters, the errata, and how it was made.

use std::collections::BTreeSet;

use fmm_cli::page::{cell, escaped, page as whole_page, table, text_cell};

use super::errata::Erratum;
use super::html::{figure, finding, printed_table, reference, short_erratum, target_row, whole_erratum};
use super::versions::versions;
use super::{Outcome, Report};
use crate::{Chapter, Kind, Target};

const TITLE: &str = "Friction measurement during free vibration: the thesis and ours";

/// The kinds of numbers and what each is worth.
const KINDS: [(Kind, &str); 4] = [
    (Kind::Computed, "computed from the thesis' own inputs"),
    (
        Kind::Inferred,
        "computed from inputs that the thesis does not print and that were inferred from it: a check of consistency only",
    ),
    (Kind::Regression, "regression on the thesis' printed tables"),
    (Kind::Simulated, "simulated with a known truth and analysed as the thesis does"),
];

/// The whole page.
pub(super) fn page(report: &Report, errata: &[Erratum]) -> String {
    let known: BTreeSet<&str> = report.targets().map(Target::id).collect();
    let mut anchored = BTreeSet::new();
    let chapters: String = report.outcomes.iter().map(|outcome| chapter(outcome, errata, &mut anchored)).collect();
    let all: String = errata.iter().map(|erratum| whole_erratum(erratum, |id| known.contains(id))).collect();
    let body = format!(
        "<h1>{}</h1>\n{}{chapters}<section id=\"errata\"><h2>Errata</h2>\n{all}</section>\n{}",
        escaped(TITLE),
        head(report),
        making(report)
    );
    whole_page(TITLE, &body)
}

/// Verdict, counts, how to read it, and the way to the chapters.
fn head(report: &Report) -> String {
    let required: Vec<&Target> = report.targets().filter(|target| target.is_required()).collect();
    let missed: Vec<String> =
        required.iter().filter(|target| !target.passes()).map(|target| reference(target.id())).collect();
    let failed: Vec<&str> =
        report.outcomes.iter().filter(|outcome| outcome.result.is_err()).map(|outcome| outcome.name).collect();
    let class = if report.passes() { "met" } else { "missed" };
    let verdict = format!("{} of {} numbers meet their criterion.", required.len() - missed.len(), required.len());
    let but = |what: &str, names: &str| if names.is_empty() { String::new() } else { format!(" {what}: {names}.") };
    let verdict = verdict + &but("Missed", &missed.join(", ")) + &but("Not computed", &escaped(&failed.join(", ")));
    let quick = if report.quick {
        "<p><b>A quick run: fewer repetitions, and wider criteria where they matter.</b></p>\n"
    } else {
        ""
    };
    format!(
        "<p class=\"verdict {class}\">{verdict}</p>\n{quick}\
         <p>C. A. J. Kossack's master's thesis measures friction by the free vibration of a machine on leaf springs. Here is \
         each of its tables, quoted numbers and computable figures beside what this repository finds, and each place where \
         the thesis is wrong. <b>No raw data of the thesis are published.</b> A curve that is called a simulated record was \
         computed with a truth that is stated, and what is found from it is compared with that truth. Figures are grey for \
         records, red for fits and formulas, dark for what is left over.</p>\n{}{}",
        kinds(report),
        contents(report)
    )
}

/// How many numbers of each kind meet their criterion.
fn kinds(report: &Report) -> String {
    let rows = KINDS.map(|(kind, meaning)| {
        let of_kind: Vec<&Target> = report.targets().filter(|target| target.kind() == kind).collect();
        let count =
            |wanted: &dyn Fn(&Target) -> bool| of_kind.iter().filter(|target| wanted(target)).count().to_string();
        vec![
            format!("<th scope=\"row\">{kind}</th>"),
            text_cell(meaning),
            text_cell(&count(&|target| target.is_required() && target.passes())),
            text_cell(&count(&|target| !target.passes())),
            text_cell(&count(&|target| !target.is_required() && target.passes())),
        ]
    });
    table("summary", &["kind", "meaning", "met", "missed", "shown only"], rows)
}

/// The chapters with their verdicts.
fn contents(report: &Report) -> String {
    let rows = report.outcomes.iter().map(|outcome| {
        let title = outcome.result.as_ref().map_or(outcome.name, |chapter| chapter.title.as_str());
        let missed = outcome.targets().iter().filter(|target| !target.passes()).count();
        let (class, verdict) = match missed {
            _ if outcome.result.is_err() => ("missed", "not computed".to_owned()),
            0 => ("met", "all met".to_owned()),
            _ => ("missed", format!("{missed} missed")),
        };
        vec![
            cell(&format!("<a href=\"#{}\">{}</a>", escaped(outcome.name), escaped(title))),
            text_cell(&outcome.targets().len().to_string()),
            format!("<td class=\"{class}\">{verdict}</td>"),
            text_cell(&format!("{:.1}", outcome.seconds)),
        ]
    });
    format!(
        "<nav>{}<p><a href=\"#errata\">Errata</a> · <a href=\"#making\">How this was made</a></p></nav>\n",
        table("summary", &["chapter", "numbers", "verdict", "time / s"], rows)
    )
}

/// A chapter, or why there is none. The first row of each identifier that is not yet in `anchored` becomes its anchor.
fn chapter<'a>(outcome: &'a Outcome, errata: &[Erratum], anchored: &mut BTreeSet<&'a str>) -> String {
    let name = escaped(outcome.name);
    match &outcome.result {
        Err(reason) => format!(
            "<section id=\"{name}\"><h2>{name}</h2>\n<p class=\"verdict missed\">Not computed: {}</p></section>\n",
            escaped(reason)
        ),
        Ok(chapter) => {
            let figures = chapter.drawings.iter().enumerate();
            let figures: String = figures.map(|(i, drawing)| figure(drawing, &format!("{name}-{}", i + 1))).collect();
            let mut shown = BTreeSet::new();
            let findings: String = chapter.findings.iter().map(|found| finding(found, errata, &mut shown)).collect();
            let tables: String = chapter.tables.iter().map(printed_table).collect();
            format!(
                "<section id=\"{name}\"><h2>{}</h2>\n{findings}{}{tables}{figures}</section>\n",
                escaped(&chapter.title),
                targets(chapter, errata, anchored)
            )
        }
    }
}

/// The numbers of a chapter, and the errata about them of which no finding speaks.
fn targets<'a>(chapter: &'a Chapter, errata: &[Erratum], anchored: &mut BTreeSet<&'a str>) -> String {
    let rows: Vec<_> =
        chapter.targets.iter().map(|target| target_row(target, anchored.insert(target.id()), errata)).collect();
    let headings = ["id", "quantity", "thesis", "ours", "difference", "required", "kind", "verdict", "errata"];
    let other: String = errata
        .iter()
        .filter(|erratum| chapter.targets.iter().any(|target| erratum.targets.iter().any(|id| id == target.id())))
        .filter(|erratum| !chapter.findings.iter().any(|finding| finding.errata.contains(&erratum.id.as_str())))
        .map(short_erratum)
        .collect();
    let other = if other.is_empty() { other } else { format!("<div class=\"errata\">{other}</div>\n") };
    table("targets", &headings, rows) + &other
}

/// Seeds, versions, times.
fn making(report: &Report) -> String {
    let versions: Vec<String> =
        versions().into_iter().map(|(name, version)| format!("{} {}", escaped(name), escaped(version))).collect();
    let command = format!(
        "cargo run --release --example thesis -- --seed {}{}",
        report.seed,
        if report.quick { " --quick" } else { "" }
    );
    format!(
        "<section id=\"making\"><h2>How this was made</h2>\n<dl><dt>Command</dt><dd><code>{command}</code></dd>\
         <dt>Seed of all random numbers</dt><dd>{}</dd><dt>Computing time</dt><dd>{:.1} s for all chapters, with {} threads \
         on {} {}</dd><dt>Versions</dt><dd>{}</dd></dl></section>\n",
        report.seed,
        report.seconds(),
        std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
        std::env::consts::OS,
        std::env::consts::ARCH,
        versions.join(", ")
    )
}
