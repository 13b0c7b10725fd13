//! What came out: estimates with their uncertainties, and what the data could not tell.

mod estimate;
mod fit;
pub(crate) mod null_direction;
mod report;

pub use estimate::{Estimate, EstimateStatus};
pub use fit::Fit;
pub use null_direction::NullDirection;
