//! The reports, on one screen each.

#[cfg(feature = "serde")]
mod serialised;

use std::fmt;

use fmm_model::Rounded;
use fmm_uq::Contribution;

use crate::finding::{Finding, name_width};
use crate::identification::Identification;
use crate::judgement::rules::EXCLUDED;
use crate::judgement::score_test::Extension;
use crate::judgement::{Comparison, ScoreTest};
use crate::machine::term::{CHANGE_PER_HALF_CYCLE, RISE_OVER_POSITION};
use crate::warning::{Warning, write_warnings};

impl Identification {
    fn write_findings(&self, f: &mut fmt::Formatter<'_>, rests: &[Option<f64>]) -> fmt::Result {
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
            // A run-down has no swings.
            let swings =
                if self.swings() { format!("has {} half swings, ", motion.half_swings()) } else { "is ".to_owned() };
            let seen = rests.get(record).copied().flatten();
            let ends =
                seen.map_or(ends.clone(), |time| format!("{ends}; within its noise the record rests from {time:.3} s"));
            writeln!(f, "  {which}the fitted motion {swings}{ends}")?;
        }
        Ok(())
    }
}

/// The sources of an uncertainty that has several, the largest first.
fn write_sources(f: &mut fmt::Formatter<'_>, finding: &Finding) -> fmt::Result {
    let Some(budget) = finding.budget() else { return Ok(()) };
    let mut parts: Vec<Contribution<'_>> = budget.contributions().collect();
    if parts.len() < 2 {
        return Ok(());
    }
    parts.sort_by(|a, b| b.share.total_cmp(&a.share));
    let text = |part: &Contribution<'_>| match (100.0 * part.share).round() {
        share if share < 1.0 => format!("{} below 1 %", part.input.name()),
        share => format!("{} {share} %", part.input.name()),
    };
    let parts: Vec<String> = parts.iter().map(text).collect();
    writeln!(f, "  u² of {}: {}", finding.parameter().name(), parts.join(", "))
}

impl fmt::Display for Identification {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fit = self.fit();
        let title = if self.force_unit().is_some() { "Force along a motion by" } else { "Fit by the law" };
        writeln!(f, "{title} {}", self.law())?;
        let unit = self.force_unit().map_or_else(String::new, |unit| format!(" {unit}"));
        let share = self.share_of_force().map(|share| format!(", {:.1} % of the force", 100.0 * share));
        writeln!(
            f,
            "  {}; {} samples, rank {} of {}, rms residual {:.4e}{unit}{}",
            fit.outcome(),
            self.samples(),
            fit.rank(),
            fit.free_count(),
            self.rms_residual(),
            share.unwrap_or_default()
        )?;
        self.write_findings(f, &[])?;
        write_warnings(f, self.warnings())
    }
}

