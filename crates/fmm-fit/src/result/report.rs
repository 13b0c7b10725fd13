//! The report of a fit, on one screen.

use std::fmt;

use fmm_model::Rounded;

use crate::result::estimate::EstimateStatus;
use crate::result::fit::Fit;
use crate::result::null_direction::enumerate;
use crate::solver::outcome::Outcome;

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
        let at_bound: Vec<&str> = self
            .estimates()
            .iter()
            .filter(|estimate| estimate.status().is_at_bound())
            .map(crate::result::estimate::Estimate::name)
            .collect();
        let is_plain = at_bound.is_empty() && self.null_directions().is_empty() && self.model_error().is_none();
        let is_quiet = is_plain && self.jacobian_mismatches().is_empty();
        if is_quiet && self.outcome().is_success() {
            return Ok(());
        }
        writeln!(f, "[[warnings]]")?;
        if !self.outcome().is_success() {
            writeln!(f, "  the values are the best found, not those of a minimum: {}", self.outcome())?;
        }
        if self.outcome() == Outcome::NonFinite
            && let Some(reason) = self.non_finite()
        {
            writeln!(f, "  what had no finite value beyond them: {reason}")?;
        }
        for mismatch in self.jacobian_mismatches() {
            writeln!(f, "  {mismatch}")?;
        }
        for direction in self.null_directions() {
            writeln!(f, "  {direction}")?;
        }
        if !at_bound.is_empty() {
            let (verb, theirs) = if at_bound.len() == 1 { ("lies", "it has") } else { ("lie", "they have") };
            writeln!(
                f,
                "  {} {verb} at a bound: {theirs} no standard uncertainty, and those of the others hold at the bound",
                enumerate(&at_bound)
            )?;
        }
        if let Some(error) = self.model_error() {
            writeln!(f, "  the model had no value at some trial points; the last time it said: {error}")?;
        }
        Ok(())
    }
}
