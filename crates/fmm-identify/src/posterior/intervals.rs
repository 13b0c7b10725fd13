//! Intervals of three kinds beside each other.

use fmm_fit::posterior::Marginal;

use crate::finding::Finding;
use crate::identification::{Identification, Profile, Profiles};

/// Probability of the intervals.
pub(super) const LEVEL: f64 = 0.95;
/// Difference of two ends, over the width of the posterior's interval, below which they agree (1).
const ALIKE: f64 = 0.1;
/// Monte Carlo standard error of an end of a 95 % interval of a normal distribution, in standard deviations times the
/// root of the number of effective draws: √(0.025 · 0.975)/φ(1.96).
const ERROR_OF_END: f64 = 2.7;

/// The 95 % interval of one finding by its standard uncertainty, from the profile of the sum of squares, and from the
/// posterior, in the unit of the finding.
#[derive(Debug, Clone, PartialEq)]
pub struct IntervalComparison {
    pub(super) finding: Finding,
    wald: Option<(f64, f64)>,
    profile: Option<(Option<f64>, Option<f64>)>,
    posterior: (f64, f64),
    /// Distance up to which ends are alike.
    alike: f64,
}

impl IntervalComparison {
    /// Name of the finding.
    pub fn name(&self) -> &str {
        self.finding.parameter().name()
    }

    /// Value ± k u, [`Finding::interval`]; `None` for a finding without an uncertainty.
    pub fn wald(&self) -> Option<(f64, f64)> {
        self.wald
    }

    /// The ends of the profile interval, each `None` where it is open; `None` for a derived quantity, or if the profile
    /// failed. Known values of the machine count as exact.
    pub fn profile(&self) -> Option<(Option<f64>, Option<f64>)> {
        self.profile
    }

    /// Between the 2.5 % and the 97.5 % quantile of the posterior.
    pub fn posterior(&self) -> (f64, f64) {
        self.posterior
    }

    /// The ends of the other intervals differ from those of the posterior by at most a tenth of its width, or by its
    /// Monte Carlo error.
    pub fn agrees(&self) -> bool {
        let is_alike = |end: Option<f64>, of: f64| end.is_some_and(|end| (end - of).abs() <= self.alike);
        let (low, high) = self.posterior;
        let wald = self.wald.is_some_and(|wald| is_alike(Some(wald.0), low) && is_alike(Some(wald.1), high));
        wald && self.profile.is_none_or(|profile| is_alike(profile.0, low) && is_alike(profile.1, high))
    }
}

/// The intervals of all findings that the records share.
pub(super) fn compared(found: &Identification, profiles: &Profiles, marginals: &[Marginal]) -> Vec<IntervalComparison> {
    let compare = |marginal: &Marginal| {
        let finding = found.finding(marginal.parameter().name()).filter(|finding| !finding.is_of_record())?;
        let name = finding.parameter().name();
        let profile = profiles.profiles().iter().find(|profile| profile.parameter().name() == name);
        let ends = |profile: &Profile| (profile.interval().lower().value(), profile.interval().upper().value());
        let posterior = marginal.interval(LEVEL)?;
        let error = ERROR_OF_END * marginal.standard_deviation() / marginal.tail_effective_size().sqrt();
        Some(IntervalComparison {
            finding: finding.clone(),
            wald: finding.interval(LEVEL),
            profile: profile.map(ends),
            posterior,
            alike: (ALIKE * (posterior.1 - posterior.0)).max(3.0 * error),
        })
    };
    marginals.iter().filter_map(compare).collect()
}
