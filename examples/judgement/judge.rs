//! The thing under test: what the crates say of a record when nothing is asked for.

use fmm_identify::{
    Comparison, Experiment, Finding, Identification, IdentifyError, Inquiry, Machine, Preparation, Severity, Warning,
};

use super::law::Law;
use super::{Case, Levels, Truth};

/// The default judgement. This is the one place that knows how it is asked for.
fn default_judgement(machine: &Machine, decays: &[Experiment]) -> Result<Comparison, IdentifyError> {
    Inquiry::of(machine, decays).on_threads(1).search()
}

/// The name of a law without what is held of it, and without a linear damping beside it, which most laws do not have of
/// their own.
pub(crate) fn plain(name: &str) -> String {
    let name = name.split(',').next().unwrap_or(name).trim();
    if let Some(changing) = name.strip_suffix(" + curved change") {
        return plain(changing);
    }
    for term in [" + position", " + change"] {
        if let Some(steady) = name.strip_suffix(term) {
            return format!("{}{term}", plain(steady));
        }
    }
    match name.strip_suffix(" + linear") {
        Some("coulomb") => "coulomb_viscous".to_owned(),
        Some(law) => law.to_owned(),
        None => name.to_owned(),
    }
}

/// Names of the laws that the judgement leaves standing: the preferred one if it is decided, otherwise all that are not
/// excluded.
pub(crate) fn named(comparison: &Comparison) -> Vec<String> {
    if comparison.is_decided() {
        return vec![plain(comparison.preferred().law())];
    }
    comparison.not_excluded().map(|found| plain(found.law())).collect()
}

/// True if one of `warnings` says that the law is not right or not settled, or names what disturbs the record.
fn is_loud(warnings: &[Warning]) -> bool {
    warnings.iter().any(|warning| warning.severity() >= Severity::Caution)
}

/// A quantity as it is stated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stated {
    pub(crate) value: f64,
    pub(crate) uncertainty: Option<f64>,
    /// With 95 %.
    pub(crate) interval: Option<(f64, f64)>,
}

impl Stated {
    fn of(finding: &Finding) -> Self {
        Self { value: finding.value(), uncertainty: finding.uncertainty(), interval: finding.interval(0.95) }
    }

    /// True if the interval holds `truth`; none without an interval.
    pub(crate) fn holds(&self, truth: f64) -> Option<bool> {
        self.interval.map(|(low, high)| (low..=high).contains(&truth))
    }
}

/// Verdict on one record.
#[derive(Debug, Clone)]
pub(crate) struct Verdict {
    pub(crate) preferred: String,
    pub(crate) is_decided: bool,
    pub(crate) named: Vec<String>,
    /// Kinds of the warnings, each once.
    pub(crate) warnings: Vec<String>,
    pub(crate) is_loud: bool,
    /// The largest change of the friction with each half cycle (1) that is said not to show, with its price.
    pub(crate) unseen_change: Option<f64>,
    /// The largest rise of the friction to the largest deflection (1) of which it says that it would not show.
    pub(crate) unseen_rise: Option<f64>,
    /// μ of a law with one level; of others a level that they have a parameter for.
    pub(crate) mu: Option<Stated>,
    /// c/m (1/s).
    pub(crate) damping: Option<Stated>,
    /// f₀ (Hz).
    pub(crate) frequency: Option<Stated>,
    /// μ by the preferred law (1), zero of a law without dry friction.
    pub(crate) levels: Levels,
}

/// Prepares and judges the record of `case`.
pub(crate) fn judge(case: &Case) -> Result<Verdict, IdentifyError> {
    let decay = Experiment::ring_down(&case.record, &Preparation::default())?;
    let comparison = default_judgement(&case.machine, &[decay])?;
    let preferred = comparison.preferred();
    let mut warnings: Vec<String> = comparison.warnings().iter().map(kind).collect();
    warnings.sort();
    warnings.dedup();
    let finding = |names: &[&str]| names.iter().find_map(|name| preferred.finding(name)).map(Stated::of);
    Ok(Verdict {
        preferred: plain(preferred.law()),
        is_decided: comparison.is_decided(),
        named: named(&comparison),
        warnings,
        is_loud: is_loud(comparison.warnings()),
        unseen_change: comparison.friction_change().map(|change| change.largest_unseen()),
        unseen_rise: comparison.friction_over_position().map(|rise| rise.largest_unseen()),
        mu: finding(&["mu", "sliding_mu", "static_mu", "gaining_mu"]),
        damping: finding(&["damping_per_mass"]),
        frequency: finding(&["natural_frequency_hz"]),
        levels: levels(preferred, &case.truth).unwrap_or(Levels { rest: 0.0, peak: 0.0, beyond: 0.0 }),
    })
}

/// Name of the variant.
pub(crate) fn kind(warning: &Warning) -> String {
    format!("{warning:?}").chars().take_while(char::is_ascii_alphanumeric).collect()
}

/// Levels that the fitted law has, by its formula.
fn levels(found: &Identification, truth: &Truth) -> Option<Levels> {
    let law = Law::named(found.law())?;
    let estimates = found.fit().estimates();
    // Behind the law stands what belongs to the record: initial position and velocity, offset.
    let own = estimates.iter().position(|estimate| estimate.name() == "initial_position")?;
    let first = own.checked_sub(law.fitted().count())?;
    let fitted: Vec<f64> = estimates[first..own].iter().map(fmm_fit::Estimate::value).collect();
    let per_mass = law.levels(&law.of_fitted(&fitted)?, truth.peak_speed)?;
    Some(per_mass.times(truth.mass_by_load))
}
