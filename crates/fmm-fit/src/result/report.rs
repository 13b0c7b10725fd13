//! The report of a fit, on one screen.

use std::fmt;

use fmm_model::Rounded;

use crate::result::estimate::{Estimate, EstimateStatus};
use crate::result::fit::Fit;
use crate::result::null_direction::enumerate;
use crate::solver::outcome::{NonFinite, Outcome};

/// Correlations weaker than this are not worth a line.
const NOTABLE_CORRELATION: f64 = 0.1;

impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let derivatives = if self.has_exact_jacobian() { "exact Jacobian" } else { "differences" };
        writeln!(f, "[[fit]] bounded Levenberg–Marquardt, {derivatives}")?;
        writeln!(f, "  {}", self.outcome())?;
        writeln!(
            f,
            "  {} iterations, {} evaluations of the residuals, {} of the Jacobian",
            self.iterations(),
            self.residual_evaluations(),
            self.jacobian_evaluations()
        )?;
        let (points, freedom) = (self.residuals().len(), self.degrees_of_freedom());
        writeln!(
            f,
            "  {points} residuals, {} parameters of which {} free, rank {}, {freedom} degrees of freedom",
            self.estimates().len(),
            self.free_count(),
            self.rank()
        )?;
        write!(f, "  sum of squares {:.6e}", self.sum_of_squares())?;
        match self.residual_standard_deviation() {
            Some(deviation) => writeln!(f, ", standard deviation of a residual {deviation:.6e}")?,
            None => writeln!(f)?,
        }
        self.write_estimates(f)?;
        self.write_correlations(f)?;
        self.write_warnings(f)
    }
}

impl Fit {
    fn write_estimates(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[[estimates]]")?;
        let width = self.estimates().iter().map(|estimate| estimate.name().chars().count()).max().unwrap_or(0);
        for estimate in self.estimates() {
            let unit = match estimate.parameter().unit() {
                "1" => String::new(),
                unit => format!(" {unit}"),
            };
            write!(f, "  {:<width$} = ", estimate.name())?;
            match estimate.standard_uncertainty() {
                Some(uncertainty) => {
                    write!(f, "{}{unit}", Rounded::new(estimate.value(), Some(uncertainty)))?;
                    if estimate.value() != 0.0 {
                        write!(f, " ({:.2} %)", 100.0 * uncertainty / estimate.value().abs())?;
                    }
                }
                None => write!(f, "{}{unit}", Rounded::new(estimate.value(), None))?,
            }
            write!(f, " (start {}", Rounded::new(estimate.start(), None))?;
            writeln!(
                f,
                "{})",
                match estimate.status() {
                    EstimateStatus::Determined => "",
                    EstimateStatus::Undetermined => ", not determined",
                    EstimateStatus::AtLowerBound => ", at its lower bound",
                    EstimateStatus::AtUpperBound => ", at its upper bound",
                    EstimateStatus::Fixed => ", fixed",
                }
            )?;
        }
        Ok(())
    }

    fn write_correlations(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.estimates().len();
        let mut pairs: Vec<(f64, usize, usize)> = (0..count)
            .flat_map(|i| (i + 1..count).map(move |j| (i, j)))
            .filter_map(|(i, j)| self.correlation(i, j).map(|correlation| (correlation, i, j)))
            .filter(|(correlation, ..)| correlation.abs() >= NOTABLE_CORRELATION)
            .collect();
        if pairs.is_empty() {
            return Ok(());
        }
        pairs.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        writeln!(f, "[[correlations]] (below {NOTABLE_CORRELATION} in magnitude not shown)")?;
        for (correlation, i, j) in pairs {
            writeln!(f, "  {}, {}: {correlation:+.4}", self.estimates()[i].name(), self.estimates()[j].name())?;
        }
        Ok(())
    }

    fn write_warnings(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut warnings = Vec::new();
        if !self.outcome().is_success() {
            warnings.push(format!("the values are the best found, not those of a minimum: {}", self.outcome()));
        }
        if let Some(reason) = self.non_finite()
            && (self.outcome() == Outcome::NonFinite || matches!(reason, NonFinite::Model(_)))
        {
            warnings.push(format!("some trial points had no finite value; at the last of them {reason}"));
        }
        warnings.extend(self.jacobian_mismatches().iter().map(ToString::to_string));
        warnings.extend(self.null_directions().iter().map(ToString::to_string));
        let at_bound = self.estimates().iter().filter(|estimate| estimate.status().is_at_bound());
        let at_bound: Vec<&str> = at_bound.map(Estimate::name).collect();
        if !at_bound.is_empty() {
            let (verb, theirs) = if at_bound.len() == 1 { ("lies", "it has") } else { ("lie", "they have") };
            let names = enumerate(&at_bound);
            warnings.push(format!(
                "{names} {verb} at a bound: {theirs} no standard uncertainty, and those of the others hold at the bound"
            ));
        }
        if !warnings.is_empty() {
            writeln!(f, "[[warnings]]")?;
        }
        warnings.iter().try_for_each(|warning| writeln!(f, "  {warning}"))
    }
}
