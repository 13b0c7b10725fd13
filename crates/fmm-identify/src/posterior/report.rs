//! The report of a posterior beside the other intervals.

use std::fmt;

use fmm_model::Rounded;

use crate::posterior::intervals::LEVEL;
use crate::posterior::{IdentificationPosterior, IntervalComparison};

impl fmt::Display for IdentificationPosterior {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "posterior of {}: {} draws of {} chains", self.law, self.posterior.len(), self.posterior.chains())?;
        let marginals = || self.findings.iter().filter(|marginal| self.interval(marginal.parameter().name()).is_some());
        let width = marginals().map(|marginal| marginal.parameter().name().chars().count()).max().unwrap_or(0);
        for marginal in marginals() {
            let Some(compared) = self.interval(marginal.parameter().name()) else { continue };
            let rounded = Rounded::new(marginal.mean(), Some(marginal.standard_deviation()));
            let unit = match marginal.parameter().unit() {
                "1" => String::new(),
                unit => format!(" {unit}"),
            };
            writeln!(f, "  {:<width$} = {rounded}{unit}", compared.name())?;
            writeln!(f, "  {:<width$}   {}", "", compared.text())?;
        }
        writeln!(f, "{}", self.verdict())?;
        for check in &self.checks {
            let unit = if check.unit() == "1" { String::new() } else { format!(" {}", check.unit()) };
            let measured = Rounded::new(check.measured(), None);
            let median =
                check.median().map_or("none".to_owned(), |median| format!("{}{unit}", Rounded::new(median, None)));
            let (feature, p) = (check.feature(), check.p_value());
            writeln!(
                f,
                "  {feature} {measured}{unit}, of records from the posterior {median} in the middle, p = {p:.3}"
            )?;
        }
        for warning in self.warnings() {
            writeln!(f, "warning: {warning}")?;
        }
        Ok(())
    }
}

impl IdentificationPosterior {
    fn interval(&self, name: &str) -> Option<&IntervalComparison> {
        self.intervals.iter().find(|interval| interval.name() == name)
    }

    /// A sentence on whether the intervals agree, and which to take.
    pub fn verdict(&self) -> String {
        let apart: Vec<&str> =
            self.intervals.iter().filter(|interval| !interval.agrees()).map(IntervalComparison::name).collect();
        if apart.is_empty() {
            "the intervals by value ± k u, from the profile and from the posterior agree: value ± u is enough"
                .to_owned()
        } else {
            format!(
                "the intervals of {} differ by more than a tenth of their width: state those of the posterior there, \
                 and not value ± u",
                apart.join(", ")
            )
        }
    }

    /// All reasons to distrust the posterior or the model behind it, in words; empty if there are none.
    pub fn warnings(&self) -> Vec<String> {
        let of_sampler = self.posterior.warnings().into_iter().map(|warning| warning.to_string());
        of_sampler.chain(self.checks.iter().filter_map(super::PredictiveCheck::warning)).collect()
    }
}

impl IntervalComparison {
    /// The three intervals on one line.
    fn text(&self) -> String {
        let (low, high) = self.posterior();
        // Of a normal distribution the interval is four standard deviations wide.
        let rounded = Rounded::new(0.5 * (low + high), Some(0.25 * (high - low)));
        let both = |(low, high): (f64, f64)| rounded.interval(low, high);
        let wald = self.wald().map_or("none".to_owned(), both);
        let profile = match self.profile() {
            None => String::new(),
            Some((Some(low), Some(high))) => format!(", profile {}", both((low, high))),
            Some((Some(low), None)) => format!(", profile above {}", Rounded::new(low, None)),
            Some((None, Some(high))) => format!(", profile below {}", Rounded::new(high, None)),
            Some((None, None)) => ", profile open".to_owned(),
        };
        format!("{:.0} %: posterior {}, value ± k u {wald}{profile}", 100.0 * LEVEL, both((low, high)))
    }
}
