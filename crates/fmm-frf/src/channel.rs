//! The two channels of a trial.

use std::fmt;

use fmm_record::{Quantity, Record};

use crate::error::FrfError;

/// Channel of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Excitation (N).
    Force,
    /// Response: displacement, velocity or acceleration.
    Response,
}

impl Channel {
    /// Refuses a `record` of another `quantity`, or whose rate differs by more than 1e-6 from `rate` (Hz): rates are
    /// often read from time stamps of six digits.
    ///
    /// # Errors
    /// [`FrfError::Mismatch`] in both cases.
    pub fn require(self, record: &Record, quantity: Quantity, rate: f64) -> Result<(), FrfError> {
        let found = record.quantity();
        if found != quantity {
            let what = format!("the {self} must be a record of {quantity}, but is one of {found}");
            return Err(FrfError::mismatch(what));
        }
        let found = record.rate();
        if !((found / rate - 1.0).abs() <= 1e-6) {
            let what = format!("the {self} was sampled at {found} Hz, but must be at {rate} Hz");
            return Err(FrfError::mismatch(what));
        }
        Ok(())
    }

    /// Refuses a `force` and a `response` of different numbers of samples, or that do not begin within 1e-3 of an
    /// interval of each other.
    ///
    /// # Errors
    /// [`FrfError::Mismatch`] in both cases.
    pub fn require_together(force: &Record, response: &Record) -> Result<(), FrfError> {
        if force.len() != response.len() {
            return Err(FrfError::sample_count(Self::Response, force.len(), response.len()));
        }
        let [from, to] = [force, response].map(Record::start);
        if !((from - to).abs() * response.rate() <= 1e-3) {
            let what = format!(
                "force and response must begin together, but begin at {from} s and {to} s; crop them to the same beginning"
            );
            return Err(FrfError::mismatch(what));
        }
        Ok(())
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Force => "force",
            Self::Response => "response",
        })
    }
}
