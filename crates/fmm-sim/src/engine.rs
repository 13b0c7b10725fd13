//! Engines: what all of them have in common.

use fmm_model::Scalar;

use crate::{Sampling, Scenario, SimulationError, Trajectory};

/// A way to simulate a scenario whose contact obeys a law of type `L`, at number type `D`.
///
/// The bounds of an implementation state the laws that an engine takes; nothing is decided at run time. An
/// implementor promises:
///
/// 1. every sample asked for is written, and a sample at the time of an event holds the state after it;
/// 2. events are in order of time, begin with [`Start`](crate::EventKind::Start), and end with the last one
///    before or at the last sample;
/// 3. at a dual number the derivatives include those of the event times;
/// 4. the result depends on the arguments only, and all its numbers are finite.
pub trait Engine<D: Scalar, L: ?Sized> {
    /// Simulates `scenario` into `trajectory`, whose memory is used again.
    ///
    /// # Errors
    /// [`SimulationError`] if the engine has no answer for this scenario; `trajectory` is then unspecified.
    fn run_into(
        &self,
        scenario: &Scenario<D, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError>;

    /// Simulates `scenario` into a trajectory of its own.
    ///
    /// # Errors
    /// As [`run_into`](Self::run_into).
    fn run(&self, scenario: &Scenario<D, L>, sampling: &Sampling) -> Result<Trajectory<D>, SimulationError> {
        let mut trajectory = Trajectory::new();
        self.run_into(scenario, sampling, &mut trajectory)?;
        Ok(trajectory)
    }
}
