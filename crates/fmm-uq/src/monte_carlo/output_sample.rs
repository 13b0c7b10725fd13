//! Sample of outputs of the trials of a Monte Carlo.

use fmm_model::Interval;

use crate::error::UncertaintyError;
use crate::failure::Failures;
use crate::moments::Moments;
use crate::monte_carlo::order_statistics::{largest, ranked, smallest};
use crate::monte_carlo::refusal::HeavyTail;

/// The values of all outputs over the successful trials of a run, in the order of the trials.
///
/// All results are from the pooled values: the averages of the shortest intervals of parts would be biased. If trials
/// failed, every figure is conditional on success.
///
/// | JCGM 101:2008 | method |
/// |---|---|
/// | estimate y, 7.6 | [`OutputSample::estimate`] |
/// | standard uncertainty u(y), 7.6 | [`OutputSample::standard_uncertainty`] |
/// | probabilistically symmetric interval, 7.7 | [`OutputSample::symmetric_interval`] |
/// | shortest interval, 7.7 | [`OutputSample::shortest_interval`] |
///
/// Outputs are counted from 0; a figure of an output that does not exist is an error.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputSample {
    columns: Vec<Vec<f64>>,
    moments: Vec<Moments>,
    trials: u64,
    failures: Failures,
    heavy_tail: Option<HeavyTail>,
}

impl OutputSample {
    /// The sample of given columns of equal lengths.
    pub(crate) fn new(
        columns: Vec<Vec<f64>>,
        trials: u64,
        failures: Failures,
        heavy_tail: Option<HeavyTail>,
    ) -> Result<Self, UncertaintyError> {
        if columns.first().is_none_or(Vec::is_empty) {
            return Err(UncertaintyError::no_success());
        }
        let overflow =
            || UncertaintyError::uncertainty_out_of_range("the result", f64::INFINITY, "(unit of the result)");
        let moments = columns.iter().map(|column| Moments::of_values(column).if_finite().ok_or_else(overflow));
        let moments = moments.collect::<Result<_, _>>()?;
        Ok(Self { columns, moments, trials, failures, heavy_tail })
    }

    /// Number of trials, failed ones included.
    pub const fn trials(&self) -> u64 {
        self.trials
    }

    /// The failed trials.
    pub const fn failures(&self) -> &Failures {
        &self.failures
    }

    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.columns.len()
    }

    /// The values of an output over the successful trials (its unit).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an output that does not exist.
    pub fn values(&self, output: usize) -> Result<&[f64], UncertaintyError> {
        let outputs = self.columns.len();
        self.columns.get(output).map(Vec::as_slice).ok_or_else(|| UncertaintyError::no_such_output(output, outputs))
    }

    /// Mean and spread of an output (its unit).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an output that does not exist.
    pub fn moments(&self, output: usize) -> Result<&Moments, UncertaintyError> {
        let outputs = self.columns.len();
        self.moments.get(output).ok_or_else(|| UncertaintyError::no_such_output(output, outputs))
    }

    /// y, mean of the values (unit of the output).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an output that does not exist; [`UncertaintyError::NoAnswer`] if an input
    /// has Student's t of ν = 1, which has no mean.
    pub fn estimate(&self, output: usize) -> Result<f64, UncertaintyError> {
        HeavyTail::require_mean(self.heavy_tail.as_ref())?;
        Ok(self.moments(output)?.mean())
    }

    /// u(y), standard deviation of the values (unit of the output).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an output that does not exist, and for a single trial;
    /// [`UncertaintyError::NoAnswer`] for values whose squares vanish, or if an input has Student's t
    /// of ν ≤ 2, such as the mean of two or three observations. If the model bounds such an input,
    /// [`OutputSample::moments`] has the deviation nevertheless.
    pub fn standard_uncertainty(&self, output: usize) -> Result<f64, UncertaintyError> {
        let moments = self.moments(output)?;
        HeavyTail::require_variance(self.heavy_tail.as_ref())?;
        moments.require_squares(self.values(output)?, "the result")?;
        let too_few = || UncertaintyError::too_few_observations(moments.count(), 2);
        moments.standard_deviation().ok_or_else(too_few)
    }

    /// Standard errors of y and of u(y) from the limited number of trials (unit of the output).
    ///
    /// # Errors
    /// Those of [`OutputSample::standard_uncertainty`].
    pub fn standard_errors(&self, output: usize) -> Result<[f64; 2], UncertaintyError> {
        let u = self.standard_uncertainty(output)?;
        let moments = self.moments(output)?;
        Ok([u / (moments.count() as f64).sqrt(), moments.standard_error_of_deviation().unwrap_or(0.0)])
    }

    /// The interval that leaves equal probabilities (1 − p)/2 on both sides (JCGM 101:2008, 7.7.2).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless 0 < p < 1;
    /// [`UncertaintyError::TooFewTrials`] if the interval would reach beyond the values.
    pub fn symmetric_interval(&self, output: usize, level: f64) -> Result<Interval, UncertaintyError> {
        symmetric(self.values(output)?, level)
    }

    /// The shortest interval that holds a share p of the values (JCGM 101:2008, 7.7.3), the lowest if there are
    /// several.
    ///
    /// # Errors
    /// Those of [`OutputSample::symmetric_interval`].
    pub fn shortest_interval(&self, output: usize, level: f64) -> Result<Interval, UncertaintyError> {
        shortest(self.values(output)?, level)
    }
}

/// q and M − q: the ranks that an interval spans, and the places that it may begin at.
fn span(count: usize, level: f64) -> Result<(usize, usize), UncertaintyError> {
    let level = UncertaintyError::require_level(level)?;
    let needed = ((2.0 / (1.0 - level)).ceil() as usize).max(2);
    // p M is whole where it is so to rounding: 0.95 of a million is.
    let q = (level * count as f64 + 0.5).floor() as usize;
    if q == 0 || q >= count || count < needed {
        return Err(UncertaintyError::too_few_trials(count, level, needed));
    }
    Ok((q, count - q))
}

pub(crate) fn symmetric(values: &[f64], level: f64) -> Result<Interval, UncertaintyError> {
    let (q, places) = span(values.len(), level)?;
    let first = places.div_ceil(2);
    Ok(Interval { low: ranked(values, first), high: ranked(values, first + q), level })
}

pub(crate) fn shortest(values: &[f64], level: f64) -> Result<Interval, UncertaintyError> {
    let (_, places) = span(values.len(), level)?;
    let (low, high) = (smallest(values, places), largest(values, places));
    let mut best = Interval { low: low[0], high: high[0], level };
    for (&low, &high) in low.iter().zip(&high) {
        if high - low < best.width() {
            (best.low, best.high) = (low, high);
        }
    }
    Ok(best)
}
