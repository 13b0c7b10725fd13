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
//!
//! # Features
//!
//! None is on by default. `rayon` adds [`MultiStart`]'s `solve_parallel`, on all threads and with the same result.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod comparison;
mod diagnostics;
mod problem;
mod regression;
mod result;
mod robust;
mod solver;
mod starts;
mod uncertainty;

pub use comparison::{
    Comparing, ComparisonError, Contender, Criterion, Doubt, FTest, ModelRow, ModelTable, ModelTableError,
    NestedComparison, ResidualCount, Verdict, f_test,
};
pub use diagnostics::{
    NormalityTest, ResidualDiagnostics, RunsTest, anderson_darling, autocorrelation_time, durbin_watson,
    effective_count, runs_test,
};
pub use problem::{Automatic, Block, EvaluationError, Held, Joint, JointError, JointPart, Model, Residuals, Weighted};
pub use regression::{
    LinearRegression, Polynomial, PowerLaw, RegressionError, StraightLine, UncertainPoint, Weighting, YorkLine,
};
pub use result::{Estimate, EstimateStatus, Fit, NullDirection};
pub use robust::{Loss, Robust, RobustFit, Scale, median_deviation, solve_robust};
pub use solver::{
    BoundedLevenbergMarquardt, FitError, Minimizer, NonFinite, Options, Outcome, Progress, solve, solve_observed,
};
pub use starts::{Minima, Minimum, MultiStart, StartFailure};
pub use uncertainty::{
    CorrelatedCovariance, Prediction, ProfileEnd, ProfileError, ProfileInterval, PropagatedCovariance, Refit,
    RefitError, ResidualVariance, Sensitivity, SensitivityError, coverage_factor, profile_interval,
};
