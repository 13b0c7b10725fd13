//! Posterior of the parameters of a problem, by sampling.

mod calibration;
mod check;
mod convergence;
mod coordinates;
mod marginal;
mod mode;
mod nuts;
mod prior;
mod report;
mod result;
mod sampler;
mod target;
mod transform;
mod warning;

pub use calibration::Calibration;
pub use marginal::Marginal;
pub use prior::Prior;
pub use result::Posterior;
pub use sampler::Sampler;
pub use warning::PosteriorWarning;
