//! The model of a measurement, as a function of its inputs, and its derivatives.

mod at_values;
pub(crate) mod derivatives;
pub(crate) mod differences;
pub(crate) mod exact_derivatives;
pub(crate) mod excursion;
mod outcome;
mod taylor;

pub use at_values::at_values;
pub use outcome::Outcome;
pub use taylor::Taylor;
