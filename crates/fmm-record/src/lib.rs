//! x
#[cfg(feature = "csv")]
pub mod csv;
#[cfg(feature = "mat")]
pub mod mat;

mod calculus;
mod error;
mod harmonic;
mod noise;
mod offset_step;
mod order;
mod quantisation;
mod quantity;
mod reading;
mod record;
mod release;
mod sampling;
mod saturation;
mod smooth;
mod spikes;
mod swings;
#[cfg(test)]
mod synthetic;
mod turning;

pub use error::RecordError;
pub use noise::noise;
pub use offset_step::OffsetStep;
pub use quantisation::quantisation_step;
pub use quantity::Quantity;
pub use reading::{Column, Reading};
pub use record::Record;
pub use release::Release;
pub use sampling::{JITTER, RATE_ROUNDING, Sampling, UniformTimes};
pub use saturation::{Saturation, saturation};
pub use smooth::{EndRule, moving_average};
pub use spikes::{Spike, spikes};
pub use swings::{Crossing, Peak, Swings};
