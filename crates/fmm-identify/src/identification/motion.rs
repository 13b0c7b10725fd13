//! End of a fitted motion: its half cycles, and the time at which it stops.

use fmm_sim::{Event, EventKind, Trajectory};

/// End of the fitted motion of one record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedMotion {
    stop_time: Option<f64>,
    half_swings: usize,
    narrowest: Option<(f64, f64)>,
}

impl FittedMotion {
    /// The motion behind `trajectory`, which begins at `start` (s) on the time axis of a record sampled every
    /// `interval` (s).
    pub(crate) fn of_events(start: f64, interval: f64, trajectory: &Trajectory) -> Self {
        // A velocity of nearly zero at the first sample reverses at once, or does not: that is no swing of the record.
        let turns = |event: &&Event| matches!(event.kind, EventKind::Reversal | EventKind::Stop);
        let begun = |event: &&Event| event.time > interval;
        let decided = trajectory.events().iter().filter(turns).filter(begun);
        let margins = decided.clone().map(|event| (event.margin(), start + event.time));
        Self {
            stop_time: trajectory.rest().map(|event| start + event.time),
            half_swings: decided.count(),
            narrowest: margins.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())),
        }
    }

    /// Margin and time (s) of the most narrowly decided turning point of `motions`.
    pub(crate) fn narrowest_decision(motions: &[Self]) -> Option<(f64, f64)> {
        let decided = motions.iter().filter_map(|motion| motion.narrowest);
        decided.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
    }

    /// Time at which the contact stops for good, on the time axis of the record (s); `None` if it does not before the end.
    pub fn stop_time(&self) -> Option<f64> {
        self.stop_time
    }

    /// Number of times at which the velocity reaches zero.
    pub fn half_swings(&self) -> usize {
        self.half_swings
    }
}
