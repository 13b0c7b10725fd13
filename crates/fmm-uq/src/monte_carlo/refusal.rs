//! Refusals: too many failed trials, and inputs of which too little is known for a result to have moments.

use crate::error::UncertaintyError;
use crate::failure::Failures;
use crate::inputs::{Input, Inputs};
use crate::monte_carlo::block::BLOCK_TRIALS;

/// The share of trials that may fail, in [0, 1); 0 unless set.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct AllowedFailures(pub(super) f64);

impl AllowedFailures {
    pub(crate) fn new(share: f64) -> Result<Self, UncertaintyError> {
        if (0.0..1.0).contains(&share) {
            Ok(Self(share))
        } else {
            let (option, must_be) = ("allowed share of failed trials", "in [0, 1)");
            Err(UncertaintyError::out_of_range(option, share, must_be))
        }
    }

    /// True if no trial may fail.
    pub(crate) fn is_none(self) -> bool {
        self.0 == 0.0
    }

    /// True if this number of the trials may fail.
    pub(crate) fn allow(self, failed: u64, trials: u64) -> bool {
        failed as f64 <= self.0 * trials as f64
    }

    /// Refuses more failures than these, with the first of them. Where none may fail, the trials end with it: how many
    /// of the others had been taken depends on the threads.
    pub(crate) fn check(self, failures: &Failures, trials: u64) -> Result<(), UncertaintyError> {
        match failures.first().first() {
            Some(first) if !self.allow(failures.count(), trials) => {
                let up_to_first = first.block * BLOCK_TRIALS as u64 + first.trial as u64 + 1;
                let (failed, trials) = if self.is_none() { (1, up_to_first) } else { (failures.count(), trials) };
                Err(UncertaintyError::TooManyFailures {
                    failed,
                    trials,
                    allowed: self.0,
                    first: Box::new(first.clone()),
                })
            }
            _ => Ok(()),
        }
    }
}

/// The t-distributed input of the fewest degrees of freedom, if it has no variance: ν ≤ 2, from two or three
/// observations.
///
/// The sample of its trials has a standard deviation, which is another one with every seed and grows with their number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HeavyTail {
    input: String,
    degrees_of_freedom: f64,
}

impl HeavyTail {
    pub(crate) fn of(inputs: &Inputs) -> Option<Self> {
        let nu = |input: &Input| input.distribution().degrees_of_freedom();
        let fewest = inputs.as_slice().iter().min_by(|a, b| nu(a).total_cmp(&nu(b)))?;
        (nu(fewest) <= 2.0).then(|| Self { input: fewest.name().to_owned(), degrees_of_freedom: nu(fewest) })
    }

    /// Refuses a mean: there is none for ν = 1.
    pub(crate) fn require_mean(this: Option<&Self>) -> Result<(), UncertaintyError> {
        match this {
            Some(tail) if tail.degrees_of_freedom <= 1.0 => Err(tail.none("mean")),
            _ => Ok(()),
        }
    }

    /// Refuses a variance.
    pub(crate) fn require_variance(this: Option<&Self>) -> Result<(), UncertaintyError> {
        this.map_or(Ok(()), |tail| Err(tail.none("standard deviation")))
    }

    /// Error of a figure that is a matter of chance.
    fn none(&self, figure: &str) -> UncertaintyError {
        let Self { input, degrees_of_freedom } = self;
        UncertaintyError::no_answer(format!(
            "Student's t of {degrees_of_freedom} degrees of freedom, which {input} has, has no {figure}, and so has \
             none to state of the result; an interval can be stated"
        ))
    }
}
