//! The posterior on the page of a record: intervals of three kinds, the corner plot, and predictive checks.

use std::error::Error;

use fmm_fit::posterior::Marginal;
use fmm_identify::posterior::{IdentificationPosterior, IntervalComparison};
use fmm_identify::{Experiment, Identification};
use fmm_model::Rounded;
use serde::Serialize;

use super::corner::corner;
use crate::page::{bullets, cell, escaped, figure, interval, optional_cell, row_heading, table, text_cell, words};

/// Coverage probability of intervals (1).
const LEVEL: f64 = 0.95;

/// Draws from the posterior of one record.
#[derive(Serialize)]
pub(crate) struct Posterior(IdentificationPosterior);

impl Posterior {
    /// Why there is none: there is.
    pub(crate) const REFUSAL: Option<&'static str> = None;

    /// Draws from the posterior of what `preferred` found in `decays`.
    pub(crate) fn of(preferred: &Identification, decays: &[Experiment]) -> Result<Self, Box<dyn Error>> {
        Ok(Self(preferred.posterior(decays, &preferred.sampler())?))
    }

    /// Text for a terminal.
    pub(crate) fn text(&self) -> String {
        self.0.to_string()
    }

    /// Part of the page below the heading.
    pub(crate) fn html(&self) -> String {
        let posterior = &self.0;
        let headings =
            ["quantity", "mean ± deviation", "unit", "posterior", "value ± k u", "profile", "agree", "effective draws"];
        let rows = posterior.intervals().iter().filter_map(|intervals| {
            let marginal = posterior.finding(intervals.name())?;
            Some(row(marginal, intervals))
        });
        let intervals = table("posterior", &headings, rows);
        let drawn: Vec<&Marginal> = posterior
            .intervals()
            .iter()
            .filter(|intervals| posterior.posterior().marginal(intervals.name()).is_some())
            .filter_map(|intervals| posterior.finding(intervals.name()))
            .collect();
        let plot = if drawn.is_empty() {
            String::new()
        } else {
            figure(
                &corner(&drawn),
                "The posterior of what the records share: the density of each quantity, and each pair of them, darker \
                 where it is more probable.",
                "corner",
            )
        };
        let warnings = bullets(posterior.warnings().iter().cloned());
        format!(
            "<p>By {} draws of {} chains: {}. All intervals hold 95 %.</p>\n{warnings}{intervals}{plot}{}",
            posterior.posterior().len(),
            posterior.posterior().chains(),
            escaped(&posterior.verdict()),
            checks(posterior)
        )
    }
}

fn row(marginal: &Marginal, intervals: &IntervalComparison) -> Vec<String> {
    let rounded = Rounded::new(marginal.mean(), Some(marginal.standard_deviation()));
    let both = |(low, high): (f64, f64)| rounded.interval(low, high);
    let profile = intervals.profile().map(|ends| interval(&rounded, ends, "open"));
    let effective = marginal.bulk_effective_size().min(marginal.tail_effective_size());
    vec![
        row_heading(&words(intervals.name())),
        text_cell(&rounded.to_string()),
        text_cell(marginal.parameter().unit()),
        optional_cell(marginal.interval(LEVEL).map(both)),
        optional_cell(intervals.wald().map(both)),
        optional_cell(profile),
        cell(if intervals.agrees() { "yes" } else { "no" }),
        text_cell(&format!("{effective:.0}")),
    ]
}

fn checks(posterior: &IdentificationPosterior) -> String {
    if posterior.checks().is_empty() {
        return String::new();
    }
    let rows = posterior.checks().iter().map(|check| {
        let median = check.median().map(|median| Rounded::new(median, None).to_string());
        vec![
            row_heading(check.feature()),
            text_cell(&Rounded::new(check.measured(), None).to_string()),
            optional_cell(median),
            text_cell(check.unit()),
            text_cell(&format!("{:.3}", check.p_value())),
        ]
    });
    let headings = ["feature", "measured", "median of records from the posterior", "unit", "p"];
    format!(
        "<p>Records made by the posterior, beside the measured one; p near 0 or 1 says that the law cannot make such a \
         record.</p>\n{}",
        table("checks", &headings, rows)
    )
}
