//! Residuals of a fit: their noise, their structure, and signs of sensor, instrument and surroundings.

mod autoregression;
pub(crate) mod knowledge;
pub(crate) mod noise;
mod noise_growth;
pub(crate) mod rules;
pub(crate) mod structure;
