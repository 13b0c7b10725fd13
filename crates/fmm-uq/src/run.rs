//! Blocks of trials on all threads, and what is done with them.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::adaptive::{Adaptive, Stability};
use crate::block::{BLOCK_TRIALS, Block};
use crate::{MonteCarlo, Outcome, OutputSample, Partial, Progress, UncertaintyError};

/// How many trials there are to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Plan {
    Fixed(u64),
    Adaptive(Adaptive),
}

impl MonteCarlo<'_> {
    pub(crate) fn run_plan<R: Outcome<f64>>(
        &self,
        model: &(impl Fn(&[f64]) -> R + Sync),
    ) -> Result<OutputSample, UncertaintyError> {
        let rule = match self.plan {
            Plan::Fixed(trials) => {
                let blocks = self.run_range(0..trials.div_ceil(BLOCK_TRIALS as u64), model)?;
                return self.pool(blocks.into_blocks());
            }
            Plan::Adaptive(rule) => rule,
        };
        let (mut stability, mut blocks) = (Stability::new(rule), Vec::new());
        let sequence = rule.blocks_of_sequence();
        // Several sequences at a time where one would leave threads idle; those after the stop are dropped.
        let at_once = sequence * (4 * threads()).div_ceil(sequence);
        loop {
            let (start, first) = (blocks.len(), blocks.len() as u64);
            blocks.extend(self.run_range(first..first + at_once, model)?.into_blocks());
            for end in (start..blocks.len()).step_by(sequence as usize).map(|at| at + sequence as usize) {
                if stability.add(&columns(&blocks[end - sequence as usize..end])?)? {
                    blocks.truncate(end);
                    return self.pool(blocks);
                }
                let trials = (end * BLOCK_TRIALS) as u64;
                if trials >= rule.most_trials() {
                    return Err(UncertaintyError::NotStable { trials });
                }
            }
        }
    }

    pub(crate) fn finish_plan(&self, partial: Partial) -> Result<OutputSample, UncertaintyError> {
        for (what, first, second) in
            [("seeds", self.seed, partial.seed()), ("inputs (by fingerprint)", self.fingerprint, partial.inputs())]
        {
            if first != second {
                return Err(UncertaintyError::LayoutMismatch { what, first, second });
            }
        }
        let complete = |block: &Block| block.trials == self.trials_of(block.index);
        let mut numbered = partial.as_blocks().iter().zip(0..);
        let present = numbered.position(|(block, index)| block.index != index || !complete(block));
        let present = present.unwrap_or(partial.as_blocks().len());
        let missing = Err(UncertaintyError::MissingBlock { block: present as u64 });
        let mut blocks = partial.into_blocks();
        match self.plan {
            Plan::Fixed(trials) => {
                let needed = trials.div_ceil(BLOCK_TRIALS as u64);
                if (present as u64) < needed {
                    return missing;
                }
                blocks.truncate(needed as usize);
                self.pool(blocks)
            }
            Plan::Adaptive(rule) => {
                let mut stability = Stability::new(rule);
                blocks.truncate(present);
                let sequence = rule.blocks_of_sequence() as usize;
                for (end, part) in (1..).map(|h| h * sequence).zip(blocks.chunks_exact(sequence)) {
                    if stability.add(&columns(part)?)? {
                        blocks.truncate(end);
                        return self.pool(blocks);
                    }
                    let trials = (end * BLOCK_TRIALS) as u64;
                    if trials >= rule.most_trials() {
                        return Err(UncertaintyError::NotStable { trials });
                    }
                }
                missing
            }
        }
    }

    pub(crate) fn run_range<R: Outcome<f64>>(
        &self,
        range: Range<u64>,
        model: &(impl Fn(&[f64]) -> R + Sync),
    ) -> Result<Partial, UncertaintyError> {
        let (done, cancelled, failed_block) = (AtomicU64::new(0), AtomicBool::new(false), AtomicU64::new(u64::MAX));
        let planned = match self.plan {
            Plan::Fixed(trials) => Some(trials),
            Plan::Adaptive(_) => None,
        };
        let start = range.start;
        let one = |offset: usize| {
            let index = start + offset as u64;
            // Where none may fail, blocks after a failed one are not worth running. Those before it are: the first
            // failure in order is the one that is told, whoever met it first.
            let wanted = || index <= failed_block.load(Ordering::Relaxed) && !cancelled.load(Ordering::Relaxed);
            if !wanted() {
                return None;
            }
            let watch = |trials: usize, failures: u64| {
                if failures > 0 && self.allowed_failures == 0.0 {
                    failed_block.fetch_min(index, Ordering::Relaxed);
                    return false;
                }
                if let Some(watch) = self.watch {
                    let done = done.fetch_add(trials as u64, Ordering::Relaxed) + trials as u64;
                    if watch(Progress { done, planned }).is_break() {
                        cancelled.store(true, Ordering::Relaxed);
                    }
                }
                wanted()
            };
            Some(Block::run((self.seed, index, self.trials_of(index)), &self.sampler, model, &watch))
        };
        let end = planned.map_or(range.end, |trials| range.end.min(trials.div_ceil(BLOCK_TRIALS as u64)));
        let count = usize::try_from(end.saturating_sub(start)).unwrap_or(usize::MAX);
        #[cfg(feature = "rayon")]
        let blocks: Vec<Option<Block>> = (0..count).into_par_iter().map(one).collect();
        #[cfg(not(feature = "rayon"))]
        let blocks: Vec<Option<Block>> = (0..count).map(one).collect();
        let blocks: Vec<Block> = blocks.into_iter().flatten().collect();
        if self.allowed_failures == 0.0 {
            self.refuse_failures(&blocks)?;
        }
        if cancelled.into_inner() {
            return Err(UncertaintyError::Cancelled { trials: blocks.iter().map(|b| b.trials as u64).sum() });
        }
        let blocks = blocks.into_iter().filter(|block| block.trials > 0).collect();
        Partial::assemble(self.seed, self.fingerprint, blocks)
    }

    fn trials_of(&self, block: u64) -> usize {
        let whole = BLOCK_TRIALS as u64;
        match self.plan {
            Plan::Fixed(trials) => trials.saturating_sub(block.saturating_mul(whole)).min(whole) as usize,
            Plan::Adaptive(_) => BLOCK_TRIALS,
        }
    }

    fn pool(&self, blocks: Vec<Block>) -> Result<OutputSample, UncertaintyError> {
        self.refuse_failures(&blocks)?;
        OutputSample::pool(blocks)
    }

    fn refuse_failures(&self, blocks: &[Block]) -> Result<(), UncertaintyError> {
        let failed: u64 = blocks.iter().map(|block| block.failures.count()).sum();
        let trials: u64 = blocks.iter().map(|block| block.trials as u64).sum();
        let Some(first) = blocks.iter().find_map(|block| block.failures.first().first()) else { return Ok(()) };
        if failed as f64 <= self.allowed_failures * trials as f64 {
            return Ok(());
        }
        // Where the first failure ends the run, its neighbours' counts depend on the threads; its own does not.
        let (failed, trials) = match self.allowed_failures {
            0.0 => (1, first.block * BLOCK_TRIALS as u64 + first.trial as u64 + 1),
            _ => (failed, trials),
        };
        let (first, allowed) = (Box::new(first.clone()), self.allowed_failures);
        Err(UncertaintyError::TooManyFailures { failed, trials, allowed, first })
    }
}

/// The values of some blocks by output.
fn columns(blocks: &[Block]) -> Result<Vec<Vec<f64>>, UncertaintyError> {
    let outputs = blocks.iter().map(|block| block.outputs).find(|&n| n != 0).ok_or(UncertaintyError::NoSuccess)?;
    let column = |output: usize| {
        let values = blocks.iter().flat_map(|block| block.values.iter().skip(output).step_by(outputs));
        values.copied().collect()
    };
    Ok((0..outputs).map(column).collect())
}

fn threads() -> u64 {
    #[cfg(feature = "rayon")]
    return rayon::current_num_threads() as u64;
    #[cfg(not(feature = "rayon"))]
    1
}
