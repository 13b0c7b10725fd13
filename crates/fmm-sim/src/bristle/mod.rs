//! The engine for laws with an internal state: an implicit collocation method that stops at every kink.

mod collocation;
mod field;
mod first_root;
mod lu;
mod radau;
mod run;

use fmm_friction::BristleLaw;
use fmm_model::Scalar;

use crate::drive::Drive;
use crate::recorder::Recorder;
use crate::{Engine, Sampling, Scenario, SimulationError, Trajectory};
use run::Run;

/// Simulates laws with bristles.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Bristle {
    /// Greatest error of a step, relative to the motion (1).
    pub tolerance: f64,
}

impl Default for Bristle {
    fn default() -> Self {
        Self { tolerance: 1e-11 }
    }
}

impl Bristle {
    /// The engine with another `tolerance` (1).
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }
}

impl<D: Scalar, L: BristleLaw<D>> Engine<D, L> for Bristle {
    fn run_into(
        &self,
        scenario: &Scenario<D, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError> {
        let drive = Drive::new(scenario.excitations(), scenario.oscillator().mass());
        let recorder = Recorder::new("bristle", scenario.law().states(), sampling, trajectory);
        Run::new(scenario, &drive, self.tolerance, recorder).run(&drive)
    }
}
