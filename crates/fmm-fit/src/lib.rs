//! Bounded nonlinear least squares for argmin, with covariance, rank and what the data could not tell.
//!
//! Describe a problem by [`Residuals`], call [`solve`], read the [`Fit`].
//!
//! | Question | Item |
//! |---|---|
//! | Fit once | [`solve`], with progress and cancellation [`solve_observed`] |
//! | Fit a hundred thousand times | [`Minimizer`] |
//! | Fit under argmin's executor | [`BoundedLevenbergMarquardt`] |
//! | Give each residual its uncertainty | [`Weighted`] |
//! | Let outliers count less | [`solve_robust`], as a problem of its own [`Robust`] |
//! | Find the lowest of many minima | [`MultiStart`] |
//! | Which parameters are determined? | [`Fit::null_directions`], [`Estimate::status`] |
//! | How well? | [`Fit::covariance`], [`Fit::interval`] |
//! | How well, where the model bends? | [`profile_interval`] |
//! | What had no finite value? | [`Fit::non_finite`] |
//! | Which straight line, polynomial, columns? | [`StraightLine`], [`Polynomial`], [`LinearRegression`] |
//! | With uncertainties in both variables? | [`YorkLine`] |
//! | Which power law with offset? | [`PowerLaw`] |
//! | How well is the model known elsewhere? | [`Fit::predict`], [`Prediction`] |
//! | Which of several models? | [`ModelTable`] |
//! | Exact derivatives without writing any | [`Automatic`] |
//! | Fit several records that share parameters | [`Joint`], [`Block`] |
//! | What do values held fixed do to the estimates? | [`Sensitivity`] |
//! | Is a further parameter worth having? | [`f_test`], [`Fit::corrected_akaike`] |
//! | Are the residuals noise? | [`ResidualDiagnostics`], [`durbin_watson`], [`effective_count`] |
//! | And if they are not? | [`CorrelatedCovariance`] |

mod argmin_solver;
mod automatic;
mod block;
mod box_least_squares;
mod comparing;
mod contender;
mod correlated;
mod diagnostics_summary;
mod error;
mod estimate;
mod evaluation;
mod fit;
mod held;
mod iteration;
mod joint;
mod joint_error;
mod linear_regression;
mod loss;
mod m_covariance;
mod minima;
mod minimizer;
mod minimum;
mod model_comparison;
mod model_report;
mod model_table;
mod model_table_error;
mod multi_start;
mod non_finite;
mod normality;
mod null_direction;
mod optimality;
mod options;
mod outcome;
mod polynomial;
mod power_law;
mod prediction;
mod profile;
mod profile_interval;
mod propagated;
mod refined_least_squares;
mod regression_error;
mod report;
mod residual_diagnostics;
mod residuals;
mod robust;
mod robust_fit;
mod runs_test;
mod sensitivity;
mod solve;
mod spectrum;
mod start_points;
mod straight_line;
mod triangle;
mod trust_region;
mod twofold;
mod verdict;
mod weighted;
mod weighting;
mod york;

pub use argmin_solver::BoundedLevenbergMarquardt;
pub use automatic::{Automatic, Model};
pub use block::Block;
pub use comparing::{Comparing, Criterion, ResidualCount};
pub use contender::Contender;
pub use correlated::CorrelatedCovariance;
pub use diagnostics_summary::ResidualDiagnostics;
pub use error::FitError;
pub use estimate::{Estimate, EstimateStatus};
pub use fit::Fit;
pub use joint::{Joint, JointPart};
pub use joint_error::JointError;
pub use linear_regression::LinearRegression;
pub use loss::Loss;
pub use minima::{Minima, Minimum, StartFailure};
pub use minimizer::Minimizer;
pub use model_comparison::{ComparisonError, FTest, f_test};
pub use model_table::{ModelRow, ModelTable, NestedComparison};
pub use model_table_error::ModelTableError;
pub use multi_start::MultiStart;
pub use non_finite::NonFinite;
pub use normality::{NormalityTest, anderson_darling};
pub use null_direction::NullDirection;
pub use options::Options;
pub use outcome::Outcome;
pub use polynomial::Polynomial;
pub use power_law::PowerLaw;
pub use prediction::Prediction;
pub use profile::profile_interval;
pub use profile_interval::{ProfileEnd, ProfileError, ProfileInterval, ResidualVariance};
pub use propagated::{PropagatedCovariance, SensitivityError};
pub use regression_error::RegressionError;
pub use residual_diagnostics::{autocorrelation_time, durbin_watson, effective_count};
pub use residuals::{EvaluationError, Residuals};
pub use robust::Robust;
pub use robust_fit::{RobustFit, Scale, median_deviation, solve_robust};
pub use runs_test::{RunsTest, runs_test};
pub use sensitivity::Sensitivity;
pub use solve::{Progress, solve, solve_observed};
pub use straight_line::StraightLine;
pub use verdict::{Doubt, Verdict};
pub use weighted::Weighted;
pub use weighting::Weighting;
pub use york::{UncertainPoint, YorkLine};
