//! The budget of a report: where the uncertainty of each finding comes from.

use fmm_identify::{Finding, Identification};
use fmm_uq::{Budget, Contribution};

use crate::output::of_size;
use crate::page::{optional_cell, row_heading, table, text_cell, words};

/// A share below this is not worth a number (1).
const LITTLE: f64 = 5e-4;

/// Contribution of each source to the findings that all records share.
pub(super) fn budget(preferred: &Identification) -> String {
    let budgets: Vec<(&Finding, Option<Budget>)> = preferred
        .findings()
        .iter()
        .filter(|finding| !finding.is_of_record())
        .map(|finding| (finding, finding.budget()))
        .collect();
    let mut sources = Vec::new();
    for part in budgets.iter().filter_map(|(_, budget)| budget.as_ref()).flat_map(Budget::contributions) {
        if !sources.contains(&part.input.name()) {
            sources.push(part.input.name());
        }
    }
    if sources.is_empty() {
        return "<p>No finding has an uncertainty.</p>\n".to_owned();
    }
    let row = |(finding, budget): &(&Finding, Option<Budget>)| {
        let parameter = finding.parameter();
        let u = of_size(finding.uncertainty()?);
        let heads = [row_heading(&words(parameter.name())), text_cell(&u), text_cell(parameter.unit())];
        let parts = || budget.iter().flat_map(Budget::contributions);
        let part = |source: &&str| optional_cell(parts().find(|part| part.input.name() == *source).as_ref().map(text));
        Some(heads.into_iter().chain(sources.iter().map(part)).collect())
    };
    let headings: Vec<&str> = ["quantity", "u", "unit"].into_iter().chain(sources.iter().copied()).collect();
    format!(
        "<p>What each source alone makes of u, and its share of u². Residuals count with the degrees of freedom that \
         they have; what was given counts as known, so that ν of the whole follows by Welch and Satterthwaite (JCGM \
         100:2008, clauses 5.1 and G.4.1). What is the largest is what to make smaller first.</p>\n{}",
        table("budget", &headings, budgets.iter().filter_map(row))
    )
}

/// u and share of a contribution.
fn text(part: &Contribution<'_>) -> String {
    let share = 100.0 * part.share;
    let share = match part.share {
        little if little < LITTLE => "below 0.1 %".to_owned(),
        most if most > 0.995 && most < 1.0 - LITTLE => format!("{share:.1} %"),
        small if small < 0.01 => format!("{share:.1} %"),
        _ => format!("{share:.0} %"),
    };
    format!("{} ({share})", of_size(part.uncertainty))
}
