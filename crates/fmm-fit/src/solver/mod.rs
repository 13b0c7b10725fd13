//! Solver: a trust region within bounds, on a factor of the Jacobian.

mod box_least_squares;
mod curvature;
pub(crate) mod differences;
pub(crate) mod evaluation;
mod iteration;
pub(crate) mod jacobian_check;
pub(crate) mod minimizer;
pub(crate) mod options;
pub(crate) mod outcome;
mod trust_region;
