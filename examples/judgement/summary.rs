//! Summary of the outcomes of one cell.

use std::collections::BTreeMap;

use super::cell::Group;
use super::study::Outcome;
use super::{Cell, Levels, Truth, Verdict};

/// How many of how many.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Share {
    pub(crate) count: usize,
    pub(crate) of: usize,
}

impl Share {
    fn add(&mut self, holds: bool) {
        self.count += usize::from(holds);
        self.of += 1;
    }

    /// In percent; none of nothing.
    pub(crate) fn percent(self) -> Option<f64> {
        (self.of > 0).then(|| 100.0 * self.count as f64 / self.of as f64)
    }
}

/// One row of the tables.
#[derive(Debug, Clone, Default)]
pub(crate) struct Summary {
    pub(crate) name: String,
    pub(crate) group: Option<Group>,
    pub(crate) records: usize,
    pub(crate) failures: usize,
    /// The first failure, in words.
    pub(crate) failure: Option<String>,
    /// Verdicts that state no μ though there is one, or have no interval for it.
    pub(crate) without_mu: usize,
    /// Mean of (stated − true)/true of μ (1).
    pub(crate) bias: Option<f64>,
    /// Median of the absolute value of that (1).
    pub(crate) median_error: Option<f64>,
    /// Standard deviation of (stated − true)/u of μ (1).
    pub(crate) scatter: Option<f64>,
    /// 95 % intervals that hold the truth.
    pub(crate) mu: Share,
    pub(crate) damping: Share,
    pub(crate) frequency: Share,
    /// Intervals of μ that miss the truth, with and without a loud warning.
    pub(crate) loud_misses: usize,
    pub(crate) silent_misses: usize,
    /// Decided verdicts.
    pub(crate) decided: usize,
    /// Decided for a right law.
    pub(crate) right: usize,
    /// Decided for another, with and without a loud warning.
    pub(crate) wrong_loud: usize,
    pub(crate) wrong_silent: usize,
    /// Undecided with a right law among those named, and without.
    pub(crate) among: usize,
    pub(crate) not_among: usize,
    /// Decided, more than 5 % and more than the interval off, and no loud warning.
    pub(crate) silently_wrong: usize,
    pub(crate) preferred: BTreeMap<String, usize>,
    pub(crate) named: BTreeMap<String, usize>,
    pub(crate) warnings: BTreeMap<String, usize>,
    /// Times of the judgements (s), the shortest first.
    pub(crate) seconds: Vec<f64>,
}

/// True if `stated` is far from `truth`: more than 5 % of it, and more than half the width of the interval.
fn is_far(stated: f64, truth: f64, interval: Option<(f64, f64)>) -> bool {
    const FAR: f64 = 0.05;
    let reach = interval.map_or(0.0, |(low, high)| 0.5 * (high - low));
    (stated - truth).abs() > (FAR * truth).max(reach)
}

/// True if the μ of the preferred law is far from the truth both at rest and at the peak speed. A law of one level says
/// the same of both, and is right if it hits either.
fn is_wrong(truth: &Truth, verdict: &Verdict) -> bool {
    let interval = verdict.mu.and_then(|mu| mu.interval);
    let (stated, truth) = (verdict.levels, truth.levels);
    is_far(stated.rest, truth.rest, interval) && is_far(stated.peak, truth.peak, interval)
}

/// The levels that the stated μ may mean: at rest, at the peak speed and, if the preferred law is not of one level,
/// beyond.
fn meant<'a>(truth: &'a Truth, verdict: &Verdict) -> impl Iterator<Item = f64> + Clone + use<'a> {
    let Levels { rest, peak, beyond } = truth.levels;
    [rest, peak].into_iter().chain((!verdict.levels.is_constant()).then_some(beyond))
}

