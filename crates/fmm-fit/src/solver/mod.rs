//! Solver: a trust region within bounds, on a factor of the Jacobian.

mod argmin_solver;
#[cfg(feature = "serde")]
mod bits;
mod box_least_squares;
#[cfg(feature = "serde")]
mod checkpoint;
mod curvature;
pub(crate) mod differences;
mod error;
pub(crate) mod evaluation;
mod iteration;
mod jacobian_check;
pub(crate) mod minimizer;
mod non_finite;
mod optimality;
mod options;
mod outcome;
mod solve;
pub(crate) mod spectrum;
pub(crate) mod sums;
pub(crate) mod triangle;
mod trust_region;
mod wide;

pub use argmin_solver::BoundedLevenbergMarquardt;
pub use error::FitError;
pub use jacobian_check::{JacobianMismatch, check_jacobian};
pub use minimizer::Minimizer;
pub use non_finite::NonFinite;
pub use options::Options;
pub use outcome::Outcome;
pub use solve::{Progress, solve, solve_observed};
