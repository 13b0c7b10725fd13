//! Bounded nonlinear least squares for argmin, with covariance, rank and what the data could not tell.
//!
//! Describe a problem by [`Residuals`], call [`solve`], read the [`Fit`].
//!
//! | Question | Item |
//! |---|---|
//! | Fit once | [`solve`], with progress and cancellation [`solve_observed`] |
//! | Fit a hundred thousand times | [`Minimizer`] |
//! | Fit under argmin's executor | [`BoundedLevenbergMarquardt`] |
//! | Which parameters are determined? | [`Fit::null_directions`], [`Estimate::status`] |
//! | How well? | [`Fit::covariance`], [`Fit::interval`] |
//! | Is a further parameter worth having? | [`f_test`], [`Fit::corrected_akaike`] |
//! | Are the residuals noise? | [`durbin_watson`], [`effective_count`] |
//! | And if they are not? | [`CorrelatedCovariance`] |

mod argmin_solver;
mod box_least_squares;
mod correlated;
mod error;
mod estimate;
mod evaluation;
mod fit;
mod iteration;
mod minimizer;
mod model_comparison;
mod null_direction;
mod optimality;
mod options;
mod outcome;
mod report;
mod residual_diagnostics;
mod residuals;
mod solve;
mod spectrum;
mod triangle;
mod trust_region;

pub use argmin_solver::BoundedLevenbergMarquardt;
pub use correlated::CorrelatedCovariance;
pub use error::FitError;
pub use estimate::{Estimate, EstimateStatus};
pub use fit::Fit;
pub use minimizer::Minimizer;
pub use model_comparison::{ComparisonError, FTest, f_test};
pub use null_direction::NullDirection;
pub use options::Options;
pub use outcome::Outcome;
pub use residual_diagnostics::{autocorrelation_time, durbin_watson, effective_count};
pub use residuals::{EvaluationError, Residuals};
pub use solve::{Progress, solve, solve_observed};
