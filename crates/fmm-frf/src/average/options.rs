//! Options of an average of trials.

use fmm_model::ModelError;

use crate::average::window::{ExponentialWindow, ForceWindow, Taper, Windows};
use crate::baseline::Baseline;
use crate::error::FrfError;

/// Weight of each trial.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Averaging {
    /// All trials alike.
    #[default]
    Linear,
    /// The newest with the weight α and all before it together with 1 − α, so that the average forgets: a trial k
    /// trials ago counts α(1 − α)ᵏ. The first trial counts as if it had always been there. In the long run the average
    /// is worth 2/α − 1 trials.
    Exponential {
        /// α, weight of the newest trial, more than 0 and less than 1.
        newest: f64,
    },
}

impl Averaging {
    /// Factors of what has been added up and of the trial to add.
    pub(crate) fn factors(self, is_first: bool) -> (f64, f64) {
        match self {
            Self::Linear => (1.0, 1.0),
            Self::Exponential { .. } if is_first => (0.0, 1.0),
            Self::Exponential { newest } => (1.0 - newest, newest),
        }
    }
}

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
    pub(crate) windows: Windows,
    pub(crate) force_baseline: Baseline,
    pub(crate) response_baseline: Baseline,
    pub(crate) averaging: Averaging,
    pub(crate) keeps_ratios: bool,
    pub(crate) band: Option<(f64, f64)>,
}

impl AverageOptions {
    /// Weights that fade both channels in and out.
    #[must_use]
    pub fn taper(mut self, taper: Taper) -> Self {
        self.windows.taper = taper;
        self
    }

    /// Weights on the force that leave the pulse alone.
    #[must_use]
    pub fn force_window(mut self, window: ForceWindow) -> Self {
        self.windows.force = Some(window);
        self
    }

    /// A decaying exponential on both channels.
    #[must_use]
    pub fn exponential_window(mut self, window: ExponentialWindow) -> Self {
        self.windows.exponential = Some(window);
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

    /// Sets the weight of each trial.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for an exponential weight outside 0 to 1, both ends
    /// excluded; the error is about the weight or what it leaves.
    pub fn averaging(mut self, averaging: Averaging) -> Result<Self, FrfError> {
        if let Averaging::Exponential { newest } = averaging {
            ModelError::require_positive("the weight of the newest trial", newest, "(dimensionless)")?;
            ModelError::require_positive("the weight of all trials but the newest", 1.0 - newest, "(dimensionless)")?;
        }
        self.averaging = averaging;
        Ok(self)
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
}
