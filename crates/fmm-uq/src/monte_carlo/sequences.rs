//! Sequences of an adaptive run, and whether their figures are stable.

use crate::error::UncertaintyError;
use crate::moments::Moments;
use crate::monte_carlo::adaptive::{Adaptive, IntervalKind};
use crate::monte_carlo::block::Block;
use crate::monte_carlo::output_sample::symmetric;
use crate::monte_carlo::pool::Pool;
use crate::monte_carlo::refusal::HeavyTail;
use crate::monte_carlo::settling::Settling;

/// Sequences of trials before the first decision: with fewer, chance may make them agree.
const FEWEST_SEQUENCES: usize = 10;

/// The sequences of an adaptive run, pooled until they are stable.
pub(super) struct Sequences {
    rule: Adaptive,
    pub(super) pool: Pool,
    outputs: Vec<Figures>,
}

impl Sequences {
    pub(super) fn new(rule: Adaptive, heavy_tail: Option<&HeavyTail>) -> Result<Self, UncertaintyError> {
        HeavyTail::require_variance(heavy_tail)?;
        let needed = rule.trials_of_sequence().saturating_mul(FEWEST_SEQUENCES as u64);
        let allowed = rule.most_trials;
        if allowed < needed {
            let what = format!(
                "the first decision takes {needed} trials, but at most {allowed} are allowed; lower the level, or \
                 allow more"
            );
            return Err(UncertaintyError::TooFewTrials { what, trials: allowed });
        }
        Ok(Self { rule, pool: Pool::new(0), outputs: Vec::new() })
    }

    /// Takes in the blocks of the next sequence and says whether it is the last one.
    pub(super) fn add(&mut self, blocks: &[Block]) -> Result<bool, UncertaintyError> {
        let values = |pool: &Pool| pool.columns.first().map_or(0, Vec::len);
        let before = values(&self.pool);
        self.pool.add(blocks)?;
        if values(&self.pool) == before {
            return Err(UncertaintyError::no_success());
        }
        self.outputs.resize_with(self.pool.columns.len(), || Figures::new(&self.rule));
        for (column, figures) in self.pool.columns.iter().zip(&mut self.outputs) {
            figures.add(column, before, self.rule.level)?;
        }
        if self.is_stable()? {
            return Ok(true);
        }
        if self.left() > 0 {
            return Ok(false);
        }
        let trials = self.pool.trials;
        let advice = "allow more, or ask for fewer digits";
        let what = format!("the results are not stable to the tolerance after {trials} trials; {advice}");
        Err(UncertaintyError::TooFewTrials { what, trials })
    }

    /// Sequences that may still be made.
    pub(super) fn left(&self) -> u64 {
        self.rule.most_trials.saturating_sub(self.pool.trials) / self.rule.trials_of_sequence()
    }

    /// True if all figures of all outputs are stable: 2 s_z ≤ δ for the spread of averages between sequences, and the
    /// ends of shortest intervals as [`Settling`] has it.
    fn is_stable(&self) -> Result<bool, UncertaintyError> {
        let count = self.outputs.first().map_or(0, |figures| figures.averaged[0].len());
        if count < FEWEST_SEQUENCES {
            return Ok(false);
        }
        for figures in self.outputs.iter().filter(|figures| figures.uncertainty() != 0.0) {
            let tolerance = self.rule.tolerance(figures.uncertainty())?;
            let agrees = |figure: &Vec<f64>| {
                let spread = Moments::of_values(figure).standard_deviation().unwrap_or(f64::INFINITY);
                // A shade more than whole is whole: rounding must not cost a sequence.
                ((2.0 * spread / tolerance).powi(2) * (1.0 - 1e-12)).ceil() <= count as f64
            };
            let settles = |settling: &Settling| settling.doubt() <= tolerance;
            if !(figures.averaged.iter().all(agrees) && figures.settling.as_ref().is_none_or(settles)) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The figures of one output.
#[derive(Debug, Clone)]
struct Figures {
    /// Estimate, uncertainty and, of a symmetric interval, both ends by sequence.
    averaged: Vec<Vec<f64>>,
    /// Ends of a shortest interval.
    settling: Option<Settling>,
    /// Number, mean and sum of squares of all trials so far.
    pooled: (f64, f64, f64),
}

impl Figures {
    fn new(rule: &Adaptive) -> Self {
        let (averaged, settling) = match rule.kind {
            IntervalKind::Symmetric => (4, None),
            IntervalKind::Shortest => (2, Some(Settling::new(rule.level))),
        };
        Self { averaged: vec![Vec::new(); averaged], settling, pooled: (0.0, 0.0, 0.0) }
    }

    /// Takes in the next sequence: all values of the output, of which those from `start` on are new.
    fn add(&mut self, values: &[f64], start: usize, level: f64) -> Result<(), UncertaintyError> {
        let sequence = &values[start..];
        let moments = Moments::of_values(sequence);
        let mut figures = vec![moments.mean(), moments.standard_deviation().unwrap_or(0.0)];
        if let Some(settling) = &mut self.settling {
            settling.add(values)?;
        } else {
            let interval = symmetric(sequence, level)?;
            figures.extend([interval.low, interval.high]);
        }
        for (list, figure) in self.averaged.iter_mut().zip(figures) {
            list.push(figure);
        }
        let (n, mean, squares) = self.pooled;
        let (more, difference) = (moments.count() as f64, moments.mean() - mean);
        let all = n + more;
        self.pooled = (
            all,
            mean + difference * (more / all),
            squares + moments.sum_of_squares() + difference * difference * (n * (more / all)),
        );
        Ok(())
    }

    /// u(y) of all trials so far (unit of the output).
    fn uncertainty(&self) -> f64 {
        let (n, _, squares) = self.pooled;
        (squares / (n - 1.0)).sqrt()
    }
}
