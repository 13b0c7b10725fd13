//! Residuals of a fit: noise, structure, and signs of sensor, instrument and surroundings.

mod autoregression;
pub(crate) mod correlation;
mod disturbances;
pub(crate) mod drift;
pub(crate) mod filtering;
pub(crate) mod noise;
mod noise_growth;
pub(crate) mod structure;
