//! Result of a fit: estimates, their uncertainty, and directions that the residuals do not determine.

pub(crate) mod estimate;
pub(crate) mod fit;
pub(crate) mod null_direction;
pub(crate) mod prediction;
mod report;
