//! Path of motions over their speeds.

use fmm_fit::EvaluationError;
use fmm_sim::{Channels, Sampling};

use crate::friction_curve::levels::{LEVELS, weights};
use crate::friction_curve::rules::{MOST_SAMPLES, SAMPLES_PER_PERIOD};
use crate::problem::Problem;

/// Motion of all records: speeds at dense times, and the lowest at the samples of each half cycle.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    speeds: Vec<f64>,
    lowest: Vec<f64>,
}

impl Path {
    /// Paths of other records together.
    pub(crate) fn of_all<'a>(paths: impl Iterator<Item = &'a Self>) -> Self {
        let mut all = Self { speeds: Vec::new(), lowest: Vec::new() };
        for path in paths {
            all.speeds.extend_from_slice(&path.speeds);
            all.lowest.extend_from_slice(&path.lowest);
        }
        all
    }

    /// Path of all records of `problem` by these values.
    pub(crate) fn of(problem: &Problem<'_>, values: &[f64]) -> Result<Self, EvaluationError> {
        let (mut speeds, mut lowest) = (Vec::new(), Vec::new());
        for (record, experiment) in problem.experiments().iter().enumerate() {
            let series = experiment.record();
            let dense = experiment.guess.frequency() * SAMPLES_PER_PERIOD * series.duration();
            let count = (dense.ceil() as usize).clamp(2, MOST_SAMPLES);
            let sampling = Sampling::uniform(series.duration() / (count - 1) as f64, count)?;
            speeds.extend(problem.velocities(record, values, &sampling)?.into_iter().map(f64::abs));
            let sampling = experiment.sampling()?;
            let at_samples = problem.velocities(record, values, &sampling.keeping(Channels::Velocity))?;
            lowest.extend(at_samples.chunk_by(|a, b| (a > &0.0) == (b > &0.0)).filter_map(|half_cycle| {
                let moving = half_cycle.iter().map(|v| v.abs()).filter(|speed| *speed > 0.0);
                moving.min_by(f64::total_cmp)
            }));
        }
        Ok(Self { speeds, lowest })
    }

    /// Speed at or below which half of the half cycles have a sample.
    pub(super) fn slowest(&self) -> f64 {
        let mut lowest = self.lowest.clone();
        lowest.sort_by(f64::total_cmp);
        lowest.get(lowest.len() / 2).copied().unwrap_or(0.0)
    }

    /// Highest speed.
    pub(crate) fn top(&self) -> f64 {
        self.speeds.iter().copied().fold(0.0, f64::max)
    }

    /// Weight of each level in the mean over the path, for a curve up to `top`.
    pub(super) fn weights(&self, top: f64) -> [f64; LEVELS] {
        /// Steps of the relative speed in which the path is collected.
        const BINS: usize = 4096;
        let mut bins = vec![0.0; BINS + 1];
        for speed in &self.speeds {
            bins[((speed / top * BINS as f64).round() as usize).min(BINS)] += speed;
        }
        let all: f64 = bins.iter().sum();
        let mut mean = [0.0; LEVELS];
        for (bin, path) in bins.iter().enumerate().filter(|(_, path)| **path > 0.0) {
            let own = weights(bin as f64 / BINS as f64);
            mean.iter_mut().zip(own).for_each(|(mean, weight)| *mean += path / all * weight);
        }
        mean
    }
}
