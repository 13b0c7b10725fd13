//! The impulse of a sampled force.

mod pulse;

pub use pulse::{Hit, Pulse};

use fmm_record::Record;

use crate::{Baseline, Channel, FrfError, ModelError};

/// Interpolation between the samples of a force before its area is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Quadrature {
    /// By straight lines.
    #[default]
    Trapezoid,
    /// By parabolas over pairs of intervals (Simpson's rule); of an odd number of intervals the last three are joined
    /// by a cubic (the 3/8 rule), and a single one by a straight line.
    ///
    /// On a smooth pulse it is far nearer than the trapezoid rule; on white noise it is not, as it weighs neighbouring
    /// samples unequally: its variance is larger by 10/9.
    Simpson,
}

/// Impulse J of a `force` (N) sampled every `interval` (s), by the trapezoid rule (N s).
///
/// ```text
/// J = Δt (f₀/2 + f₁ + … + f_{N−2} + f_{N−1}/2)
/// ```
///
/// The rule joins the samples by straight lines and cuts off what bulges between them. For a half-sine pulse of
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
    impulse_by(Quadrature::Trapezoid, force, interval, baseline)
}

/// Impulse (N s) of a `force` (N) sampled every `interval` (s), by the `rule` named; [`impulse`] is that by the
/// trapezoid rule.
///
/// ```
/// use fmm_frf::{Baseline, Quadrature, impulse_by};
///
/// // A half sine of 100 N and 8 ms over 8 intervals; its exact impulse is 2 · 100 · 0.008/π N s.
/// let force: Vec<f64> = (0..=8).map(|i| 100.0 * (std::f64::consts::PI * f64::from(i) / 8.0).sin()).collect();
/// let exact = 1.6 / std::f64::consts::PI;
/// let error = |rule| impulse_by(rule, &force, 1e-3, Baseline::Keep).map(|found| (found / exact - 1.0).abs());
/// assert!((0.012..0.014).contains(&error(Quadrature::Trapezoid)?));
/// assert!((1e-4..2e-4).contains(&error(Quadrature::Simpson)?));
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # Errors
/// As [`impulse`].
pub fn impulse_by(rule: Quadrature, force: &[f64], interval: f64, baseline: Baseline) -> Result<f64, FrfError> {
    ModelError::require_positive("the sampling interval", interval, "s")?;
    if force.len() < 2 {
        return Err(FrfError::too_few_samples(force.len()));
    }
    FrfError::require_samples(Channel::Force, force)?;
    let offset = baseline.offset_of(force, "N")?;
    let area = match rule {
        Quadrature::Trapezoid => trapezoid(force, offset),
        Quadrature::Simpson => simpson(force, offset),
    };
    Ok(ModelError::require_finite("the impulse", interval * area, "N s")?)
}

/// Area under at least two `samples` less their `offset`, in units of the interval, by the trapezoid rule.
pub(crate) fn trapezoid(samples: &[f64], offset: f64) -> f64 {
    let [first, .., last] = samples else { return 0.0 };
    let sum: f64 = samples.iter().map(|sample| sample - offset).sum();
    sum - 0.5 * ((first - offset) + (last - offset))
}

/// The same by Simpson's rule.
fn simpson(samples: &[f64], offset: f64) -> f64 {
    let at = |i: usize| samples[i] - offset;
    match samples.len() - 1 {
        1 => trapezoid(samples, offset),
        odd if odd % 2 == 1 => {
            let tail = 3.0 / 8.0 * (at(odd - 3) + 3.0 * (at(odd - 2) + at(odd - 1)) + at(odd));
            tail + if odd > 3 { simpson(&samples[..=odd - 3], offset) } else { 0.0 }
        }
        even => {
            let outer = at(0) + at(even);
            let odd: f64 = (1..even).step_by(2).map(at).sum();
            let inner: f64 = (2..even).step_by(2).map(at).sum();
            (outer + 4.0 * odd + 2.0 * inner) / 3.0
        }
    }
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
        assert_eq!(impulse_of_record(&record(&[1.0]), Baseline::Keep), Err(FrfError::too_few_samples(1)));
    }

    #[test]
    fn straight_lines_are_integrated_exactly() {
        assert_eq!(impulse(&[1.0, 3.0], 0.5, Baseline::Keep), Ok(1.0));
        assert_eq!(impulse(&[0.0, 1.0, 2.0, 3.0, 4.0], 2.0, Baseline::Keep), Ok(16.0));
    }

    /// Simpson's rule is exact for cubics, whatever the number of intervals from two on.
    #[test]
    fn parabolas_and_cubics_are_integrated_exactly() {
        for intervals in 2..9 {
            let cubic = |i: i32| f64::from(i * i * i - 4 * i * i + 5);
            let force: Vec<f64> = (0..=intervals).map(cubic).collect();
            let n = f64::from(intervals);
            let exact = n.powi(4) / 4.0 - 4.0 * n.powi(3) / 3.0 + 5.0 * n;
            let found = impulse_by(Quadrature::Simpson, &force, 1.0, Baseline::Keep).unwrap();
            // Ten roundings of numbers up to 500.
            assert!((found - exact).abs() < 1e-12, "{intervals} intervals: {found} N s, not {exact} N s");
        }
        assert_eq!(impulse_by(Quadrature::Simpson, &[1.0, 3.0], 0.5, Baseline::Keep), Ok(1.0));
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
        assert_eq!(error, Err(FrfError::sample_not_finite(Channel::Force, 1, f64::INFINITY)));
        let overflow = impulse(&[f64::MAX, f64::MAX, f64::MAX], 0.1, Baseline::Keep);
        assert!(matches!(overflow, Err(FrfError::OutOfRange(ModelError::NotFinite { .. }))), "{overflow:?}");
    }

    #[test]
    fn impossible_baselines_are_refused() {
        for (start, end) in [(1, 1), (2, 1), (0, 4), (7, 9)] {
            let error = impulse(&[0.0, 1.0, 0.0], 0.1, Baseline::MeanOf(start..end));
            assert_eq!(error, Err(FrfError::baseline_range(start, end, 3)));
        }
        assert!(impulse(&[0.0, 1.0], 0.1, Baseline::Offset(f64::NAN)).is_err());
    }
}
