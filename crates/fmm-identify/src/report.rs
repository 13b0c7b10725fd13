//! The reports, on one screen each.

use std::fmt;

use fmm_fit::EstimateStatus;

use crate::finding::Origin;
use crate::{Comparison, Finding, Identification, Warning};

/// Width of the column that holds the names of parameters.
pub(crate) fn name_width(findings: &[Finding]) -> usize {
    findings.iter().map(|finding| finding.parameter().name().chars().count()).max().unwrap_or(0)
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.quantity())?;
        match self.origin() {
            Origin::Derived => write!(f, "  (with what is known of the machine)"),
            Origin::Fitted(EstimateStatus::Undetermined) => write!(f, "  (not determined)"),
            Origin::Fitted(EstimateStatus::Fixed) => write!(f, "  (held)"),
            Origin::Fitted(status) if status.is_at_bound() => write!(f, "  (at its bound)"),
            Origin::Fitted(_) => Ok(()),
        }
    }
}

impl Identification {
    fn write_findings(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = name_width(self.findings());
        for finding in self.findings() {
            writeln!(f, "  {:<width$} = {finding}", finding.parameter().name())?;
        }
        for (record, motion) in self.motions().iter().enumerate() {
            let which = if self.motions().len() > 1 { format!("record {}: ", record + 1) } else { String::new() };
            let ends = match motion.stop_time() {
                Some(time) => format!("at rest from {time:.4} s"),
                None => "still moving at the end of the record".to_owned(),
            };
            writeln!(f, "  {which}{} half swings, {ends}", motion.half_swings())?;
        }
        Ok(())
    }
}

pub(crate) fn write_warnings(f: &mut fmt::Formatter<'_>, warnings: &[Warning]) -> fmt::Result {
    if !warnings.is_empty() {
        writeln!(f, "\nWarnings")?;
    }
    warnings.iter().try_for_each(|warning| writeln!(f, "  - {warning}"))
}

impl fmt::Display for Identification {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fit = self.fit();
        writeln!(f, "Ring-down by the law {}", self.law())?;
        writeln!(
            f,
            "  {}; {} samples, rank {} of {}, rms residual {:.4e}",
            fit.outcome(),
            fit.residuals().len(),
            fit.rank(),
            fit.free_count(),
            self.rms_residual()
        )?;
        self.write_findings(f)?;
        write_warnings(f, self.warnings())
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (record, summary) in self.records().iter().enumerate() {
            let number = if self.records().len() > 1 { format!(" {}", record + 1) } else { String::new() };
            writeln!(f, "Record{number}: {summary}")?;
        }
        writeln!(f, "\nLaws")?;
        let width = self.identifications().iter().map(|law| law.law().len()).max().unwrap_or(0);
        let best = self.scores().iter().copied().fold(f64::INFINITY, f64::min);
        writeln!(f, "  {:<width$}  rms residual  rank  half swings    rest from   ΔAICc (independent residuals)", "")?;
        for (law, score) in self.identifications().iter().zip(self.scores()) {
            let stop = law.motions().iter().find_map(crate::FittedMotion::stop_time);
            let stop = stop.map_or_else(|| "-".to_owned(), |time| format!("{time:.4} s"));
            let half_swings: usize = law.motions().iter().map(crate::FittedMotion::half_swings).sum();
            writeln!(
                f,
                "  {:<width$}  {:>12.4e}  {:>4}  {half_swings:>11}  {stop:>11}  {:>6.1}",
                law.law(),
                law.rms_residual(),
                law.fit().rank(),
                score - best,
            )?;
        }
        for nested in self.tests() {
            let verdict = if nested.p_value < 0.05 { "too simple" } else { "enough" };
            let probability = if nested.p_value < 1e-3 { "< 0.001".to_owned() } else { format!("= {:.3}", nested.p_value) };
            writeln!(f, "  {} beside {}: {verdict} (p {probability})", nested.restricted, nested.full)?;
        }
        for sign in self.signs() {
            writeln!(f, "  {}: {:.2} ± {:.2}", sign.addition, sign.size, sign.uncertainty)?;
        }
        let preferred = self.preferred();
        let confidence = if self.is_decided() { "" } else { ", though the data do not decide" };
        writeln!(f, "\nPreferred: {}{confidence}", preferred.law())?;
        preferred.write_findings(f)?;
        write_warnings(f, self.warnings())
    }
}
