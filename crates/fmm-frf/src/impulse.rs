//! The impulse of a sampled force.

use std::ops::Range;

use fmm_record::Record;

use crate::FrfError;

/// What a force sensor shows when no force acts, and what is to be done about it.
///
/// An offset b of a record of duration T adds b T to the impulse: 0.2 N over 33 s are 6.6 N s, four times the
/// impulse of a hammer blow. Remove it, or integrate the pulse alone.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub enum Baseline {
    /// The force is taken as it is.
    #[default]
    Keep,
    /// A known offset (N) is subtracted from every sample.
    Offset(f64),
    /// The mean of these samples, counted from 0 and free of the pulse, is subtracted from every sample.
    MeanOf(Range<usize>),
}

/// Impulse J of a `force` (N) sampled every `interval` (s), by the trapezoid rule (N s).
///
/// ```text
/// J = Δt (f₀/2 + f₁ + … + f_{N−2} + f_{N−1}/2)
/// ```
///
/// The rule joins the samples by straight lines and cuts off what bulges between them. For a half-sine pulse of
/// peak F₀ and duration τ over n = τ/Δt intervals, with a sample at its begin, the sum has a closed form:
///
/// ```text
/// J = F₀ Δt cot(π/2n)   against the exact   2 F₀ τ/π;   relative error   (π/2n) cot(π/2n) − 1 ≈ −π²/(12 n²)
/// ```
///
/// | n | 2 | 4 | 18 | 22 | 34 |
/// |---|---|---|---|---|---|
/// | error | −21.5 % | −5.2 % | −0.25 % | −0.17 % | −0.07 % |
///
/// It is still the right rule for a simulation that joins the samples by straight lines itself.
///
/// ```
/// use fmm_frf::{Baseline, impulse};
///
/// // A triangular pulse of 100 N over 4 ms on an offset of 0.2 N.
/// let force = [0.2, 0.2, 0.2, 50.2, 100.2, 50.2, 0.2, 0.2];
/// let pulse = impulse(&force, 0.001, Baseline::MeanOf(0..3))?;
/// assert!((pulse - 0.2).abs() < 1e-15);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # Errors
/// [`FrfError::NotPositive`] for the interval, [`FrfError::TooFewSamples`], [`FrfError::SampleNotFinite`],
/// [`FrfError::BaselineRange`] if the range is empty or leaves the record, and [`FrfError::NotFinite`] for the
/// offset or for a sum that overflows.
pub fn impulse(force: &[f64], interval: f64, baseline: Baseline) -> Result<f64, FrfError> {
    FrfError::require_positive("the sampling interval", interval, "s")?;
    let [first, .., last] = force else {
        return Err(FrfError::TooFewSamples { found: force.len() });
    };
    if let Some((index, &value)) = force.iter().enumerate().find(|(_, sample)| !sample.is_finite()) {
        return Err(FrfError::SampleNotFinite { index, value });
    }
    let offset = match baseline {
        Baseline::Keep => 0.0,
        Baseline::Offset(offset) => offset,
        Baseline::MeanOf(range) => {
            let outside = FrfError::BaselineRange { start: range.start, end: range.end, length: force.len() };
            let quiet = force.get(range).filter(|quiet| !quiet.is_empty()).ok_or(outside)?;
            quiet.iter().sum::<f64>() / quiet.len() as f64
        }
    };
    FrfError::require_finite("the offset of the force", offset, "N")?;
    let sum: f64 = force.iter().map(|sample| sample - offset).sum();
    let ends = 0.5 * ((first - offset) + (last - offset));
    FrfError::require_finite("the impulse", interval * (sum - ends), "N s")
}

/// Impulse (N s) of a recorded `force`, whose samples must be in N: [`impulse`] of its values and its interval.
///
/// # Errors
/// As [`impulse`]; a record of a single sample is too short.
pub fn impulse_of_record(force: &Record, baseline: Baseline) -> Result<f64, FrfError> {
    impulse(force.values(), force.interval(), baseline)
}

#[cfg(test)]
mod tests {
    use fmm_record::Quantity;

    use super::*;

    #[test]
    fn a_record_brings_its_interval() {
        let record = |values: &[f64]| Record::new(5.0, 0.5, values.to_vec(), Quantity::Force, "N").unwrap();
        assert_eq!(impulse_of_record(&record(&[1.0, 3.0]), Baseline::Keep), Ok(1.0));
        assert_eq!(impulse_of_record(&record(&[1.0]), Baseline::Keep), Err(FrfError::TooFewSamples { found: 1 }));
    }

    #[test]
    fn straight_lines_are_integrated_exactly() {
        assert_eq!(impulse(&[1.0, 3.0], 0.5, Baseline::Keep), Ok(1.0));
        assert_eq!(impulse(&[0.0, 1.0, 2.0, 3.0, 4.0], 2.0, Baseline::Keep), Ok(16.0));
    }

    #[test]
    fn both_ways_to_remove_an_offset_agree() {
        let force = [-0.25, -0.25, 7.75, 3.75, -0.25];
        // 8 + 4 newtons for 0.125 s each; all numbers are binary fractions.
        assert_eq!(impulse(&force, 0.125, Baseline::Offset(-0.25)), Ok(1.5));
        assert_eq!(impulse(&force, 0.125, Baseline::MeanOf(0..2)), Ok(1.5));
        assert_eq!(impulse(&force, 0.125, Baseline::Keep), Ok(1.375));
    }

    #[test]
    fn impossible_records_are_refused() {
        for interval in [0.0, -1e-4, f64::NAN, f64::INFINITY] {
            assert!(impulse(&[0.0, 1.0], interval, Baseline::Keep).is_err(), "{interval} s");
        }
        assert_eq!(impulse(&[1.0], 0.1, Baseline::Keep), Err(FrfError::TooFewSamples { found: 1 }));
        let error = impulse(&[0.0, f64::INFINITY, 1.0], 0.1, Baseline::Keep);
        assert_eq!(error, Err(FrfError::SampleNotFinite { index: 1, value: f64::INFINITY }));
        let overflow = impulse(&[f64::MAX, f64::MAX, f64::MAX], 0.1, Baseline::Keep);
        assert!(matches!(overflow, Err(FrfError::NotFinite { .. })), "{overflow:?}");
    }

    #[test]
    fn impossible_baselines_are_refused() {
        for (start, end) in [(1, 1), (2, 1), (0, 4), (7, 9)] {
            let error = impulse(&[0.0, 1.0, 0.0], 0.1, Baseline::MeanOf(start..end));
            assert_eq!(error, Err(FrfError::BaselineRange { start, end, length: 3 }));
        }
        assert!(impulse(&[0.0, 1.0], 0.1, Baseline::Offset(f64::NAN)).is_err());
    }
}
