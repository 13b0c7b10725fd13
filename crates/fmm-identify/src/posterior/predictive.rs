//! Posterior predictive checks: features of records from the posterior beside the measured record.

use fmm_fit::EvaluationError;
use fmm_fit::posterior::Posterior;
use fmm_record::Record;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::experiment::{Experiment, Preparation};
use crate::problem::Problem;

/// Replicated records, so that a p-value of 1 % is known to a third of itself.
const REPLICATES: usize = 400;
/// A p-value below this, or above one less this, says that the model misses the feature.
const SURPRISING: f64 = 0.01;

/// A measured feature of a record beside its distribution over records that the posterior predicts.
///
/// ```text
/// p = P(T_replicated > T_measured) + P(T_replicated = T_measured)/2
/// ```
///
/// A p near 0 or 1 says that the model cannot make records like the measured one. Features of a replicated record are
/// found as those of the measured one are, noise and all.
///
/// # References
/// A. Gelman, X.-L. Meng, H. Stern, "Posterior predictive assessment of model fitness via realized discrepancies",
/// Statistica Sinica 6 (1996) 733, <https://www3.stat.sinica.edu.tw/statistica/j6n4/j6n41/j6n41.htm>.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictiveCheck {
    feature: &'static str,
    unit: String,
    record: usize,
    measured: f64,
    /// The feature of each replicated record; infinite for a record that does not stop, or that has fewer half cycles.
    replicated: Vec<f64>,
}

impl PredictiveCheck {
    /// The feature: `"stop time"`, `"half swings"` or `"decrement"`.
    pub fn feature(&self) -> &str {
        self.feature
    }

    /// Its unit, `"1"` for a number.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// Number of the record, from 0.
    pub fn record(&self) -> usize {
        self.record
    }

    /// The feature of the measured record.
    pub fn measured(&self) -> f64 {
        self.measured
    }

    /// The median of the replicated records; `None` if most of them do not show the feature.
    pub fn median(&self) -> Option<f64> {
        let mut sorted = self.replicated.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().filter(|median| median.is_finite())
    }

    /// The posterior predictive p-value (1).
    pub fn p_value(&self) -> f64 {
        let above = self.replicated.iter().filter(|value| **value > self.measured).count() as f64;
        let equal = self.replicated.iter().filter(|value| **value == self.measured).count() as f64;
        (above + 0.5 * equal) / self.replicated.len() as f64
    }

    /// Records from the posterior hardly ever show the measured feature.
    fn is_surprising(&self) -> bool {
        !(SURPRISING..=1.0 - SURPRISING).contains(&self.p_value())
    }

    /// A sentence on a surprising feature.
    pub fn warning(&self) -> Option<String> {
        let side = if self.p_value() < 0.5 { "above" } else { "below" };
        self.is_surprising().then(|| {
            format!(
                "the measured {} lies {side} that of nearly all records from the posterior (p = {:.3}): the model \
                 misses something that it shows",
                self.feature,
                self.p_value()
            )
        })
    }
}

/// The features of one record.
struct Features {
    stop: Option<f64>,
    half_swings: f64,
    /// Values of the turning points.
    peaks: Vec<f64>,
}

impl Features {
    fn of(record: &Record) -> Option<Self> {
        let seen = Experiment::ring_down(record, &Preparation::default()).ok()?;
        let peaks: Vec<f64> = seen.peaks().iter().map(|(_, value)| value.abs()).collect();
        Some(Self { stop: seen.summary().rest_from, half_swings: peaks.len() as f64, peaks })
    }

    /// ln of the ratio of the first amplitude to that after `count` half cycles, per half cycle (1).
    fn decrement(&self, count: usize) -> Option<f64> {
        let (first, last) = (self.peaks.first()?, self.peaks.get(count)?);
        (count > 0 && *last > 0.0).then(|| (first / last).ln() / count as f64)
    }
}

/// Checks of every record that is a ring-down.
pub(super) fn predicted(
    problem: &Problem<'_>,
    posterior: &Posterior,
    random: &mut ChaCha8Rng,
) -> Result<Vec<PredictiveCheck>, EvaluationError> {
    let mut checks = Vec::new();
    let step = (posterior.len() / REPLICATES).max(1);
    for (number, experiment) in problem.experiments().iter().enumerate().filter(|(_, one)| one.drive().is_none()) {
        let Some(measured) = Features::of(experiment.record()) else { continue };
        let mut replicated = Vec::with_capacity(REPLICATES);
        for (draw, (deviation, correlation)) in posterior.draws().zip(posterior.noise()).step_by(step) {
            let mut values = problem.model(number, draw)?;
            let deviation = deviation / problem.weight(number);
            let mut noise = deviation * normal(random);
            let innovation = deviation * (1.0 - correlation * correlation).sqrt();
            for value in &mut values {
                *value += noise;
                noise = correlation * noise + innovation * normal(random);
            }
            let replicate = experiment.record().with_values(values);
            replicated.extend(replicate.ok().and_then(|record| Features::of(&record)));
        }
        let last = measured.peaks.len().saturating_sub(1);
        let mut check = |feature, unit: &str, of: &dyn Fn(&Features) -> Option<f64>| {
            let replicated: Vec<f64> = replicated.iter().map(|one| of(one).unwrap_or(f64::INFINITY)).collect();
            if let Some(measured) = of(&measured).filter(|_| !replicated.is_empty()) {
                checks.push(PredictiveCheck { feature, unit: unit.to_owned(), record: number, measured, replicated });
            }
        };
        check("stop time", "s", &|features| features.stop);
        check("half swings", "1", &|features| Some(features.half_swings));
        check("decrement", "1", &|features| features.decrement(last));
    }
    Ok(checks)
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(replicated: &[f64]) -> PredictiveCheck {
        let replicated = replicated.to_vec();
        PredictiveCheck { feature: "stop time", unit: "s".to_owned(), record: 0, measured: 1.4, replicated }
    }

    /// A law that never stops makes no record like one that does.
    #[test]
    fn what_records_of_a_law_never_show_is_surprising() {
        let never = check(&[f64::INFINITY; 200]);
        assert_eq!((never.p_value(), never.median()), (1.0, None));
        let warning = never.warning().unwrap();
        assert!(warning.starts_with("the measured stop time lies below that of nearly all records"), "{warning}");
        let even = check(&[1.2, 1.3, 1.4, 1.4, 1.5, 1.6]);
        assert_eq!((even.p_value(), even.median(), even.warning()), (0.5, Some(1.4), None));
    }
}
