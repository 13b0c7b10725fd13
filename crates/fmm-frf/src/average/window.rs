//! Weights on the samples of a trial before it is transformed.

use std::f64::consts::TAU;

use fmm_model::ModelError;

use crate::error::FrfError;

/// Weights that fade both channels of a trial in and out alike, for excitation that goes on all the time.
///
/// An impact that has died out within the record needs none, and one that begins in a taper is spoilt by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Taper {
    /// No weights.
    #[default]
    Rectangular,
    /// Hann, periodic: w_i = (1 − cos(2π i/N))/2. The window of spectral estimates (SciPy's default).
    Hann,
    /// Hann, symmetric: w_i = (1 − cos(2π i/(N − 1)))/2. The window of filter design (numpy's `hanning`); at single
    /// lines it changes H1 by up to 2 % against the periodic one.
    SymmetricHann,
}

impl Taper {
    /// The weight of sample `index` of `length`.
    pub(super) fn weight(self, index: usize, length: usize) -> f64 {
        let hann = |period: usize| 0.5 * (1.0 - (TAU * index as f64 / period.max(1) as f64).cos());
        match self {
            Self::Rectangular => 1.0,
            Self::Hann => hann(length),
            Self::SymmetricHann => hann(length.saturating_sub(1)),
        }
    }
}

/// Weights on the force alone: one during the pulse and zero elsewhere.
///
/// Between pulses the force channel has nothing but noise, and all of it goes into the spectrum: 0.5 N rms over
/// 330 000 samples at 10 kHz make 2 % of an impact of 1.42 N s, at every line; 10 ms of it make 0.035 %. Take the
/// offset out first, with [`AverageOptions::force_baseline`](crate::AverageOptions::force_baseline): the window turns
/// it into a pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceWindow {
    pub(super) from: f64,
    pub(super) to: f64,
}

impl ForceWindow {
    /// A window that keeps the force from `from` (s) until before `to` (s), counted from the first sample.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`](crate::ModelError::NotFinite) for `from`, and
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for a duration that is not positive and finite.
    pub fn new(from: f64, to: f64) -> Result<Self, FrfError> {
        ModelError::require_finite("the start of the force window", from, "s")?;
        ModelError::require_positive("the duration of the force window", to - from, "s")?;
        Ok(Self { from, to })
    }

    /// True for a sample at `time` (s), which rounding of 1e-6 of an `interval` (s) must not change.
    pub(super) fn contains(&self, time: f64, interval: f64) -> bool {
        (self.from..self.to).contains(&(time + 1e-6 * interval))
    }
}

/// A decaying exponential on both channels, which makes a response that outlasts the record end in it.
///
/// ```text
/// w(t) = e^{−σt}:   H(iω) becomes H(σ + iω)                                                          (1)
/// ```
///
/// Its effect on a transform is that of damping 2mσ and stiffness cσ + mσ² more in the machine. The shift is exact, so
/// it is taken out again exactly: a [`FrequencyResponse`](crate::FrequencyResponse) remembers σ, conversions between
/// forms multiply by σ + iω, and the modal estimates give the poles of the machine without window.
///
/// No factor is applied to the ratio of two windowed channels: a factor N/Σw as for one spectrum would be wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExponentialWindow {
    decay_rate: f64,
}

impl ExponentialWindow {
    /// The window of `decay_rate` σ (1/s).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) unless the rate is positive and finite.
    pub fn new(decay_rate: f64) -> Result<Self, FrfError> {
        ModelError::require_positive("the decay rate of a window", decay_rate, "1/s")?;
        Ok(Self { decay_rate })
    }

    /// The window that has fallen to `fraction` (between 0 and 1) after `duration` (s): σ = −ln(fraction)/duration.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for the duration or the decay rate that follows.
    pub fn reaching(fraction: f64, duration: f64) -> Result<Self, FrfError> {
        ModelError::require_positive("the duration of a window", duration, "s")?;
        Self::new(-fraction.ln() / duration)
    }

    /// σ (1/s).
    pub fn decay_rate(&self) -> f64 {
        self.decay_rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::average::options::AverageOptions;

    #[test]
    fn hann_windows_follow_their_conventions() {
        let weights = |taper: Taper, length: usize| (0..length).map(|i| taper.weight(i, length)).collect::<Vec<_>>();
        let (periodic, symmetric) = (weights(Taper::Hann, 4), weights(Taper::SymmetricHann, 5));
        // π is rounded, so that its cosine is off by one rounding where it is steepest.
        for (found, expected) in periodic.iter().zip([0.0, 0.5, 1.0, 0.5]) {
            assert!((found - expected).abs() < 2e-16, "{periodic:?}");
        }
        for (found, expected) in symmetric.iter().zip([0.0, 0.5, 1.0, 0.5, 0.0]) {
            assert!((found - expected).abs() < 2e-16, "{symmetric:?}");
        }
        assert!(weights(Taper::SymmetricHann, 1)[0].is_finite());
    }

    #[test]
    fn a_force_window_keeps_the_pulse() {
        let window = ForceWindow::new(0.01, 0.02).unwrap();
        let windows = AverageOptions::default().force_window(window);
        let weights = windows.force_weights(400, 1e-4).unwrap().unwrap();
        // The samples 100 to 199, though neither end is a binary fraction.
        assert_eq!(weights.iter().sum::<f64>(), 100.0);
        assert_eq!((weights[99], weights[100], weights[199], weights[200]), (0.0, 1.0, 1.0, 0.0));
        let outside = AverageOptions::default().force_window(ForceWindow::new(5.0, 6.0).unwrap());
        assert!(matches!(outside.force_weights(400, 1e-4), Err(FrfError::Outside { .. })));
    }

    #[test]
    fn impossible_windows_are_refused() {
        for (from, to) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert!(ForceWindow::new(from, to).is_err(), "{from} s to {to} s");
        }
        for fraction in [0.0, 1.0, 2.0, -0.1, f64::NAN] {
            assert!(ExponentialWindow::reaching(fraction, 1.0).is_err(), "{fraction}");
        }
        assert!(ExponentialWindow::new(0.0).is_err() && ExponentialWindow::reaching(0.01, 0.0).is_err());
        assert!((ExponentialWindow::reaching(0.01, 2.0).unwrap().decay_rate() - 0.5 * 100f64.ln()).abs() < 1e-15);
    }
}
