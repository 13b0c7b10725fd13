//! One measurement of known truth.

use fmm_identify::Machine;
use fmm_record::{Quantity, Record};

use super::{Found, Levels, Setup};

/// Truth that a judgement should find.
#[derive(Debug, Clone)]
pub(crate) struct Truth {
    /// Names of laws that are right; the first is that of the law which moved the machine.
    pub(crate) right: Vec<&'static str>,
    /// μ (1).
    pub(crate) levels: Levels,
    /// Relative change of the friction with each half cycle (1), of the mean.
    pub(crate) change: f64,
    /// Rise of the friction from the middle to the largest deflection (1), of the mean.
    pub(crate) rise: f64,
    /// c/m of machine and law together (1/s).
    pub(crate) damping_per_mass: f64,
    /// f₀ (Hz).
    pub(crate) frequency: f64,
    /// Largest speed of the motion (m/s).
    pub(crate) peak_speed: f64,
    /// m/N, by which friction per mass becomes a coefficient (kg/N).
    pub(crate) mass_by_load: f64,
}

/// A record, what is known of the machine, and the truth.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) record: Record,
    pub(crate) machine: Machine,
    pub(crate) truth: Truth,
}

impl Case {
    /// A record of `values` every `interval` (s) of the motion of `setup`, whose largest speed is `peak_speed` (m/s).
    pub(crate) fn new(
        setup: &Setup,
        values: Vec<f64>,
        interval: f64,
        quantity: Quantity,
        peak_speed: f64,
    ) -> Found<Self> {
        let unit = if quantity == Quantity::Displacement { "m" } else { "m/s" };
        let record = Record::new(0.0, interval, values, quantity, unit)?;
        Ok(Self { record, machine: setup.known()?, truth: setup.truth(peak_speed)? })
    }
}
