//! Friction out of a measured force along a measured motion: joints, tribometers, dampers.

mod comparison;
mod identification;
mod loops;
mod model;
mod onset;
mod problem;
mod record;
mod smoothed;
mod speed_curve;
mod start;

pub use comparison::{ForceComparison, compare_force};
pub use identification::{ForceIdentification, Validation, identify_force};
pub use loops::ForceLoop;
pub use model::ForceModel;
pub use onset::Onset;
pub use record::ForceRecord;
pub use speed_curve::SpeedBin;
