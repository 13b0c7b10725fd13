//! Engines by their names, and what a run asks of them.

use std::fmt;

use fmm_friction::{BristleLaw, SlidingLaw};
use fmm_sim::{Bristle, Engine, Moreau, RungeKutta, Sampling, Scenario, SimulationError, Thesis, Trajectory};
use serde::Deserialize;

/// The engines that a scenario can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum EngineName {
    /// The one that suits law and machine.
    #[default]
    Auto,
    /// Closed form between events.
    Exact,
    /// Any law of the sliding speed, to a tolerance.
    RungeKutta,
    /// Any law with an internal state, to a tolerance.
    Bristle,
    /// The thesis' semi-implicit Euler, one step a sample.
    Thesis,
    /// Time stepping of the set-valued law, one step a sample.
    Moreau,
}

impl fmt::Display for EngineName {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Exact => "exact",
            Self::RungeKutta => "runge_kutta",
            Self::Bristle => "bristle",
            Self::Thesis => "thesis",
            Self::Moreau => "moreau",
        })
    }
}

/// An engine and how accurate it shall be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Choice {
    pub(crate) engine: EngineName,
    /// Relative tolerance (1); none for the engine's own.
    pub(crate) tolerance: Option<f64>,
}

impl Choice {
    /// The bristle engine at the tolerance chosen.
    pub(crate) fn bristle<L: BristleLaw<f64>>(
        self,
        scenario: &Scenario<f64, L>,
        sampling: &Sampling,
    ) -> Result<Trajectory, SimulationError> {
        self.tolerance.map_or_else(|| Ok(Bristle::default()), Bristle::new)?.run(scenario, sampling)
    }

    /// An engine for laws of the sliding speed alone; `None` if the one chosen is not.
    pub(crate) fn sliding(
        self,
        scenario: &Scenario<f64, dyn SlidingLaw<f64> + '_>,
        sampling: &Sampling,
    ) -> Result<Option<Trajectory>, SimulationError> {
        match self.engine {
            EngineName::Auto | EngineName::RungeKutta => {
                self.tolerance.map_or_else(|| Ok(RungeKutta::default()), RungeKutta::new)?.run(scenario, sampling)
            }
            EngineName::Thesis => Thesis::default().run(scenario, sampling),
            EngineName::Moreau => Moreau::default().run(scenario, sampling),
            EngineName::Exact | EngineName::Bristle => return Ok(None),
        }
        .map(Some)
    }
}
