//! Decision on whether a result keeps its tolerance, after JCGM 106:2012.

use std::error::Error;
use std::fmt::Write;

use fmm_model::Rounded;
use fmm_uq::{Budget, ToleranceInterval};
use serde::{Deserialize, Serialize};

/// Tolerance of a result in a file, and the rule of its decision.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ToleranceEntry {
    lower: Option<f64>,
    upper: Option<f64>,
    guard_band: Option<f64>,
    risk: Option<f64>,
}

/// A tolerance and the rule of its decision.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerance {
    limits: ToleranceInterval,
    rule: Rule,
}

/// Demand on a measured value that is accepted.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Rule {
    /// Acceptance within the tolerance.
    Simple,
    /// Guard band of this many U within the tolerance.
    GuardBand(f64),
    /// Acceptance at a specific risk no larger than this.
    Risk(f64),
}

/// Conformity of a result, its probability, and the decision that follows.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct Conformity {
    /// Limits of tolerance (unit of the result); none on a side without one.
    lower: Option<f64>,
    upper: Option<f64>,
    /// Probability that the quantity conforms, by derivatives; none without degrees of freedom.
    probability: Option<f64>,
    /// The same as a share of the trials.
    probability_by_trials: f64,
    /// "simple acceptance", "guard band" or "specific risk".
    rule: &'static str,
    /// Guard band over U, or the greatest risk (1).
    #[serde(skip_serializing_if = "Option::is_none")]
    parameter: Option<f64>,
    /// Limits of acceptance (unit of the result); none on a side without one.
    acceptance_lower: Option<f64>,
    acceptance_upper: Option<f64>,
    /// True if the estimate lies within the limits of acceptance.
    accepted: bool,
    /// Why no value would be accepted.
    #[serde(skip_serializing_if = "Option::is_none")]
    nothing_accepted: Option<String>,
}

fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

impl ToleranceEntry {
    pub(super) fn tolerance(self, name: &str) -> Result<Tolerance, String> {
        let Self { lower, upper, guard_band, risk } = self;
        if lower.is_none() && upper.is_none() {
            return Err(format!("the tolerance of {name} needs lower, upper or both"));
        }
        let limits = ToleranceInterval::new(lower.unwrap_or(f64::NEG_INFINITY), upper.unwrap_or(f64::INFINITY))
            .map_err(|error| format!("the result {name}: {error}"))?;
        let rule = match (guard_band, risk) {
            (None, None) => Rule::Simple,
            (Some(share), None) if share.is_finite() => Rule::GuardBand(share),
            (Some(share), None) => {
                return Err(format!("the guard_band of {name} is a number of U, such as 1, but is {share}"));
            }
            (None, Some(risk)) if risk > 0.0 && risk <= 0.5 => Rule::Risk(risk),
            (None, Some(risk)) => {
                return Err(format!("the risk of {name} must lie above 0 and be at most 0.5, but is {risk}"));
            }
            (Some(_), Some(_)) => {
                return Err(format!("the tolerance of {name} has both guard_band and risk; give one of them"));
            }
        };
        Ok(Tolerance { limits, rule })
    }
}

impl Tolerance {
    /// The decision on a result with this `budget` and these `trials`, U being that of this `level`.
    pub(super) fn decide(&self, budget: &Budget, trials: &[f64], level: f64) -> Result<Conformity, Box<dyn Error>> {
        let Self { limits, rule } = *self;
        let (y, u) = (budget.estimate(), budget.standard_uncertainty());
        let freedom = budget.effective_degrees_of_freedom();
        let risk = freedom.map(|freedom| limits.specific_risk(y, u, freedom)).transpose()?;
        let unknown = "without degrees of freedom of u there is no interval to take a guard band from";
        let accepted = match (rule, freedom) {
            (Rule::Simple, _) => Ok(limits),
            (Rule::GuardBand(share), _) => {
                budget.expanded(level).and_then(|expanded| limits.guarded(share * expanded.uncertainty))
            }
            (Rule::Risk(most), Some(freedom)) => limits.at_risk(u, freedom, most),
            (Rule::Risk(_), None) => return Err(format!("{}: {unknown}; take guard_band = 0", budget.name()).into()),
        };
        let (rule, parameter) = match rule {
            Rule::Simple => ("simple acceptance", None),
            Rule::GuardBand(share) => ("guard band", Some(share)),
            Rule::Risk(risk) => ("specific risk", Some(risk)),
        };
        let within = trials.iter().filter(|value| limits.holds(**value)).count();
        let limit = |of: fn(&ToleranceInterval) -> f64| accepted.as_ref().ok().and_then(|limits| finite(of(limits)));
        Ok(Conformity {
            lower: finite(limits.lower()),
            upper: finite(limits.upper()),
            probability: risk.map(|risk| 1.0 - risk),
            probability_by_trials: within as f64 / trials.len().max(1) as f64,
            rule,
            parameter,
            acceptance_lower: limit(ToleranceInterval::lower),
            acceptance_upper: limit(ToleranceInterval::upper),
            accepted: accepted.as_ref().is_ok_and(|limits| limits.holds(y)),
            nothing_accepted: accepted.err().map(|error| error.to_string()),
        })
    }
}

impl Conformity {
    /// True if the result is accepted.
    pub(super) const fn is_accepted(&self) -> bool {
        self.accepted
    }

    /// The decision in lines.
    pub(super) fn text(&self, budget: &Budget) -> String {
        let mut text = String::new();
        let unit = if matches!(budget.unit(), "" | "1") { String::new() } else { format!(" {}", budget.unit()) };
        let range = |lower: Option<f64>, upper: Option<f64>, digits: &dyn Fn(f64) -> String| match (lower, upper) {
            (Some(lower), Some(upper)) => format!("from {} to {}{unit}", digits(lower), digits(upper)),
            (Some(lower), None) => format!("from {}{unit} on", digits(lower)),
            (None, Some(upper)) => format!("up to {}{unit}", digits(upper)),
            (None, None) => "nowhere".to_owned(),
        };
        let percent = |share: f64| match share {
            share if share < 1.0 && share > 0.999_95 => "more than 99.99 %".to_owned(),
            share if share > 0.0 && share < 0.000_05 => "less than 0.01 %".to_owned(),
            share => format!("{:.2} %", 100.0 * share),
        };
        // Writing to a string does not fail.
        let _ = write!(text, "tolerance {}: ", range(self.lower, self.upper, &Rounded::every_digit));
        let trials = percent(self.probability_by_trials);
        let _ = match self.probability {
            Some(probability) => {
                writeln!(text, "conforms with a probability of {} (by trials {trials})", percent(probability))
            }
            None => writeln!(text, "conforms with a probability of {trials} by trials"),
        };
        let rule = match (self.rule, self.parameter) {
            ("guard band", Some(share)) => format!("guard band {share} U"),
            ("specific risk", Some(risk)) => format!("specific risk of at most {}", percent(risk)),
            (rule, _) => rule.to_owned(),
        };
        let _ = if let Some(why) = &self.nothing_accepted {
            writeln!(text, "{rule}: nothing is accepted; {why}")
        } else {
            let range = range(self.acceptance_lower, self.acceptance_upper, &|limit| Rounded::significant(limit, 6));
            let verdict = if self.is_accepted() { "accepted" } else { "not accepted" };
            writeln!(text, "{rule}: accepted {range}; the result is {verdict}")
        };
        text
    }
}
