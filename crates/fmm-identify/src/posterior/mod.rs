//! Posterior of an identification: probable values of everything it found.

mod identified;
mod intervals;
mod known_inputs;
mod predictive;
mod report;
#[cfg(feature = "serde")]
mod serialised;

pub use identified::IdentificationPosterior;
pub use intervals::IntervalComparison;
pub use predictive::PredictiveCheck;
