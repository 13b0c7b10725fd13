//! Plan of a simulation: when it is sampled and when it ends.

use std::error::Error;

use fmm_model::{ModelError, Rounded};
use fmm_sim::Sampling;

use super::file::Output;

/// More samples than this nobody reads, and their document would not fit into memory.
pub(crate) const MOST_SAMPLES: f64 = 5e7;

/// Samples over the duration of a scenario that does not say how many it wants.
const USUAL_SAMPLES: usize = 1000;

/// Sample times and the end of the motion.
///
/// An engine looks no further than its last sample, so that a motion that ends later has one more, which is not kept.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    pub(crate) sampling: Sampling,
    /// Number of samples that are given out.
    pub(crate) kept: usize,
    /// The last time at which an event is given out (s).
    pub(crate) end: f64,
}

impl Plan {
    /// The sample times of `output` in a motion of `duration` (s).
    ///
    /// # Errors
    /// Without an end, with too many samples, or with what makes no sampling.
    pub(crate) fn new(duration: Option<f64>, output: Option<Output>) -> Result<Self, Box<dyn Error>> {
        if let Some(duration) = duration {
            ModelError::require_positive("duration", duration, "s")?;
        }
        match (output, duration) {
            (Some(Output::Times(times)), _) => Self::at(times, duration.unwrap_or(0.0)),
            (_, None) => {
                Err("the scenario needs a duration (s), or output times, the last of which is then the end".into())
            }
            (None, Some(duration)) => {
                let interval = duration / (USUAL_SAMPLES - 1) as f64;
                Ok(Self { sampling: Sampling::uniform(interval, USUAL_SAMPLES)?, kept: USUAL_SAMPLES, end: duration })
            }
            (Some(Output::Rate(rate)), Some(duration)) => {
                ModelError::require_positive("rate of the output", rate, "1/s")?;
                // A duration that is a multiple of the interval but for rounding has its last sample.
                let intervals = (duration * rate * (1.0 + 4.0 * f64::EPSILON)).floor();
                if intervals.is_nan() || intervals >= MOST_SAMPLES {
                    let count = Rounded::every_digit(intervals + 1.0);
                    return Err(format!(
                        "{count} samples were asked for, and at most {MOST_SAMPLES} are given; lower the rate or the \
                         duration"
                    )
                    .into());
                }
                let (interval, kept) = (1.0 / rate, intervals as usize + 1);
                let reaches = intervals * interval >= duration;
                let sampling = Sampling::uniform(interval, kept + usize::from(!reaches))?;
                Ok(Self { sampling, kept, end: duration })
            }
        }
    }

    /// Samples at `times` (s) of a motion that ends with the last of them, or at `end` (s) if that is later.
    ///
    /// # Errors
    /// If there are no times or they do not ascend from 0.
    pub(crate) fn at(mut times: Vec<f64>, end: f64) -> Result<Self, Box<dyn Error>> {
        let kept = times.len();
        let last = times.last().copied().unwrap_or(f64::INFINITY);
        if last < end {
            times.push(end);
        }
        Ok(Self { sampling: Sampling::at(times)?, kept, end: last.max(end) })
    }
}
