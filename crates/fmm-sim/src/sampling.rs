//! When a simulation is sampled, and what is kept.

use fmm_model::ModelError;

use crate::SimulationError;

/// Which kinematic quantities are sampled. A fit to a velocity record needs no positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Channels {
    /// Position and velocity.
    #[default]
    Both,
    /// Position only.
    Position,
    /// Velocity only.
    Velocity,
}

impl Channels {
    /// Whether positions are kept.
    pub const fn position(self) -> bool {
        matches!(self, Self::Both | Self::Position)
    }

    /// Whether velocities are kept.
    pub const fn velocity(self) -> bool {
        matches!(self, Self::Both | Self::Velocity)
    }
}

/// Uniform sample times `t_i = i · interval` for `i` from `first` to `first + count − 1`, counted from the
/// initial state at t = 0.
///
/// Any window of a long record can be sampled on its own; the samples are the same as those of the whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    interval: f64,
    first: usize,
    count: usize,
    channels: Channels,
}

impl Sampling {
    /// `count` samples from t = 0 on, `interval` seconds apart, position and velocity.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the interval is not positive and finite, [`SimulationError::Sampling`] if
    /// there is no sample or the last sample time is not finite.
    pub fn uniform(interval: f64, count: usize) -> Result<Self, SimulationError> {
        ModelError::require_positive("sampling interval", interval, "s")?;
        if count == 0 || !(interval * count as f64).is_finite() {
            return Err(SimulationError::Sampling { count, interval });
        }
        Ok(Self { interval, first: 0, count, channels: Channels::Both })
    }

    /// The same sample times, keeping only `channels`.
    #[must_use]
    pub fn keeping(mut self, channels: Channels) -> Self {
        self.channels = channels;
        self
    }

    /// The part of the samples whose index lies in `window`, cut to those that exist; none if nothing is left.
    pub fn window(&self, window: std::ops::Range<usize>) -> Option<Self> {
        let end = window.end.min(self.count);
        (window.start < end).then(|| Self { first: self.first + window.start, count: end - window.start, ..*self })
    }

    /// Time between samples (s).
    pub const fn interval(&self) -> f64 {
        self.interval
    }

    /// Number of samples.
    pub const fn count(&self) -> usize {
        self.count
    }

    /// What is kept of each sample.
    pub const fn channels(&self) -> Channels {
        self.channels
    }

    /// Number of intervals between t = 0 and the first sample.
    pub const fn first(&self) -> usize {
        self.first
    }

    /// Time of sample `index` (s).
    pub fn time(&self, index: usize) -> f64 {
        (self.first + index) as f64 * self.interval
    }

    /// Time of the last sample (s).
    pub fn end(&self) -> f64 {
        self.time(self.count - 1)
    }

    /// Index of the first sample at or after `time`, at most [`count`](Self::count).
    pub(crate) fn index_at_or_after(&self, time: f64) -> usize {
        // The quotient may be off by one ulp; the two comparisons with the sample times themselves decide.
        let estimate = (time / self.interval).ceil() - self.first as f64;
        let mut index = if estimate > 0.0 { (estimate as usize).min(self.count) } else { 0 };
        while index > 0 && self.time(index - 1) >= time {
            index -= 1;
        }
        while index < self.count && self.time(index) < time {
            index += 1;
        }
        index
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_at_sample_times_are_exact() {
        let sampling = Sampling::uniform(0.1, 1000).unwrap();
        for index in 0..1000 {
            let time = sampling.time(index);
            assert_eq!(sampling.index_at_or_after(time), index);
            assert_eq!(sampling.index_at_or_after(time.next_up()), index + 1);
            assert_eq!(sampling.index_at_or_after(time - 1e-9), index);
        }
        assert_eq!(sampling.index_at_or_after(-1.0), 0);
        assert_eq!(sampling.index_at_or_after(1e300), 1000);
        assert_eq!(sampling.index_at_or_after(f64::INFINITY), 1000);
    }

    #[test]
    fn windows_are_cut_to_what_exists() {
        let sampling = Sampling::uniform(0.5, 10).unwrap();
        let window = sampling.window(8..20).unwrap();
        assert_eq!((window.count(), window.time(0), window.end()), (2, 4.0, 4.5));
        assert_eq!(sampling.window(10..20), None);
        assert_eq!(window.index_at_or_after(4.2), 1);
        assert!(Sampling::uniform(0.0, 3).is_err() && Sampling::uniform(1.0, 0).is_err());
        assert!(Sampling::uniform(1e308, 1000).is_err());
    }
}
