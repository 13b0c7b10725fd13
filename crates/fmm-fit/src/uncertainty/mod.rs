//! How sure it is, beyond the covariance of independent residuals about a linear model.

mod correlated;
mod held;
mod minimum;
pub(crate) mod prediction;
mod profile;
mod profile_interval;
mod propagated;
mod sensitivity;

pub use correlated::CorrelatedCovariance;
pub use prediction::Prediction;
pub use profile::profile_interval;
pub use profile_interval::{ProfileEnd, ProfileError, ProfileInterval, ResidualVariance};
pub use propagated::{PropagatedCovariance, SensitivityError};
pub use sensitivity::Sensitivity;
