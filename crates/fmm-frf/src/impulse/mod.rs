//! The impulse of a sampled force.

mod pulse;

pub use pulse::{Hit, Pulse};

use fmm_model::ModelError;

use crate::baseline::Baseline;
use crate::channel::Channel;
use crate::error::FrfError;

/// Impulse J of a `force` (N) sampled every `interval` (s), by the trapezoid rule (N s).
///
/// ```text
/// J = Δt (f₀/2 + f₁ + … + f_{N−2} + f_{N−1}/2)
/// ```
///
/// The rule joins the samples by straight lines and cuts off the bulges between them. For a half-sine pulse of
/// peak F₀ and duration τ over n = τ/Δt intervals, with a sample at its start, the sum has a closed form:
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
/// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for the interval, [`FrfError::TooFew`] for fewer than
/// two samples, [`FrfError::Values`] for samples that are not finite, [`FrfError::Outside`] if the range of the
/// baseline is empty or leaves the record, and [`ModelError::NotFinite`](crate::ModelError::NotFinite) for the offset
/// or for a sum that overflows.
pub fn impulse(force: &[f64], interval: f64, baseline: Baseline) -> Result<f64, FrfError> {
    ModelError::require_positive("the sampling interval", interval, "s")?;
    if force.len() < 2 {
        return Err(FrfError::too_few_samples(force.len()));
    }
    FrfError::require_samples(Channel::Force, force)?;
    let offset = baseline.offset_of(force, "N")?;
    Ok(ModelError::require_finite("the impulse", interval * trapezoid(force, offset), "N s")?)
}

/// Area under at least two `samples` less their `offset`, in units of the interval, by the trapezoid rule.
pub(crate) fn trapezoid(samples: &[f64], offset: f64) -> f64 {
    let [first, .., last] = samples else { return 0.0 };
    let sum: f64 = samples.iter().map(|sample| sample - offset).sum();
    sum - 0.5 * ((first - offset) + (last - offset))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(impulse(&[1.0], 0.1, Baseline::Keep), Err(FrfError::too_few_samples(1)));
        let error = impulse(&[0.0, f64::INFINITY, 1.0], 0.1, Baseline::Keep);
        assert!(matches!(error, Err(FrfError::Values { what }) if what.starts_with("sample 1 of the force")));
        let overflow = impulse(&[f64::MAX, f64::MAX, f64::MAX], 0.1, Baseline::Keep);
        assert!(matches!(overflow, Err(FrfError::OutOfRange(ModelError::NotFinite { .. }))), "{overflow:?}");
    }

    #[test]
    fn impossible_baselines_are_refused() {
        for (start, end) in [(1, 1), (2, 1), (0, 4), (7, 9)] {
            let error = impulse(&[0.0, 1.0, 0.0], 0.1, Baseline::MeanOf(start..end));
            assert!(matches!(error, Err(FrfError::Outside { .. })), "{start} to {end}: {error:?}");
        }
        assert!(impulse(&[0.0, 1.0], 0.1, Baseline::Offset(f64::NAN)).is_err());
    }
}