impl Comparison {
    /// Result, its certainty, and the next step: two or three sentences.
    pub fn headline(&self) -> String {
        let preferred = self.preferred();
        let main = preferred.main_findings();
        let found: Vec<String> = main
            .iter()
            .map(|finding| {
                let interval = finding.interval_text().map_or(String::new(), |text| format!(", 95 % within {text}"));
                let reservation = finding.reservation().map_or(String::new(), |text| format!(" ({text})"));
                format!("{} = {}{interval}{reservation}", finding.parameter().name(), finding.quantity())
            })
            .collect();
        let mut found = found;
        for name in [CHANGE_PER_HALF_CYCLE, RISE_OVER_POSITION] {
            found.extend(preferred.finding(name).map(|change| format!("{name} = {}", change.quantity())));
        }
        found.extend(self.friction_change().filter(|_| !main.is_empty()).map(|change| change.to_string()));
        let unseen = [self.over_position, self.unseen_damping];
        found.extend(unseen.into_iter().flatten().filter(|_| !main.is_empty()).map(|unseen| unseen.to_string()));
        let found =
            if found.is_empty() { "no friction or damping that it determines".to_owned() } else { found.join("; ") };
        let others: Vec<&str> =
            self.not_excluded().map(Identification::law).filter(|law| *law != preferred.law()).collect();
        let is_explained = !preferred.structure.is_structured();
        let is_alone = self.identifications().len() == 1;
        let sure = match (self.is_decided(), others.is_empty()) {
            _ if !is_explained => "of the laws that were tried none explains the record to its noise".to_owned(),
            (true, true) if is_alone => "no other law was tried".to_owned(),
            (true, true) => {
                let count = self.identifications().len() - 1 + self.excluded().len();
                let others =
                    if count == 1 { "other law that was".to_owned() } else { format!("{count} other laws that were") };
                format!("the record excludes the {others} tried")
            }
            (true, false) => format!("the record neither asks for more nor excludes it ({})", others.join(", ")),
            (false, true) if self.warnings().iter().any(|warning| matches!(warning, Warning::OtherLaw { .. })) => {
                "a law that was tried could not be fitted to the end".to_owned()
            }
            (false, true) if !preferred.fit().outcome().is_success() => "its fit did not end".to_owned(),
            (false, true) => "the record does not decide, for what its warnings say".to_owned(),
            (false, false) => format!("the record does not decide: {} may be true as well", others.join(", ")),
        };
        let surer = if preferred.force_unit().is_some() {
            match (is_explained, is_alone, self.is_decided()) {
                (false, ..) => "a law or a term that was not tried may",
                (_, true, _) => "a comparison with other laws would show whether the record asks for this one",
                (.., true) => "more passes or less noise would make it surer",
                _ => "motions of other speeds and amplitudes, or less noise, would tell the laws apart",
            }
        } else if !is_explained {
            "a law that was not tried, a spring that is not linear or a second mode may"
        } else if is_alone {
            "a comparison with other laws would show whether the record asks for this one"
        } else if self.is_decided() {
            if preferred.swings() {
                "more half swings or less noise would make its values surer"
            } else {
                "more runs or less noise would make its values surer"
            }
        } else {
            "releases of other amplitudes fitted together, or less noise, would tell the laws apart"
        };
        let bound = self.friction_bound();
        let bound = bound.map_or_else(String::new, |bound| format!("; {bound}"));
        let is_odd =
            |warning: &&Warning| matches!(warning, Warning::Implausible { .. } | Warning::OtherQuantity { .. });
        let odd = self.warnings().iter().find(is_odd);
        let odd = odd.map_or_else(String::new, |odd| format!("; but {odd}"));
        format!("{}: {found}{bound}{odd}; {sure}; {surer}.", preferred.law())
    }
}

/// Upper bound of a friction that the records do not show.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrictionBound {
    /// The law with this friction beside the damping.
    pub(crate) law: String,
    pub(crate) name: String,
    pub(crate) unit: String,
    /// End of its 95 % interval.
    pub(crate) upper_95: f64,
}

impl fmt::Display for FrictionBound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { law, name, unit, upper_95 } = self;
        let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
        write!(
            f,
            "no dry friction is seen: {law} allows a {name} of {}{unit} at most (95 %)",
            Rounded::significant(*upper_95, 3)
        )
    }
}

