//! Impulse of a sampled force, and the pulse of an impact: level, width, further impacts.

use std::ops::Range;

use fmm_model::ModelError;
use fmm_record::{Saturation, noise, saturation};

use crate::channel::{Baseline, Channel};
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
    let offset = offset_of(force, interval, baseline)?;
    Ok(ModelError::require_finite("the impulse", interval * trapezoid(force, offset), "N s")?)
}

/// Offset (N) of a `force` of at least two finite samples, one every `interval` (s).
fn offset_of(force: &[f64], interval: f64, baseline: Baseline) -> Result<f64, FrfError> {
    ModelError::require_positive("the sampling interval", interval, "s")?;
    if force.len() < 2 {
        return Err(FrfError::too_few_samples(force.len()));
    }
    FrfError::require_samples(Channel::Force, force)?;
    baseline.offset_of(force, "N")
}

/// Area under at least two `samples` less their `offset`, in units of the interval, by the trapezoid rule.
fn trapezoid(samples: &[f64], offset: f64) -> f64 {
    let [first, .., last] = samples else { return 0.0 };
    let sum: f64 = samples.iter().map(|sample| sample - offset).sum();
    sum - 0.5 * ((first - offset) + (last - offset))
}

/// The pulse of an impact.
///
/// ```
/// use fmm_frf::{Baseline, Pulse};
///
/// // 1000 N for 2 ms at 10 kHz, and a rebound of 200 N.
/// let half_sine = |i: i32, n: i32| if (0..=n).contains(&i) { (f64::from(i) / f64::from(n) * std::f64::consts::PI).sin() } else { 0.0 };
/// let force: Vec<f64> = (0..400).map(|i| 1000.0 * half_sine(i - 100, 20) + 200.0 * half_sine(i - 250, 20)).collect();
/// let pulse = Pulse::of(&force, 1e-4, Baseline::MeanOf(0..90))?;
/// assert!(pulse.level == 1000.0 && (pulse.time - 0.011).abs() < 1e-12);
/// // A half sine is above half of its peak for two thirds of its duration.
/// assert!((pulse.width - 2e-3 * 2.0 / 3.0).abs() < 2e-5);
/// assert_eq!(pulse.further_hits.len(), 1);
/// assert!(pulse.further_hits[0].level == 200.0 && (pulse.further_hits[0].time - 0.026).abs() < 1e-12);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Pulse {
    /// Force of largest magnitude (N), less the baseline; negative if the sensor counts a push so.
    pub level: f64,
    /// Time of that force (s), counted from the first sample.
    pub time: f64,
    /// Full width at half of the level (s), with straight lines between the samples.
    pub width: f64,
    /// The samples above the threshold, with one below it at either end if there is one; the threshold is the larger of
    /// [`Pulse::THRESHOLD`] of the level and six times the noise.
    pub samples: Range<usize>,
    /// Area (N s) of those samples by the trapezoid rule; samples below the threshold are not in it.
    pub impulse: f64,
    /// Further hits in the same direction, before or after the pulse: places at which the force rises above the
    /// threshold again, as after a hammer that bounced. Such a trial has a force spectrum with holes; it is better
    /// repeated.
    pub further_hits: Vec<Hit>,
    /// Samples of the force cut off at the limits of the converter, if there are any; the impulse is then too small.
    pub overload: Option<Saturation>,
}

/// Another impact beside that of a [`Pulse`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Hit {
    /// Time of the largest force (s), counted from the first sample.
    pub time: f64,
    /// Largest force (N), less the baseline.
    pub level: f64,
}

impl Pulse {
    /// Share of the level at which a pulse begins and ends.
    pub const THRESHOLD: f64 = 0.05;

    /// The pulse in a `force` (N) sampled every `interval` (s).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for the interval, [`FrfError::TooFew`] for fewer
    /// than two samples, [`FrfError::Values`] for samples that are not finite, [`FrfError::Outside`] if the range of
    /// the baseline is empty or leaves the record, [`ModelError::NotFinite`](crate::ModelError::NotFinite) for the
    /// baseline, and [`FrfError::Values`] if nothing rises above the baseline.
    pub fn of(force: &[f64], interval: f64, baseline: Baseline) -> Result<Self, FrfError> {
        let offset = offset_of(force, interval, baseline)?;
        let highest = |range: Range<usize>, direction: f64| {
            let heights = range.map(|i| (i, (force[i] - offset) * direction));
            heights.reduce(|best, next| if next.1 > best.1 { next } else { best })
        };
        let upward = highest(0..force.len(), 1.0).unwrap_or((0, 0.0));
        let downward = highest(0..force.len(), -1.0).unwrap_or((0, 0.0));
        let (direction, (peak, height)) = if upward.1 >= downward.1 { (1.0, upward) } else { (-1.0, downward) };
        if !(height > 0.0 && height.is_finite()) {
            return Err(FrfError::no_force());
        }
        let push = |i: usize| (force[i] - offset) * direction;
        let threshold = (Self::THRESHOLD * height).max(6.0 * noise(force)).min(0.5 * height);

        let (begin, end) = run(&push, force.len(), peak, threshold);
        let mut further_hits = Vec::new();
        let mut i = 0;
        while i < force.len() {
            if push(i) <= threshold {
                i += 1;
                continue;
            }
            let (_, hit_end) = run(&push, force.len(), i, threshold);
            if !(begin..end).contains(&i)
                && let Some((at, level)) = highest(i..hit_end, direction)
            {
                further_hits.push(Hit { time: interval * at as f64, level: level * direction });
            }
            i = hit_end;
        }
        let samples = begin.saturating_sub(1)..(end + 1).min(force.len());
        Ok(Self {
            level: height * direction,
            time: interval * peak as f64,
            width: interval * width(&push, force.len(), peak, 0.5 * height),
            impulse: interval * trapezoid(&force[samples.clone()], offset),
            samples,
            further_hits,
            overload: saturation(force),
        })
    }

