//! The report of a posterior, on one screen.

use std::fmt;

use fmm_model::Rounded;

use crate::posterior::result::Posterior;

impl fmt::Display for Posterior {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "[[posterior]] no-U-turn sampler, {} chains of {} draws",
            self.chains(),
            self.len() / self.chains()
        )?;
        writeln!(
            f,
            "  {} evaluations, acceptance {:.2}, {} divergences",
            self.evaluations(),
            self.acceptance(),
            self.divergences()
        )?;
        if let Some(disagreements) = self.disagreements() {
            let verdict = if disagreements.is_empty() { "agree" } else { "do not agree" };
            writeln!(f, "  random walks without gradients {verdict}")?;
        }
        writeln!(
            f,
            "[[marginals]] mean ± standard deviation, 95 % interval, effective draws in the middle and in the tails"
        )?;
        let width =
            self.marginals().iter().map(|marginal| marginal.parameter().name().chars().count()).max().unwrap_or(0);
        for marginal in self.marginals() {
            let rounded = Rounded::new(marginal.mean(), Some(marginal.standard_deviation()));
            let unit = match marginal.parameter().unit() {
                "1" => String::new(),
                unit => format!(" {unit}"),
            };
            let interval = marginal.interval(0.95).map_or(String::new(), |(low, high)| rounded.interval(low, high));
            writeln!(
                f,
                "  {:<width$} = {rounded}{unit}, {interval}, {:.0} and {:.0}, R-hat {:.3}",
                marginal.parameter().name(),
                marginal.bulk_effective_size(),
                marginal.tail_effective_size(),
                marginal.r_hat()
            )?;
        }
        let warnings = self.warnings();
        if !warnings.is_empty() {
            writeln!(f, "[[warnings]]")?;
        }
        for warning in warnings {
            writeln!(f, "  {warning}")?;
        }
        Ok(())
    }
}
