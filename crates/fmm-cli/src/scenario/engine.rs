//! Engines by their names, and what a run asks of them.

use std::fmt;

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
