//! Posterior of the parameters of a problem, by sampling.

pub(crate) mod calibration;
pub(crate) mod check;
pub(crate) mod convergence;
pub(crate) mod coordinates;
pub(crate) mod marginal;
pub(crate) mod mode;
pub(crate) mod nuts;
pub(crate) mod prior;
pub(crate) mod report;
pub(crate) mod result;
pub(crate) mod sampler;
pub(crate) mod target;
pub(crate) mod transform;
pub(crate) mod warning;
