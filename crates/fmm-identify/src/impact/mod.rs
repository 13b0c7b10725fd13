//! Friction out of hammer blows: the motion after a measured force, simulated and fitted.

mod covariance;
#[cfg(test)]
mod derivatives;
mod identification;
mod lines;
mod machine;
mod options;
mod parameters;
mod problem;
mod pulse_prior;
mod remainder;
mod report;
mod simulation;
mod start;
mod warnings;

pub use identification::{ImpactIdentification, identify_impact};
pub use machine::ImpactMachine;
pub use options::{ImpactDomain, ImpactOptions};
pub use problem::ImpactProblem;
