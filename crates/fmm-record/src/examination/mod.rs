//! Examination of a record before a fit: rest and release, swings, disturbances.

pub(crate) mod further_release;
pub(crate) mod harmonic;
pub(crate) mod hum;
pub(crate) mod interruption;
pub(crate) mod noise;
pub(crate) mod offset_step;
pub(crate) mod quantisation;
pub(crate) mod release;
pub(crate) mod saturation;
pub(crate) mod second_mode;
pub(crate) mod spikes;
pub(crate) mod steadiness;
pub(crate) mod swings;
pub(crate) mod turning;
pub(crate) mod upsampling;
