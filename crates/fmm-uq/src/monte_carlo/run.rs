//! Runs of blocks of trials on all threads.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::error::UncertaintyError;
use crate::model::ModelOutput;
use crate::monte_carlo::adaptive::Adaptive;
use crate::monte_carlo::block::{BLOCK_TRIALS, Block};
use crate::monte_carlo::output_sample::OutputSample;
use crate::monte_carlo::partial_run::PartialRun;
use crate::monte_carlo::pool::Pool;
use crate::monte_carlo::sequences::Sequences;
use crate::monte_carlo::{MonteCarlo, Progress};

/// Planned number of trials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Plan {
    Fixed(u64),
    Adaptive(Adaptive),
}

/// Blocks that each thread runs before they are pooled: enough that no thread waits long for the last of the others.
#[cfg(feature = "rayon")]
const BLOCKS_OF_THREAD: u64 = 32;

/// State that the threads of a run share.
struct State {
    done: AtomicU64,
    cancelled: AtomicBool,
    /// Index of the first block known to have failed where none may.
    failed_block: AtomicU64,
}

impl MonteCarlo<'_> {
    /// Runs all trials and pools them.
    ///
    /// # Errors
    /// [`UncertaintyError::TooManyFailures`] if more trials fail than allowed; where none may fail, at the first
    /// failure. [`UncertaintyError::Model`] if no trial succeeds, or the number of outputs changes.
    /// [`UncertaintyError::Cancelled`] if the observer of the progress ends the run. [`UncertaintyError::Invalid`]
    /// if the squares of the values overflow. For an adaptive run also [`UncertaintyError::TooFewTrials`] if its
    /// largest number of trials is too small for the rule, and [`UncertaintyError::NoAnswer`] if an input has Student's
    /// t of ν ≤ 2.
    ///
    /// # Panics
    /// If the model does: a panic ends the run and passes through. A model that may fail should return an error.
    pub fn run<R: ModelOutput<f64>>(
        &self,
        model: impl Fn(&[f64]) -> R + Sync,
    ) -> Result<OutputSample, UncertaintyError> {
        let rule = match self.plan {
            Plan::Fixed(trials) => {
                let mut pool = Pool::new(trials);
                self.run_groups(0..blocks_of(trials), &model, |blocks| pool.add(&blocks))?;
                return self.close(pool);
            }
            Plan::Adaptive(rule) => rule,
        };
        let (state, mut sequences) = (State::new(), Sequences::new(rule, self.heavy_tail.as_ref())?);
        let length = rule.blocks_of_sequence();
        // Several sequences at a time where one would leave threads idle; those after the stop are dropped.
        let most_at_once = (4 * threads()).div_ceil(length);
        let mut start = 0;
        loop {
            let at_once = length * most_at_once.min(sequences.left());
            for sequence in self.run_group(&state, start..start + at_once, &model)?.chunks(length as usize) {
                if sequences.add(sequence)? {
                    return self.close(sequences.pool);
                }
            }
            start += at_once;
        }
    }

    /// Pools the trials of a complete partial result; for an adaptive run, those up to the stop.
    ///
    /// # Errors
    /// [`UncertaintyError::PartialRun`] if it is of another run, or with the first block that is still needed; and
    /// those of [`MonteCarlo::run`].
    pub fn finish(&self, partial: PartialRun) -> Result<OutputSample, UncertaintyError> {
        partial.require(self.seed, self.fingerprint)?;
        let complete = |block: &Block| block.trials == self.trials_of(block.index);
        let mut blocks = partial.into_blocks();
        let present = blocks.iter().zip(0..).position(|(block, index)| block.index != index || !complete(block));
        blocks.truncate(present.unwrap_or(blocks.len()));
        let present = blocks.as_slice();
        let block = present.len() as u64;
        let what = format!("block {block} is missing; merge the shard that holds it, or run it");
        let missing = Err(UncertaintyError::part(what, block));
        match self.plan {
            Plan::Fixed(trials) => {
                let Some(needed) = usize::try_from(blocks_of(trials)).ok().and_then(|count| present.get(..count))
                else {
                    return missing;
                };
                let mut pool = Pool::new(trials);
                pool.add(needed)?;
                self.close(pool)
            }
            Plan::Adaptive(rule) => {
                let mut sequences = Sequences::new(rule, self.heavy_tail.as_ref())?;
                for sequence in present.chunks_exact(rule.blocks_of_sequence() as usize) {
                    if sequences.add(sequence)? {
                        return self.close(sequences.pool);
                    }
                }
                missing
            }
        }
    }

    /// Runs some blocks of trials; [`MonteCarlo::shard`] divides the blocks of a fixed number of trials.
    ///
    /// # Errors
    /// Those of [`MonteCarlo::run`], except those of the whole run: no success, and too many failures where some are
    /// allowed.
    ///
    /// # Panics
    /// If the model does.
    pub fn run_blocks<R: ModelOutput<f64>>(
        &self,
        blocks: Range<u64>,
        model: impl Fn(&[f64]) -> R + Sync,
    ) -> Result<PartialRun, UncertaintyError> {
        let end = self.planned().map_or(blocks.end, |trials| blocks.end.min(blocks_of(trials)));
        let mut all = Vec::new();
        self.run_groups(blocks.start..end, &model, |blocks| {
            all.extend(blocks);
            Ok(())
        })?;
        let mut outputs = all.iter().map(|block: &Block| block.outputs).filter(|&outputs| outputs != 0);
        if let Some(first) = outputs.next()
            && let Some(again) = outputs.find(|&again| again != first)
        {
            return Err(UncertaintyError::output_count_changed(first, again));
        }
        PartialRun::assemble(self.seed, self.fingerprint, all)
    }

    /// Runs blocks in groups and hands each group to `take`, in their order.
    ///
    /// A group is no more than keeps all threads busy, so that its memory is used again for the next one.
    fn run_groups<R: ModelOutput<f64>>(
        &self,
        range: Range<u64>,
        model: &(impl Fn(&[f64]) -> R + Sync),
        mut take: impl FnMut(Vec<Block>) -> Result<(), UncertaintyError>,
    ) -> Result<(), UncertaintyError> {
        let state = State::new();
        let mut start = range.start;
        while start < range.end {
            let end = range.end.min(start.saturating_add(blocks_at_once()));
            take(self.run_group(&state, start..end, model)?)?;
            start = end;
        }
        Ok(())
    }

    fn run_group<R: ModelOutput<f64>>(
        &self,
        state: &State,
        range: Range<u64>,
        model: &(impl Fn(&[f64]) -> R + Sync),
    ) -> Result<Vec<Block>, UncertaintyError> {
        let planned = self.planned();
        let one = |index: u64| {
            // Where none may fail, blocks after a failed one are not worth running. Those before it are: the first
            // failure in order is the one reported, whichever thread met it first.
            let wanted =
                || index <= state.failed_block.load(Ordering::Relaxed) && !state.cancelled.load(Ordering::Relaxed);
            if !wanted() {
                return None;
            }
            let watch = |trials: usize, failures: u64| {
                if failures > 0 && self.allowed_failures.is_none() {
                    state.failed_block.fetch_min(index, Ordering::Relaxed);
                    return false;
                }
                if let Some(watch) = self.watch {
                    let done = state.done.fetch_add(trials as u64, Ordering::Relaxed) + trials as u64;
                    if watch(Progress { done, planned }).is_break() {
                        state.cancelled.store(true, Ordering::Relaxed);
                    }
                }
                wanted()
            };
            Some(Block::run((self.seed, index, self.trials_of(index)), &self.sampler, model, &watch))
        };
        #[cfg(feature = "rayon")]
        let blocks: Vec<Option<Block>> = range.into_par_iter().map(one).collect();
        #[cfg(not(feature = "rayon"))]
        let blocks: Vec<Option<Block>> = range.map(one).collect();
        let blocks: Vec<Block> = blocks.into_iter().flatten().filter(|block| block.trials > 0).collect();
        if self.allowed_failures.is_none() {
            blocks.iter().try_for_each(|block| self.allowed_failures.check(&block.failures, block.trials as u64))?;
        }
        if state.cancelled.load(Ordering::Relaxed) {
            return Err(UncertaintyError::Cancelled { trials: state.done.load(Ordering::Relaxed) });
        }
        Ok(blocks)
    }

    fn trials_of(&self, block: u64) -> usize {
        let whole = BLOCK_TRIALS as u64;
        let left = self.planned().map_or(whole, |trials| trials.saturating_sub(block.saturating_mul(whole)));
        left.min(whole) as usize
    }

    fn close(&self, pool: Pool) -> Result<OutputSample, UncertaintyError> {
        self.allowed_failures.check(&pool.failures, pool.trials)?;
        OutputSample::new(pool.columns, pool.trials, pool.failures, self.heavy_tail.clone())
    }
}

impl State {
    const fn new() -> Self {
        let (done, failed_block) = (AtomicU64::new(0), AtomicU64::new(u64::MAX));
        Self { done, cancelled: AtomicBool::new(false), failed_block }
    }
}

/// Blocks of a number of trials.
const fn blocks_of(trials: u64) -> u64 {
    trials.div_ceil(BLOCK_TRIALS as u64)
}

/// Blocks of a group; a single thread needs no others to wait for.
fn blocks_at_once() -> u64 {
    #[cfg(feature = "rayon")]
    return if threads() == 1 { 1 } else { BLOCKS_OF_THREAD * threads() };
    #[cfg(not(feature = "rayon"))]
    1
}

fn threads() -> u64 {
    #[cfg(feature = "rayon")]
    return rayon::current_num_threads() as u64;
    #[cfg(not(feature = "rayon"))]
    1
}
