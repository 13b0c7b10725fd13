//! Fits that outliers do not spoil.

mod loss;
mod m_covariance;
mod problem;
mod robust_fit;

pub use loss::Loss;
pub use problem::Robust;
pub use robust_fit::{RobustFit, Scale, median_deviation, solve_robust};
