//! Trials that gave no result.

use std::fmt;

/// Failures that a block keeps one by one; the rest are only counted.
const KEPT_PER_BLOCK: usize = 16;
/// Messages that are counted separately: a model that words each failure differently must not fill the memory.
const KINDS: usize = 32;

/// Reason why a trial gave no result.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum FailureKind {
    /// The model gave back an error, with this message.
    Error(String),
    /// An output was infinite or no number.
    NotFinite {
        /// Position of the first such output.
        output: usize,
    },
    /// The model gave another number of outputs than before, or none at all.
    OutputCount {
        /// Number of outputs that it gave.
        found: usize,
    },
    /// Any of the kinds beyond the first 32.
    Other,
}

impl fmt::Display for FailureKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Error(message) => f.write_str(message),
            Self::NotFinite { output } => write!(f, "output {output} is not finite"),
            Self::OutputCount { found: 0 } => f.write_str("the model gave no output"),
            Self::OutputCount { found } => write!(f, "the number of outputs changed to {found}"),
            Self::Other => f.write_str("other failures"),
        }
    }
}

/// One failed trial; [`MonteCarlo::trial_inputs`](crate::MonteCarlo::trial_inputs) gives the values of the inputs that
/// the model failed for.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Failure {
    /// Index of the block, which is the stream of the generator.
    pub block: u64,
    /// Index of the trial in the block.
    pub trial: usize,
    /// Reason.
    pub kind: FailureKind,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (block {}, trial {})", self.kind, self.block, self.trial)
    }
}

/// Failures by kind, and the first of them one by one.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Failures {
    counts: Vec<(FailureKind, u64)>,
    kept: Vec<Failure>,
}

impl Failures {
    /// Number of failed trials.
    pub fn count(&self) -> u64 {
        self.counts.iter().map(|(_, count)| count).sum()
    }

    /// Number of failed trials of each kind, in the order in which the kinds first appeared.
    pub fn by_kind(&self) -> &[(FailureKind, u64)] {
        &self.counts
    }

    /// The first failures one by one, at most 16 of a block.
    pub fn first(&self) -> &[Failure] {
        &self.kept
    }

    pub(crate) fn add(&mut self, failure: Failure) {
        self.count_kind(&failure.kind, 1);
        if self.kept.len() < KEPT_PER_BLOCK {
            self.kept.push(failure);
        }
    }

    /// Appends those of a later block.
    pub(crate) fn append(&mut self, later: &Self) {
        for (kind, count) in &later.counts {
            self.count_kind(kind, *count);
        }
        self.kept.extend_from_slice(&later.kept);
    }

    fn count_kind(&mut self, kind: &FailureKind, count: u64) {
        let place = |kind: &FailureKind| self.counts.iter().position(|(known, _)| known == kind);
        let is_lumped = place(kind).is_none() && self.counts.len() >= KINDS;
        let kind = if is_lumped { &FailureKind::Other } else { kind };
        match place(kind) {
            Some(known) => self.counts[known].1 += count,
            None => self.counts.push((kind.clone(), count)),
        }
    }
}
