//! Measured series of a motion, the motion by them, and how far their noise and the averaging may have moved it.

use crate::experiment::force::smoothed::Smoothed;
use crate::law::along::MeasuredMotion;

/// Series of a motion that were measured, their noise averaged.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Measured {
    /// m.
    pub(super) positions: Option<Smoothed>,
    /// m/s.
    pub(super) velocities: Option<Smoothed>,
    /// m/s².
    pub(super) accelerations: Option<Smoothed>,
}

/// Noise of a measured series that was averaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AveragedNoise {
    /// The quantity in a word.
    pub(crate) quantity: &'static str,
    /// Noise over the standard deviation of the series (1).
    pub(crate) share: f64,
    /// Samples over which it was averaged.
    pub(crate) samples: usize,
}

/// Number of trials in which noise is added to the motion once more.
const REPEATS: u64 = 10;

impl Measured {
    /// The motion, at rest up to `rest_speed` (m/s): velocities follow from the positions if none were measured,
    /// positions from the velocities, from 0 on, and accelerations from the velocities, averaged as these were.
    pub(super) fn motion(&self, times: &[f64], rest_speed: f64) -> MeasuredMotion {
        let (velocities, slopes) = match (&self.velocities, &self.positions) {
            (Some(velocities), _) => (velocities.values.clone(), velocities.slopes.clone()),
            (None, Some(positions)) => {
                (positions.slopes.clone(), positions.like(times, positions.slopes.clone()).slopes)
            }
            (None, None) => Default::default(),
        };
        let positions = match &self.positions {
            Some(positions) => positions.values.clone(),
            None => sums(times, &velocities, &slopes),
        };
        let accelerations = self.accelerations.as_ref().map_or(slopes, |series| series.values.clone());
        MeasuredMotion { times: times.to_vec(), positions, velocities, accelerations, rest_speed }
    }

    /// Motions that it could be as well, each with the weight (1) of its effects in a standard uncertainty: with as
    /// much noise once more, several times, if there is any, and averaged once more, as what averaging does lies within
    /// what it does again; a series that is not averaged has the slopes of more neighbours there.
    pub(super) fn others(&self, times: &[f64], rest_speed: f64) -> Vec<(f64, MeasuredMotion)> {
        let motion = |weight: f64, measured: Self| (weight, measured.motion(times, rest_speed));
        let repeats = if self.noise().is_some() { REPEATS } else { 0 };
        let noisy = (0..repeats).map(|seed| self.map(|series| series.with_noise(times, seed)));
        // Few repeats scatter as Student's t.
        let mut others: Vec<_> = noisy.map(|other| motion(((REPEATS - 2) as f64).sqrt().recip(), other)).collect();
        others.push(motion(3.0_f64.sqrt().recip(), self.map(|series| series.again(times))));
        others
    }

    /// The motion with as much noise once more.
    pub(super) fn noisier(&self, times: &[f64]) -> MeasuredMotion {
        self.map(|series| series.with_noise(times, 0)).motion(times, 0.0)
    }

    fn map(&self, of: impl Fn(&Smoothed) -> Smoothed) -> Self {
        let [positions, velocities, accelerations] =
            [&self.positions, &self.velocities, &self.accelerations].map(|series| series.as_ref().map(&of));
        Self { positions, velocities, accelerations }
    }

    /// The largest noise that was averaged, over its series; `None` if there was none.
    pub(super) fn noise(&self) -> Option<AveragedNoise> {
        let all =
            [("position", &self.positions), ("velocity", &self.velocities), ("acceleration", &self.accelerations)];
        let noise = |(quantity, series): (&'static str, &Option<Smoothed>)| {
            let (share, samples) = series.as_ref()?.noise()?;
            Some(AveragedNoise { quantity, share, samples })
        };
        all.into_iter().filter_map(noise).max_by(|a, b| a.share.total_cmp(&b.share))
    }
}

/// Positions (m) by the sums of the `velocities` (m/s) and their `slopes` (m/s²), from 0 on.
fn sums(times: &[f64], velocities: &[f64], slopes: &[f64]) -> Vec<f64> {
    let way = |i: usize| {
        let duration = times[i] - times[i - 1];
        // The trapezoid, and what a cubic through both ends lies above it (Euler and Maclaurin).
        let bend = duration * duration / 12.0 * (slopes[i - 1] - slopes[i]);
        0.5 * (velocities[i - 1] + velocities[i]) * duration + bend
    };
    let ways = (1..times.len()).scan(0.0, |position, i| {
        *position += way(i);
        Some(*position)
    });
    std::iter::once(0.0).chain(ways).collect()
}
