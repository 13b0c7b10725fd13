//! Uncertainty of a fit beyond the covariance of independent residuals about a linear model.

mod forecast;
mod minimum;
pub(crate) mod profile;
pub(crate) mod profile_interval;
pub(crate) mod refit;
pub(crate) mod sensitivity;
