//! The model of a measurement, as a function of its inputs.

#[cfg(feature = "formula")]
mod formula;
mod output;
mod taylor;

#[cfg(feature = "formula")]
pub use formula::Formula;
pub use output::ModelOutput;
pub use taylor::Taylor;