impl Summary {
    /// The summary of the `outcomes` of `cell`.
    pub(crate) fn of(cell: &Cell, outcomes: &[Outcome]) -> Self {
        let mut summary =
            Self { name: cell.name.clone(), group: Some(cell.group), records: outcomes.len(), ..Self::default() };
        let (mut relative, mut scaled) = (Vec::new(), Vec::new());
        for outcome in outcomes {
            match &outcome.verdict {
                Ok((truth, verdict)) => {
                    summary.count(truth, verdict);
                    if let Some((error, in_uncertainties)) = errors(truth, verdict) {
                        relative.push(error);
                        scaled.push(in_uncertainties);
                    }
                }
                Err(reason) => {
                    summary.failures += 1;
                    summary.failure.get_or_insert_with(|| reason.clone());
                }
            }
        }
        relative.retain(|error| error.is_finite());
        scaled.retain(|error| error.is_finite());
        summary.bias = mean(&relative);
        summary.median_error = median(relative.iter().map(|error| error.abs()));
        summary.scatter = deviation(&scaled);
        summary.seconds = outcomes.iter().map(|outcome| outcome.seconds).collect();
        summary.seconds.sort_by(f64::total_cmp);
        summary
    }

    /// Time that half of the judgements take at most (s).
    pub(crate) fn median_seconds(&self) -> f64 {
        quantile(&self.seconds, 0.5)
    }

    fn count(&mut self, truth: &Truth, verdict: &Verdict) {
        // An assumption with its price is a word on a change that does not show, and on no other.
        let does_not_show =
            |size: f64, unseen: Option<f64>| size != 0.0 && unseen.is_some_and(|most| size.abs() < most);
        let is_priced =
            does_not_show(truth.change, verdict.unseen_change) || does_not_show(truth.rise, verdict.unseen_rise);
        let is_loud = verdict.is_loud || is_priced;
        let holds_mu = verdict
            .mu
            .filter(|mu| mu.interval.is_some())
            .map(|mu| meant(truth, verdict).any(|level| mu.holds(level) == Some(true)));
        match holds_mu {
            Some(holds) => {
                self.mu.add(holds);
                self.loud_misses += usize::from(!holds && is_loud);
                self.silent_misses += usize::from(!holds && !is_loud);
            }
            None => self.without_mu += usize::from(truth.levels.rest > 0.0),
        }
        if let Some(holds) = verdict.damping.and_then(|damping| damping.holds(truth.damping_per_mass)) {
            self.damping.add(holds);
        }
        if let Some(holds) = verdict.frequency.and_then(|frequency| frequency.holds(truth.frequency)) {
            self.frequency.add(holds);
        }
        let is_right = |law: &String| truth.right.contains(&law.as_str());
        self.decided += usize::from(verdict.is_decided);
        let tally = match (verdict.is_decided, verdict.named.iter().any(is_right), is_loud) {
            (true, true, _) => &mut self.right,
            (true, false, true) => &mut self.wrong_loud,
            (true, false, false) => &mut self.wrong_silent,
            (false, true, _) => &mut self.among,
            (false, false, _) => &mut self.not_among,
        };
        *tally += 1;
        self.silently_wrong += usize::from(verdict.is_decided && !is_loud && is_wrong(truth, verdict));
        *self.preferred.entry(verdict.preferred.clone()).or_default() += 1;
        for (names, counts) in [(&verdict.named, &mut self.named), (&verdict.warnings, &mut self.warnings)] {
            for name in names {
                *counts.entry(name.clone()).or_default() += 1;
            }
        }
    }
}

/// Error of μ by the truth and by its uncertainty, from the nearest level that it may mean.
fn errors(truth: &Truth, verdict: &Verdict) -> Option<(f64, f64)> {
    let mu = verdict.mu?;
    let off = |level: &f64| (mu.value - level).abs();
    let level = meant(truth, verdict).min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let error = mu.value - level;
    Some((error / level, error / mu.uncertainty?))
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The middle value, the upper one of two.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    (!values.is_empty()).then(|| quantile(&values, 0.5))
}

/// Value that a `share` of the `sorted` ones, at least, does not exceed; zero of none.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = (share * sorted.len() as f64) as usize;
    sorted.get(place.min(sorted.len().saturating_sub(1))).copied().unwrap_or(0.0)
}

fn deviation(values: &[f64]) -> Option<f64> {
    let mean = mean(values)?;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (values.len() > 1).then(|| (squares / (values.len() - 1) as f64).sqrt())
}