    /// Time (s) from the first to the last of [`Pulse::samples`], for samples every `interval` (s).
    pub fn duration(&self, interval: f64) -> f64 {
        interval * (self.samples.len().saturating_sub(1)) as f64
    }
}

/// The samples around `inside` that are above `level`, half open.
fn run(push: &impl Fn(usize) -> f64, length: usize, inside: usize, level: f64) -> (usize, usize) {
    let begin = (0..inside).rev().find(|&i| push(i) <= level).map_or(0, |i| i + 1);
    let end = (inside + 1..length).find(|&i| push(i) <= level).unwrap_or(length);
    (begin, end)
}

/// Width of the pulse at `level`, in intervals, cut off by the ends of the record.
fn width(push: &impl Fn(usize) -> f64, length: usize, peak: usize, level: f64) -> f64 {
    let (begin, end) = run(push, length, peak, level);
    // From a sample above the level towards one that is not, the fraction of the interval that is above.
    let part = |above: usize, below: usize| (push(above) - level) / (push(above) - push(below));
    let before = if begin > 0 { part(begin, begin - 1) } else { 0.0 };
    let after = if end < length { part(end - 1, end) } else { 0.0 };
    (end - 1 - begin) as f64 + before + after
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

    use std::f64::consts::PI;

    fn half_sine(level: f64, begin: usize, intervals: usize, length: usize) -> Vec<f64> {
        let inside = |i: usize| (begin..=begin + intervals).contains(&i);
        let value = |i: usize| (PI * (i - begin) as f64 / intervals as f64).sin();
        (0..length).map(|i| if inside(i) { level * value(i) } else { 0.0 }).collect()
    }

    /// A sensor that counts a push as negative, with an offset and a force that never comes back to it before the end.
    #[test]
    fn direction_and_ends() {
        let force: Vec<f64> = half_sine(-300.0, 2, 10, 9).iter().map(|f| f + 5.0).collect();
        let pulse = Pulse::of(&force, 1e-3, Baseline::Offset(5.0)).unwrap();
        assert_eq!((pulse.level, pulse.time), (-300.0, 0.007));
        assert_eq!(pulse.samples, 2..9);
        assert!(pulse.impulse < 0.0 && pulse.further_hits.is_empty());
        assert!((pulse.duration(1e-3) - 6e-3).abs() < 1e-15);
    }

    #[test]
    fn overload_is_reported() {
        let force: Vec<f64> = half_sine(1000.0, 50, 40, 200).iter().map(|f| f.min(700.0)).collect();
        let overload = Pulse::of(&force, 1e-4, Baseline::Keep).unwrap().overload.expect("cut off at 700 N");
        assert_eq!(overload.upper, Some(700.0));
        assert_eq!(Pulse::of(&half_sine(1000.0, 50, 40, 200), 1e-4, Baseline::Keep).unwrap().overload, None);
    }

    #[test]
    fn impossible_pulses_are_refused() {
        assert_eq!(Pulse::of(&[0.0; 9], 1e-3, Baseline::Keep), Err(FrfError::no_force()));
        assert_eq!(Pulse::of(&[4.0; 9], 1e-3, Baseline::Mean), Err(FrfError::no_force()));
        assert!(Pulse::of(&[], 1e-3, Baseline::Keep).is_err() && Pulse::of(&[1.0, 2.0], 0.0, Baseline::Keep).is_err());
        assert!(matches!(
            Pulse::of(&[1.0, f64::NAN], 1e-3, Baseline::Keep),
            Err(FrfError::Values { what }) if what.starts_with("sample 1 ")
        ));
        assert!(Pulse::of(&[-f64::MAX, f64::MAX], 1e-3, Baseline::Offset(-f64::MAX)).is_err(), "overflow");
    }
}
