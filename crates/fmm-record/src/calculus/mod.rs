//! Other forms of a record: smoothed, integrated, differentiated, resampled.

pub(crate) mod integral;
pub(crate) mod resampling;
pub(crate) mod savitzky_golay;
pub(crate) mod smooth;
pub(crate) mod smoothing;
