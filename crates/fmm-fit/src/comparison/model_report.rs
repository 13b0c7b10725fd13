//! The comparison of models as a table.

use std::fmt;

use crate::comparison::contender::Criterion;
use crate::comparison::model_table::{Doubt, ModelTable, Verdict};

impl fmt::Display for ModelTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = self.rows();
        let name = |i: usize| rows[i].name.as_str();
        let (count, all) = (rows.len(), self.residuals);
        writeln!(f, "[[models]] {count} models of {all} residuals, which count as {:.1}", self.counted())?;
        let criterion = match self.criterion {
            Criterion::CorrectedAkaike => "Akaike's corrected criterion",
            Criterion::Bayesian => "the Bayesian criterion",
        };
        writeln!(f, "  ranked by {criterion}")?;
        let width = rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0).max("model".len());
        writeln!(
            f,
            "  {:<width$} {:>10} {:>12} {:>10} {:>10} {:>10} {:>8}",
            "model", "parameters", "rms", "AICc", "BIC", "difference", "weight"
        )?;
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| rows[*a].difference.total_cmp(&rows[*b].difference));
        for row in order.into_iter().map(|i| &rows[i]) {
            writeln!(
                f,
                "  {:<width$} {:>10} {:>12.5e} {:>10.2} {:>10.2} {:>10.2} {:>8.4}",
                row.name, row.parameters, row.rms, row.corrected_akaike, row.bayesian, row.difference, row.weight
            )?;
        }
        for test in self.tests() {
            let (added, freedom) = test.degrees_of_freedom;
            let (restricted, full) = (name(test.restricted), name(test.full));
            writeln!(
                f,
                "  {full} against its special case {restricted}: F({added}, {freedom:.1}) = {:.3}, p = {:.2e}",
                test.f, test.p_value
            )?;
        }
        match self.verdict() {
            Verdict::Decided { winner, lead: Some(lead) } => {
                writeln!(f, "  the data decide for {} by {lead:.1}", name(*winner))
            }
            Verdict::Decided { winner, lead: None } => writeln!(f, "  {} has no rival", name(*winner)),
            Verdict::Undecided { preferred, doubts } => {
                writeln!(f, "  the data do not decide; {} is preferred as the simplest, but", name(*preferred))?;
                doubts.iter().try_for_each(|doubt| self.write_doubt(f, *doubt))
            }
        }
    }
}

impl ModelTable {
    fn write_doubt(&self, f: &mut fmt::Formatter<'_>, doubt: Doubt) -> fmt::Result {
        let name = |i: usize| self.rows()[i].name.as_str();
        match doubt {
            Doubt::TooClose { rival, difference } if difference < 0.0 => {
                writeln!(f, "  - {} scores better by {:.1} with more parameters", name(rival), -difference)
            }
            Doubt::TooClose { rival, difference } => {
                writeln!(f, "  - {} scores worse by only {difference:.1}", name(rival))
            }
            Doubt::Unfinished { contender } => {
                writeln!(f, "  - the fit of {} did not end at a minimum", name(contender))
            }
            Doubt::MissedMinimum { contender, special } => {
                let (contender, special) = (name(contender), name(special));
                writeln!(
                    f,
                    "  - the fit of {contender} missed its lowest minimum, as its special case {special} fits better"
                )
            }
            Doubt::NotRejected { special, p_value } => {
                writeln!(f, "  - its special case {} is not rejected (p = {p_value:.3})", name(special))
            }
        }
    }
}
