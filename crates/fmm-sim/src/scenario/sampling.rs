//! Sampling of a simulation: times and channels.

use std::sync::Arc;

use fmm_model::ModelError;

use crate::error::SimulationError;

/// Kinematic quantities that are sampled. A fit to a velocity record needs no positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Channels {
    /// Position and velocity.
    #[default]
    Both,
    /// Position only.
    Position,
    /// Velocity only.
    Velocity,
    /// Position, velocity and acceleration.
    All,
}

impl Channels {
    /// True if positions are kept.
    pub const fn position(self) -> bool {
        matches!(self, Self::Both | Self::Position | Self::All)
    }

    /// True if velocities are kept.
    pub const fn velocity(self) -> bool {
        matches!(self, Self::Both | Self::Velocity | Self::All)
    }

    /// True if accelerations are kept.
    pub const fn acceleration(self) -> bool {
        matches!(self, Self::All)
    }
}

/// Greatest index that is an exact `f64`; beyond it sample times would not be exact.
const MOST_SAMPLES: usize = 1 << 53;

/// The sample times of a run, counted from the initial state at t = 0.
///
/// Uniform times are `t_i = i · interval` for `i` from `first` to `first + count − 1`. Any window of a long record can
/// be sampled on its own; its samples equal those of the whole record. The motion itself does not depend on the
/// sampling.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    grid: Grid,
    first: usize,
    count: usize,
    channels: Channels,
    work: bool,
    most_steps: Option<usize>,
}

#[derive(Debug, Clone, PartialEq)]
enum Grid {
    Uniform { interval: f64 },
    Times(Arc<[f64]>),
}

impl Sampling {
    /// `count` samples from t = 0 on, `interval` seconds apart, position and velocity.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the interval is not positive and finite, [`SimulationError::OutOfRange`] if
    /// there is no sample, there are more than 2⁵³, or the last sample time is not finite.
    pub fn uniform(interval: f64, count: usize) -> Result<Self, SimulationError> {
        ModelError::require_positive("sampling interval", interval, "s")?;
        if count == 0 || count > MOST_SAMPLES || !(interval * count as f64).is_finite() {
            return Err(SimulationError::sampling(count, interval));
        }
        Ok(Self::of(Grid::Uniform { interval }, 0, count))
    }

    /// Position and velocity at `count` times of a `grid` from number `first` on.
    const fn of(grid: Grid, first: usize, count: usize) -> Self {
        Self { grid, first, count, channels: Channels::Both, work: false, most_steps: None }
    }

    /// Position and velocity at one `time` (s), which must be positive and finite.
    pub(crate) const fn one(time: f64) -> Self {
        Self::of(Grid::Uniform { interval: time }, 1, 1)
    }

    /// Samples at the given `times` (s), which must ascend from 0 on; position and velocity.
    ///
    /// # Errors
    /// [`SimulationError::OutOfRange`] if there is no time, or one that is negative, not finite or before its
    /// predecessor.
    pub fn at(times: impl Into<Arc<[f64]>>) -> Result<Self, SimulationError> {
        let times = times.into();
        let mut before = 0.0;
        for (index, &time) in times.iter().enumerate() {
            if !(time.is_finite() && time >= before) {
                return Err(SimulationError::times(index, time, before));
            }
            before = time;
        }
        if times.is_empty() {
            return Err(SimulationError::sampling(0, 0.0));
        }
        let count = times.len();
        Ok(Self::of(Grid::Times(times), 0, count))
    }

    /// These sample times, keeping only `channels`.
    #[must_use]
    pub fn keeping(mut self, channels: Channels) -> Self {
        self.channels = channels;
        self
    }

    /// These sample times, with the [`Work`](crate::Work) done by friction, damping and excitation up to each of
    /// them. It costs several evaluations per sample.
    #[must_use]
    pub fn with_work(mut self) -> Self {
        self.work = true;
        self
    }

