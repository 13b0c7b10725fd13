//! Clock of the records: how well their sampling rate is known, and what follows from it.

use fmm_record::Quantity;

use crate::experiment::Experiment;

/// Clock of the records.
pub(crate) struct Clock {
    /// Relative standard uncertainty of its rate (1).
    pub(crate) uncertainty: f64,
    /// Order of the derivative of the position that the records are.
    pub(crate) order: f64,
}

impl Clock {
    /// The clock that has taken `experiments`; the worst that is stated counts for all.
    pub(crate) fn of(experiments: &[Experiment]) -> Self {
        let uncertainty = experiments.iter().map(|one| one.summary().clock_uncertainty).fold(0.0, f64::max);
        let order = match experiments.first().map(|one| one.record().quantity()) {
            Some(Quantity::Displacement) => 0.0,
            Some(Quantity::Acceleration) => 2.0,
            _ => 1.0,
        };
        Self { uncertainty, order }
    }
}
