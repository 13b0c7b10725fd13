//! Residuals of a fit: noise, structure, and signs of sensor, instrument and surroundings.

mod autoregression;
pub(crate) mod correlation;
pub(crate) mod knowledge;
pub(crate) mod noise;
mod noise_growth;
pub(crate) mod structure;
