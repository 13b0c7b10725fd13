//! Options of an average of trials.

use crate::average::window::{ExponentialWindow, ForceWindow, Taper};
use crate::channel::Baseline;
use crate::error::FrfError;

/// Treatment of the trials of a [`TrialAverage`](crate::TrialAverage); the default takes them as they are.
///
/// ```
/// use fmm_frf::{AverageOptions, Baseline, ForceWindow, ResponseForm, TrialAverage};
///
/// // 33 s at 10 kHz with an impact between 10 ms and 20 ms; only 0.5 Hz to 20 Hz is of interest.
/// let options = AverageOptions::default()
///     .force_baseline(Baseline::MeanOf(0..90))
///     .force_window(ForceWindow::new(0.009, 0.020)?)
///     .within(0.5, 20.0)?;
/// let average = TrialAverage::new(ResponseForm::Mobility, 10_000.0, 330_000, &options)?;
/// assert_eq!(average.frequencies().len(), 644);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct AverageOptions {
    taper: Taper,
    force_window: Option<ForceWindow>,
    exponential_window: Option<ExponentialWindow>,
    pub(crate) force_baseline: Baseline,
    pub(crate) response_baseline: Baseline,
    pub(crate) keeps_ratios: bool,
    pub(crate) band: Option<(f64, f64)>,
}

impl AverageOptions {
    /// Weights that fade both channels in and out.
    #[must_use]
    pub fn taper(mut self, taper: Taper) -> Self {
        self.taper = taper;
        self
    }

    /// Weights on the force that leave the pulse alone.
    #[must_use]
    pub fn force_window(mut self, window: ForceWindow) -> Self {
        self.force_window = Some(window);
        self
    }

    /// A decaying exponential on both channels.
    #[must_use]
    pub fn exponential_window(mut self, window: ExponentialWindow) -> Self {
        self.exponential_window = Some(window);
        self
    }

    /// Sets the baseline that is subtracted from the force, before any window.
    #[must_use]
    pub fn force_baseline(mut self, baseline: Baseline) -> Self {
        self.force_baseline = baseline;
        self
    }

    /// Sets the baseline that is subtracted from the response, before any window.
    #[must_use]
    pub fn response_baseline(mut self, baseline: Baseline) -> Self {
        self.response_baseline = baseline;
        self
    }

    /// Keeps the ratio of the spectra of each trial, for [`Estimator::MeanOfRatios`](crate::Estimator::MeanOfRatios);
    /// it costs memory and time that the other estimators do not need.
    #[must_use]
    pub fn keeping_ratios(mut self) -> Self {
        self.keeps_ratios = true;
        self
    }

    /// Averages only the lines from `low` to `high` (Hz), both ends included; less memory, and no trouble with lines at
    /// which there is no force.
    ///
    /// # Errors
    /// [`FrfError::Outside`] if no frequency lies there.
    pub fn within(mut self, low: f64, high: f64) -> Result<Self, FrfError> {
        if !(low <= high && high >= 0.0) {
            return Err(FrfError::empty_band(low, high));
        }
        self.band = Some((low, high));
        Ok(self)
    }

    /// σ, decay rate (1/s) of the exponential window; 0 without one.
    pub(super) fn decay_rate(&self) -> f64 {
        self.exponential_window.map_or(0.0, |window| window.decay_rate())
    }

    /// Weights of the response for `length` samples every `interval` (s); `None` if all are one.
    pub(super) fn response_weights(&self, length: usize, interval: f64) -> Option<Vec<f64>> {
        if self.taper == Taper::Rectangular && self.exponential_window.is_none() {
            return None;
        }
        let decay_rate = self.decay_rate();
        let weight = |i| self.taper.weight(i, length) * (-decay_rate * interval * i as f64).exp();
        Some((0..length).map(weight).collect())
    }

    /// Weights of the force; `None` if all are one.
    ///
    /// # Errors
    /// [`FrfError::Outside`] if none but zero is left.
    pub(super) fn force_weights(&self, length: usize, interval: f64) -> Result<Option<Vec<f64>>, FrfError> {
        let Some(window) = self.force_window else { return Ok(self.response_weights(length, interval)) };
        let mut weights = self.response_weights(length, interval).unwrap_or_else(|| vec![1.0; length]);
        let is_outside = |i: &usize| !window.contains(interval * *i as f64, interval);
        (0..length).filter(is_outside).for_each(|i| weights[i] = 0.0);
        if weights.iter().any(|weight| *weight > 0.0) {
            return Ok(Some(weights));
        }
        let (from, to, duration) = (window.from, window.to, interval * length as f64);
        let what = format!("the force window from {from} s to {to} s covers no sample");
        Err(FrfError::outside(format!("{what} of a record of {duration} s")))
    }
}
