//! Result of a fit: estimates with their uncertainties, and directions that the data leave free.

mod estimate;
mod fit;
pub(crate) mod null_direction;
mod report;

pub use estimate::{Estimate, EstimateStatus};
pub use fit::Fit;
pub use null_direction::NullDirection;
