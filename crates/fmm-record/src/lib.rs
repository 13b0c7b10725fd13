//! x
mod error;
mod quantity;
mod reading;
mod record;
mod sampling;
#[cfg(feature = "csv")]
pub mod csv;
#[cfg(feature = "mat")]
pub mod mat;
pub use error::RecordError;
pub use quantity::Quantity;
pub use reading::{Column, Reading};
pub use record::Record;
pub use sampling::{JITTER, RATE_ROUNDING, Sampling, UniformTimes};
