//! The model of a measurement, as a function of its inputs, and its derivatives.

mod at_values;
pub(crate) mod derivatives;
pub(crate) mod differences;
pub(crate) mod exact_derivatives;
pub(crate) mod excursion;
#[cfg(feature = "formula")]
mod formula;
mod output;
mod taylor;

pub use at_values::at_values;
#[cfg(feature = "formula")]
pub use formula::Formula;
pub use output::ModelOutput;
pub use taylor::Taylor;