impl Comparison {
    /// Upper bound of the dry friction where the preferred law has none: that of the best law with a level that the
    /// records do not exclude.
    pub(crate) fn friction_bound(&self) -> Option<FrictionBound> {
        if self.preferred().force_unit().is_some() || self.preferred().family().level().is_some() {
            return None;
        }
        let scored = self.identifications().iter().zip(self.scores()).zip(self.p_values());
        let left = scored.filter(|(_, p)| **p >= EXCLUDED).map(|(scored, _)| scored);
        let levelled = left.filter(|(found, _)| matches!(found.family().dry_name(), Some("coulomb")));
        let upper = |found: &Identification| {
            let sliding = *found.main_findings().first()?;
            Some((sliding.parameter().clone(), sliding.interval(0.95)?.1))
        };
        let bounded = levelled.filter_map(|(found, score)| Some((found, upper(found)?, *score)));
        let (found, (parameter, upper_95), _) = bounded.min_by(|a, b| a.2.total_cmp(&b.2))?;
        let (name, unit) = (parameter.name().to_owned(), parameter.unit().to_owned());
        Some(FrictionBound { law: found.law().to_owned(), name, unit, upper_95 })
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.headline())?;
        if !self.records().is_empty() {
            writeln!(f)?;
        }
        for (record, summary) in self.records().iter().enumerate() {
            let number = if self.records().len() > 1 { format!(" {}", record + 1) } else { String::new() };
            writeln!(f, "Record{number}: {summary}")?;
        }
        writeln!(f, "\nLaws")?;
        let width = self.identifications().iter().map(|law| law.law().len()).max().unwrap_or(0);
        let best = self.scores().iter().copied().fold(f64::INFINITY, f64::min);
        let is_of_force = self.preferred().force_unit().is_some();
        let motion = if is_of_force { "" } else { "  half swings    rest from" };
        writeln!(f, "  {:<width$}  rms residual  rank{motion}   misfit + 2 rank         p", "")?;
        let standings = self.scores().iter().copied().zip(self.p_values().iter().copied());
        for (law, (score, p)) in self.identifications().iter().zip(standings) {
            let stop = law.motions().iter().find_map(crate::identification::FittedMotion::stop_time);
            let stop = stop.map_or_else(|| "-".to_owned(), |time| format!("{time:.4} s"));
            let half_swings: usize = law.motions().iter().map(crate::identification::FittedMotion::half_swings).sum();
            let motion = if is_of_force { String::new() } else { format!("  {half_swings:>11}  {stop:>11}") };
            let p = if p < EXCLUDED { "excluded".to_owned() } else { format!("{p:.3}") };
            writeln!(
                f,
                "  {:<width$}  {:>12.4e}  {:>4}{motion}  {:>16.1}  {p:>8}",
                law.law(),
                law.rms_residual(),
                law.fit().rank(),
                score - best,
            )?;
        }
        if !self.excluded().is_empty() {
            let shown = "excluded without a fit by the friction over the speed that the record shows";
            writeln!(f, "  {shown}: {}", self.excluded().join("; "))?;
        }
        let significant: Vec<&ScoreTest> = self.score_tests().iter().filter(|test| test.is_significant()).collect();
        for test in &significant {
            writeln!(f, "  {test}")?;
        }
        let is_simple = matches!(self.preferred().family().dry_name(), None | Some("coulomb"));
        if significant.is_empty() && !self.score_tests().is_empty() && is_simple {
            // A law that has it does not look for it.
            let law = self.preferred().law();
            let tested = |extension: Extension| self.score_tests().iter().any(|test| test.extension == extension);
            let looked = [
                ("friction that changes with speed", true),
                ("presliding", tested(Extension::Presliding)),
                ("quadratic damping", tested(Extension::QuadraticDamping) && !law.contains("quadratic")),
                ("a softening spring", tested(Extension::SofteningSpring) && !law.contains("spring")),
            ];
            let looked: Vec<&str> =
                looked.iter().filter(|(_, is_listed)| *is_listed).map(|(words, _)| *words).collect();
            writeln!(f, "  looked for and not seen: {}", looked.join(", "))?;
        }
        let preferred = self.preferred();
        let confidence = if self.is_decided() { "" } else { ", though the record does not decide" };
        writeln!(f, "\nPreferred: {}{confidence}  (value ± standard uncertainty  [95 % interval])", preferred.law())?;
        let rests: Vec<Option<f64>> = self.records().iter().map(|record| record.rest_from).collect();
        preferred.write_findings(f, &rests)?;
        preferred.main_findings().into_iter().try_for_each(|finding| write_sources(f, finding))?;
        write_warnings(f, self.warnings())
    }
}
