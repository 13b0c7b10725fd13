//! Uncertainty of a fit beyond the covariance of independent residuals about a linear model.

mod correlated;
pub(crate) mod coverage;
pub(crate) mod definite;
mod forecast;
mod minimum;
pub(crate) mod prediction;
mod profile;
mod profile_interval;
mod propagated;
mod refit;
mod refit_error;
mod sensitivity;

pub use correlated::CorrelatedCovariance;
pub use prediction::Prediction;
pub use profile::profile_interval;
pub use profile_interval::{ProfileEnd, ProfileError, ProfileInterval, ResidualVariance};
pub use propagated::{PropagatedCovariance, SensitivityError};
pub use refit::Refit;
pub use refit_error::RefitError;
pub use sensitivity::Sensitivity;
