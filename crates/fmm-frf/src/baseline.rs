//! Baseline: the reading of a sensor when nothing acts on it.

use std::ops::Range;

use fmm_model::ModelError;

use crate::error::FrfError;

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
