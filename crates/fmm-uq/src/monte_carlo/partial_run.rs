//! A part of a Monte Carlo run, made anywhere.

use crate::error::UncertaintyError;
use crate::monte_carlo::block::{BLOCK_TRIALS, Block};

/// The results of some blocks of a run, in the order of the blocks.
///
/// Parts come from [`MonteCarlo::run_blocks`](crate::MonteCarlo::run_blocks), on any machine and in any order, and are
/// [merged](PartialRun::merge) until [`MonteCarlo::finish`](crate::MonteCarlo::finish) has them all. The result has the
/// bits of a single run. With the feature `serde` a part can be written to a file; its values travel as bits.
///
/// ```
/// # #[cfg(feature = "serde")]
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use fmm_uq::{Input, Inputs, MonteCarlo, PartialRun};
///
/// let inputs = Inputs::new([Input::new("x", 1.0, 0.1, "m")?])?;
/// let run = MonteCarlo::new(&inputs, 5000)?.with_seed(7);
/// // One job for each part, anywhere, which writes the text into its file.
/// let job = |part| -> Result<String, Box<dyn std::error::Error>> {
///     Ok(serde_json::to_string(&run.run_blocks(run.shard(part, 2), |x| x[0] * x[0])?)?)
/// };
/// let files = [job(1)?, job(0)?];
///
/// let mut parts = files.iter().map(|text| serde_json::from_str::<PartialRun>(text));
/// let merged = parts.next().unwrap()?.merge(parts.next().unwrap()?)?;
/// assert_eq!(run.finish(merged)?, run.run(|x| x[0] * x[0])?);
/// # Ok(())
/// # }
/// # #[cfg(not(feature = "serde"))]
/// # fn main() {}
/// ```
///
/// Bits are the same for the same build on the same kind of machine: functions such as the logarithm differ in the last
/// bit between platforms.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "unchecked::PartialRun"))]
pub struct PartialRun {
    seed: u64,
    inputs: u64,
    blocks: Vec<Block>,
}

#[cfg(feature = "serde")]
mod unchecked {
    //! A part as it stands in a file.

    use crate::error::UncertaintyError;
    use crate::monte_carlo::block::Block;

    #[derive(serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    pub(super) struct PartialRun {
        seed: u64,
        inputs: u64,
        blocks: Vec<Block>,
    }

    impl TryFrom<PartialRun> for super::PartialRun {
        type Error = UncertaintyError;

        fn try_from(read: PartialRun) -> Result<Self, UncertaintyError> {
            for block in &read.blocks {
                super::check(block)?;
            }
            Self::assemble(read.seed, read.inputs, read.blocks)
        }
    }
}

impl PartialRun {
    /// Puts blocks in order and sees that they belong together.
    pub(crate) fn assemble(seed: u64, inputs: u64, mut blocks: Vec<Block>) -> Result<Self, UncertaintyError> {
        blocks.sort_by_key(|block| block.index);
        if let Some(pair) = blocks.windows(2).find(|pair| pair[0].index == pair[1].index) {
            let block = pair[0].index;
            let what = format!("block {block} is in both partial results; a shard must not be counted twice");
            return Err(UncertaintyError::part(what, block));
        }
        let mut outputs = blocks.iter().map(|block| block.outputs as u64).filter(|&n| n != 0);
        let first = outputs.next().unwrap_or(0);
        if let Some(second) = outputs.find(|&n| n != first) {
            return Err(mismatch("numbers of outputs", first, second));
        }
        Ok(Self { seed, inputs, blocks })
    }

    /// Both parts as one; the order does not matter.
    ///
    /// # Errors
    /// [`UncertaintyError::PartialRun`] if seed, inputs or number of outputs differ, or a block is in both.
    pub fn merge(mut self, other: Self) -> Result<Self, UncertaintyError> {
        self.require(other.seed, other.inputs)?;
        self.blocks.extend(other.blocks);
        Self::assemble(self.seed, self.inputs, self.blocks)
    }

    /// Number of trials made, failed ones included.
    pub fn trials(&self) -> u64 {
        self.blocks.iter().map(|block| block.trials as u64).sum()
    }

    /// Indices of the blocks that are here, ascending.
    pub fn blocks(&self) -> impl Iterator<Item = u64> {
        self.blocks.iter().map(|block| block.index)
    }

    /// Refuses another seed or other inputs, by their fingerprint.
    pub(crate) fn require(&self, seed: u64, inputs: u64) -> Result<(), UncertaintyError> {
        if self.seed != seed {
            return Err(mismatch("seeds", self.seed, seed));
        }
        if self.inputs != inputs {
            return Err(mismatch("inputs (by fingerprint)", self.inputs, inputs));
        }
        Ok(())
    }

    pub(crate) fn into_blocks(self) -> Vec<Block> {
        self.blocks
    }
}

/// Refuses a block that no run can have given.
#[cfg_attr(not(feature = "serde"), allow(dead_code, reason = "only files can be damaged"))]
fn check(block: &Block) -> Result<(), UncertaintyError> {
    let failed = block.failures.by_kind().iter().try_fold(0_u64, |sum, (_, count)| sum.checked_add(*count));
    let succeeded = failed.and_then(|failed| (block.trials as u64).checked_sub(failed));
    let expected = succeeded.and_then(|count| usize::try_from(count).ok()?.checked_mul(block.outputs));
    let what = if block.trials == 0 || block.trials > BLOCK_TRIALS {
        "its number of trials"
    } else if expected != Some(block.values.len()) {
        "its number of values"
    } else if succeeded != Some(0) && block.outputs == 0 {
        "its number of outputs"
    } else if block.values.iter().any(|value| !value.is_finite()) {
        "a value that is not finite"
    } else {
        return Ok(());
    };
    let block = block.index;
    Err(UncertaintyError::part(format!("block {block} of the partial result is damaged: {what}"), block))
}

/// Error of parts of different runs.
fn mismatch(what: &str, first: u64, second: u64) -> UncertaintyError {
    let but = format!("but one has {first} and another {second}");
    UncertaintyError::part(format!("partial results belong together only if their {what} agree, {but}"), None)
}