    /// These sample times, for runs in `most` steps or fewer. [`RungeKutta`](crate::RungeKutta) and
    /// [`Bristle`](crate::Bristle) end a longer run with [`SimulationError::Exhausted`]; without this they allow a
    /// million and 300 000. Engines that do not choose their steps ignore it. A fit has no use for a contact that creeps
    /// for longer than its record can tell.
    ///
    /// ```
    /// use fmm_friction::RegularisedStribeck;
    /// use fmm_model::Oscillator;
    /// use fmm_sim::{Sampling, Scenario, SimulationError, simulate};
    ///
    /// // At 1e-7 m/s the contact still creeps, and the steps are as short as that.
    /// let law = RegularisedStribeck::new(0.3, 0.3, 1e-7, 0.0)?;
    /// let scenario = Scenario::new(Oscillator::new(1.0, 100.0)?, law, 1.0)?.starting_at(0.02, 0.0)?;
    /// let run = simulate(&scenario, &Sampling::uniform(1e-2, 200)?.in_steps(5000));
    /// assert!(matches!(run, Err(SimulationError::Exhausted { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn in_steps(mut self, most: usize) -> Self {
        self.most_steps = Some(most);
        self
    }

    /// The part of the samples whose index lies in `window`, cut to those that exist; `None` if nothing is left.
    pub fn window(&self, window: std::ops::Range<usize>) -> Option<Self> {
        let end = window.end.min(self.count);
        (window.start < end).then(|| Self {
            first: self.first + window.start,
            count: end - window.start,
            ..self.clone()
        })
    }

    /// Time between samples (s); `None` if the times are not uniform.
    pub fn interval(&self) -> Option<f64> {
        match self.grid {
            Grid::Uniform { interval } => Some(interval),
            Grid::Times(_) => None,
        }
    }

    /// Number of samples.
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Kinematic quantities that are kept.
    pub const fn channels(&self) -> Channels {
        self.channels
    }

    /// True if the work up to each sample is asked for.
    pub const fn wants_work(&self) -> bool {
        self.work
    }

    /// Refuses more `steps` of a run than are asked for, or than the `usual` number.
    pub(crate) fn require_steps(&self, steps: usize, usual: usize) -> Result<(), SimulationError> {
        let most = self.most_steps.unwrap_or(usual);
        if steps > most { Err(SimulationError::step_budget(most, self.end())) } else { Ok(()) }
    }

    /// Number of sample times of the whole grid before the first of these.
    pub const fn first(&self) -> usize {
        self.first
    }

    /// Time of sample `index` (s), which must be below [`count`](Self::count).
    pub fn time(&self, index: usize) -> f64 {
        match &self.grid {
            Grid::Uniform { interval } => (self.first + index) as f64 * interval,
            Grid::Times(times) => times[self.first + index],
        }
    }

    /// Time of the last sample (s).
    pub fn end(&self) -> f64 {
        self.time(self.count - 1)
    }

    /// Index of the first sample at or after `time`, at most [`count`](Self::count).
    #[expect(clippy::cast_possible_wrap, reason = "no memory holds 2⁶³ samples")]
    pub(crate) fn index_at_or_after(&self, time: f64) -> usize {
        match &self.grid {
            Grid::Uniform { interval } => {
                // The quotient is cut and may be off by one ulp; comparisons with the sample times decide. They have no
                // branch, as their outcome cannot be predicted.
                let (first, end) = (self.first as i64, (self.first + self.count) as i64);
                let guess = ((time / interval) as i64).clamp(first, end);
                let (near, is_before) = (guess as f64, |index: f64| i64::from(index * interval < time));
                let index = guess - 1 + is_before(near - 1.0) + is_before(near) + is_before(near + 1.0);
                (index.clamp(first, end) - first) as usize
            }
            Grid::Times(times) => times[self.first..self.first + self.count].partition_point(|&t| t < time),
        }
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

    #[test]
    fn given_times_are_found_again() {
        let sampling = Sampling::at(vec![0.0, 0.5, 0.5, 2.0]).unwrap();
        assert_eq!((sampling.count(), sampling.end(), sampling.interval()), (4, 2.0, None));
        for (time, index) in [(-1.0, 0), (0.0, 0), (0.2, 1), (0.5, 1), (0.6, 3), (2.0, 3), (2.1, 4)] {
            assert_eq!(sampling.index_at_or_after(time), index, "{time} s");
        }
        assert_eq!(sampling.window(1..9).unwrap().time(0), 0.5);
        for bad in [vec![], vec![-1.0], vec![1.0, 0.5], vec![0.0, f64::NAN]] {
            assert!(Sampling::at(bad.clone()).is_err(), "{bad:?}");
        }
    }
}
