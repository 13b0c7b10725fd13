//! The logarithmic decrement as the thesis' appendix codes it.

use fmm_record::{EndRule, Quantity, Record, moving_average};

use crate::IdentifyError;

/// One cycle of the thesis' logarithmic decrement.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ThesisCycle {
    /// V, the peak with which the cycle begins (unit of the record).
    pub peak_velocity: f64,
    /// c/m = 2ζω₀ (1/s).
    pub damping: f64,
}

/// The logarithmic decrement *as coded* in the thesis' appendix A2, for comparison with it;
/// [`decrements`](crate::decrements) is the one to use.
///
/// ```text
/// δ = ln(p_{i−1}/p_i),   ζ = δ/√(4π² + δ²),   c = 2ζ √(k m)                         (thesis A2)
/// ```
///
/// The record is cut at its largest sample and smoothed by a moving mean (`movmean`, 15 samples). Of its local maxima
/// the first two are dropped, then those that are not positive, then those within 400 samples of the one before. Of
/// a noisy cluster this keeps the first maximum and not the highest, and nothing is interpolated: below 0.03 mm/s of
/// noise the result is good, at 0.5 mm/s many a damping is negative. No uncertainty is stated, as the code has none.
///
/// ```
/// use fmm_identify::ThesisDecrement;
/// use fmm_record::{Quantity, Record};
///
/// // 2 Hz and c/m = 0.05 1/s, 1 kHz.
/// let at = |t: f64| (-0.025 * t).exp() * (4.0 * std::f64::consts::PI * t).cos();
/// let values = (0..8000).map(|i| at(f64::from(i) * 1e-3)).collect();
/// let record = Record::sampled(1000.0, values, Quantity::Velocity, "m/s")?;
///
/// let cycles = ThesisDecrement::default().with_natural_frequency(2.0)?.cycles(&record)?;
/// assert_eq!(cycles.len(), 11);
/// assert!(cycles.iter().all(|cycle| (cycle.damping / 0.05 - 1.0).abs() < 1e-3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ThesisDecrement {
    span: usize,
    dropped: usize,
    gap: usize,
    angular: f64,
}

/// Stiffness (N/m) and mass (kg) in A2; they are not those of the thesis' Table 2.
const A2_STIFFNESS: f64 = 1982.17;
const A2_MASS: f64 = 10.415;

impl Default for ThesisDecrement {
    /// The numbers of A2: 15 samples, 2 maxima, 400 samples, √(1982.17 N/m / 10.415 kg).
    fn default() -> Self {
        Self { span: 15, dropped: 2, gap: 400, angular: (A2_STIFFNESS / A2_MASS).sqrt() }
    }
}

impl ThesisDecrement {
    /// Samples of the moving mean; odd.
    #[must_use]
    pub fn with_span(mut self, span: usize) -> Self {
        self.span = span;
        self
    }

    /// Smallest distance of two maxima (samples); a little less than a period.
    #[must_use]
    pub fn with_gap(mut self, samples: usize) -> Self {
        self.gap = samples;
        self
    }

    /// f₀ (Hz), from which c/m = 2ζω₀ follows.
    ///
    /// # Errors
    /// [`ModelError`](fmm_model::ModelError) if it is not positive.
    pub fn with_natural_frequency(mut self, frequency: f64) -> Result<Self, fmm_model::ModelError> {
        let frequency = fmm_model::ModelError::require_positive("natural frequency", frequency, "Hz")?;
        self.angular = 2.0 * std::f64::consts::PI * frequency;
        Ok(self)
    }

    /// The cycles of a velocity record without offset.
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] unless it is a velocity, [`IdentifyError::TooFew`] if fewer than two
    /// maxima are left, [`IdentifyError::Record`] if the span is even.
    pub fn cycles(&self, record: &Record) -> Result<Vec<ThesisCycle>, IdentifyError> {
        let quantity = record.quantity();
        if quantity != Quantity::Velocity {
            return Err(IdentifyError::velocity_needed("the thesis' logarithmic decrement", quantity));
        }
        let values = record.values();
        // MATLAB's `find(v == max(v))` gives the first of equal maxima.
        let first = values.iter().enumerate().fold(0, |best, (i, value)| if *value > values[best] { i } else { best });
        let smooth = moving_average(&values[first..], self.span, EndRule::Truncated)?;
        let maxima = local_maxima(&smooth).into_iter().skip(self.dropped).filter(|index| smooth[*index] > 0.0);
        let mut previous: Option<usize> = None;
        let peaks: Vec<f64> = maxima
            // The gap is to the maximum before, kept or not; the first has none before it and is left out.
            .filter(|index| previous.replace(*index).is_some_and(|before| index - before > self.gap))
            .map(|index| smooth[index])
            .collect();
        if peaks.len() < 2 {
            return Err(IdentifyError::too_few_half_swings(2 * peaks.len(), 4));
        }
        let cycle = |pair: &[f64]| {
            let decrement = (pair[0] / pair[1]).ln();
            let ratio = decrement / (2.0 * std::f64::consts::PI).hypot(decrement);
            ThesisCycle { peak_velocity: pair[0], damping: 2.0 * ratio * self.angular }
        };
        Ok(peaks.windows(2).map(cycle).collect())
    }
}

/// Indices of the local maxima as MATLAB's `findpeaks` gives them: larger than both neighbours, the first sample of a
/// plateau, no end.
fn local_maxima(values: &[f64]) -> Vec<usize> {
    let mut maxima = Vec::new();
    let mut rise = None;
    for (i, pair) in values.windows(2).enumerate() {
        if pair[1] > pair[0] {
            rise = Some(i + 1);
        } else if pair[1] < pair[0] {
            maxima.extend(rise.take());
        }
    }
    maxima
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plateaus_count_once_and_ends_never() {
        assert_eq!(local_maxima(&[3.0, 1.0, 2.0, 2.0, 1.0, 4.0, 0.0, 5.0]), [2, 5]);
        assert_eq!(local_maxima(&[0.0, 1.0, 1.0, 2.0, 1.0]), [3]);
        assert_eq!(local_maxima(&[]), Vec::<usize>::new());
    }

    #[test]
    fn what_it_cannot_take_is_refused() {
        let decrement = ThesisDecrement::default();
        let record = |quantity| Record::sampled(1000.0, vec![1.0; 100], quantity, "m").unwrap();
        let wrong = decrement.cycles(&record(Quantity::Displacement));
        assert!(matches!(wrong, Err(IdentifyError::WrongRecord { what }) if what.contains("displacement")));
        let still = decrement.cycles(&record(Quantity::Velocity));
        assert!(matches!(still, Err(IdentifyError::TooFew { found: 0, .. })));
        assert!(matches!(decrement.with_span(4).cycles(&record(Quantity::Velocity)), Err(IdentifyError::Record(_))));
        assert!(decrement.with_natural_frequency(0.0).is_err());
    }
}
