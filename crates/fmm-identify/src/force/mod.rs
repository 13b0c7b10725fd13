//! Friction out of a measured force along a measured motion: joints, tribometers, dampers.

mod identification;
mod model;
mod problem;
mod record;
mod smoothed;
mod speed_curve;
mod start;

pub use identification::{ForceIdentification, Validation, identify_force};
pub use model::ForceModel;
pub use record::ForceRecord;
pub use speed_curve::SpeedBin;
