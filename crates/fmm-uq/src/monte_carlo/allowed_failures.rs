//! Allowed number of trials that fail.

use crate::{Failures, UncertaintyError};

/// The share of trials that may fail, in [0, 1); 0 unless set.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct AllowedFailures(f64);

impl AllowedFailures {
    pub(crate) fn new(share: f64) -> Result<Self, UncertaintyError> {
        if (0.0..1.0).contains(&share) {
            Ok(Self(share))
        } else {
            let (option, must_be) = ("allowed share of failed trials", "in [0, 1)");
            Err(UncertaintyError::out_of_range(option, share, must_be))
        }
    }

    /// The share.
    pub(crate) const fn share(self) -> f64 {
        self.0
    }

    /// Whether no trial may fail.
    pub(crate) fn is_none(self) -> bool {
        self.0 == 0.0
    }

    /// Whether so many of the trials may have failed.
    pub(crate) fn allow(self, failed: u64, trials: u64) -> bool {
        failed as f64 <= self.0 * trials as f64
    }

    /// Refuses more failures than these, with the first of them.
    pub(crate) fn check(self, failures: &Failures, trials: u64) -> Result<(), UncertaintyError> {
        match failures.first().first() {
            Some(first) if !self.allow(failures.count(), trials) => {
                let (failed, first) = (failures.count(), Box::new(first.clone()));
                Err(UncertaintyError::TooManyFailures { failed, trials, allowed: self.0, first })
            }
            _ => Ok(()),
        }
    }
}
