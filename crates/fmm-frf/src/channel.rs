//! Channels of a trial, and the baseline of a sensor: its reading when nothing acts on it.

use std::fmt;
use std::ops::Range;

use fmm_model::ModelError;
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

/// Baseline of a sensor when nothing acts on it, and its treatment.
///
/// An offset b of a record of duration T adds b T to the impulse: 0.2 N over 33 s are 6.6 N s, four times the
/// impulse of a hammer. Remove it, or integrate the pulse alone.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub enum Baseline {
    /// The samples are taken as they are.
    #[default]
    Keep,
    /// A known offset, in the unit of the samples, is subtracted from every sample.
    Offset(f64),
    /// The mean of these samples, counted from 0 and free of the pulse, is subtracted from every sample.
    MeanOf(Range<usize>),
    /// The mean of all samples is subtracted, as for excitation that goes on all the time. For an impact it is wrong:
    /// it takes the mean of the pulse away with the offset.
    Mean,
}

impl Baseline {
    /// The offset to subtract from `samples`, whose unit is `unit`.
    pub(crate) fn offset_of(self, samples: &[f64], unit: &'static str) -> Result<f64, FrfError> {
        let mean = |samples: &[f64]| samples.iter().sum::<f64>() / samples.len() as f64;
        let offset = match self {
            Self::Keep => 0.0,
            Self::Offset(offset) => offset,
            Self::MeanOf(range) => {
                let quiet = samples.get(range.clone()).filter(|quiet| !quiet.is_empty());
                let outside = || {
                    let (start, end, length) = (range.start, range.end, samples.len());
                    let what = format!("the baseline needs samples {start} to {end} (excluded)");
                    FrfError::outside(format!("{what}, but the record has {length}, from 0 on"))
                };
                mean(quiet.ok_or_else(outside)?)
            }
            Self::Mean => mean(samples),
        };
        Ok(ModelError::require_finite("the offset of a channel", offset, unit)?)
    }
}
