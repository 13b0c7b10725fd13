//! Bounded nonlinear least squares for argmin, with covariance, rank and what the data could not tell.
//!
//! For a curve through data a closure is enough; its derivatives are exact:
//!
//! ```
//! use fmm_fit::{Scalar, curve_fit};
//!
//! let (t, x) = ([0.0, 1.0, 2.0, 3.0, 4.0], [2.003, 1.211, 0.738, 0.442, 0.271]);
//! let fit = curve_fit(&t, &x, [("amplitude", 1.0), ("rate", 0.1)], |t, [a, b]| a * (-b * t).exp())?;
//! assert!((fit.values()[1] - 0.501_354).abs() < 1e-4);
//! # Ok::<(), fmm_fit::FitError>(())
//! ```
//!
//! Otherwise describe a problem by [`Residuals`], or by a formula as a [`Model`]; call [`solve`]; read the [`Fit`].
//!
//! ```
//! use fmm_fit::{EvaluationError, Options, Residuals, solve};
//! use fmm_model::{Bounds, Parameter};
//!
//! /// Amplitudes of a decay, a exp(−b t), measured once a second.
//! struct Decay {
//!     amplitudes: [f64; 5],
//!     parameters: [Parameter; 2],
//! }
//!
//! impl Residuals for Decay {
//!     fn parameters(&self) -> &[Parameter] {
//!         &self.parameters
//!     }
//!     fn len(&self) -> usize {
//!         self.amplitudes.len()
//!     }
//!     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
//!         for ((t, r), amplitude) in (0_u32..).zip(residuals).zip(self.amplitudes) {
//!             *r = p[0] * (-p[1] * f64::from(t)).exp() - amplitude;
//!         }
//!         Ok(())
//!     }
//! }
//!
//! let parameters = [
//!     Parameter::new("amplitude", "a", "m"),
//!     Parameter::new("rate", "b", "1/s").bounded(Bounds::NOT_NEGATIVE),
//! ];
//! let problem = Decay { amplitudes: [2.003, 1.211, 0.738, 0.442, 0.271], parameters };
//! let fit = solve(&problem, &[1.0, 0.1], &Options::default())?;
//!
//! let rate = fit.estimate("rate").expect("a parameter");
//! assert!(fit.outcome().is_success() && fit.rank() == 2);
//! assert!((rate.value() - 0.501_354).abs() < 1e-4);
//! assert!((rate.standard_uncertainty().expect("determined") - 0.001_361).abs() < 1e-5);
//! println!("{fit}");
//! # Ok::<(), fmm_fit::FitError>(())
//! ```
//!
//! # Which item
//!
//! | question | item |
//! |---|---|
//! | fit a curve, or residuals of a closure | [`curve_fit`]; with options or weights [`curve`], [`ClosureProblem`] |
//! | fit once | [`solve`]; with progress and cancellation [`solve_observed`] |
//! | fit a hundred thousand times | [`Refit`] where only fixed values change; else [`Minimizer`], which keeps its buffers |
//! | fit under argmin's executor | [`BoundedLevenbergMarquardt`] |
//! | exact derivatives without writing any | [`Automatic`] |
//! | are my own derivatives right? | [`check_jacobian`]; [`solve`] looks once in debug builds |
//! | give each residual its uncertainty | [`Weighted`] |
//! | fix parameters, or add what is known of them | [`WithFixed`], [`WithPriors`] |
//! | let outliers count less | [`solve_robust`], as a problem of its own [`Robust`] |
//! | find the lowest of many minima | [`MultiStart`] |
//! | fit several records that share parameters | [`Joint`], [`Block`] |
//! | which parameters are determined? | [`Fit::null_directions`], [`Estimate::status`] |
//! | how well? | [`Fit::covariance`], [`Fit::interval`] |
//! | how well, where the model bends? | [`ProfileInterval`] |
//! | what is probable, where values end at bounds or priors count? | `posterior::Sampler` (feature `sampler`) |
//! | is the posterior by a model of my own right? | `posterior::Calibration` (feature `sampler`) |
//! | what do fixed values do to the estimates? | [`Sensitivity`]; by trials [`Refit`] |
//! | how well is the model known elsewhere? | [`Fit::predict`], [`Prediction`] |
//! | are the residuals independent, and how many count? | [`autocorrelation`], [`effective_count`] |
//! | is a further parameter worth having? | [`FTest`], [`Fit::corrected_akaike`] |
//! | which measurements next? | [`design::Information`], [`design::DesignSearch`] |
//! | which straight line, polynomial, columns? | [`StraightLine`], [`Polynomial`], [`LinearRegression`]: no start values |
//! | a line with uncertainties in both variables? | [`YorkLine`] |
//! | a line through results that differ by more than their uncertainties? | [`RandomEffectsLine`] |
//! | what had no finite value? | [`Fit::non_finite`] |
//!
//! # Start values, losses, bounds
//!
//! * **Start values** must lie within the bounds and have finite residuals. Where the sum of squares has several
//!   minima, give [`MultiStart`] bounds that mean something, or starts of your own.
//! * **Loss**: squares unless there are outliers. [`Loss::SoftL1`] and [`Loss::Huber`] keep problems with one minimum
//!   as they are; [`Loss::Cauchy`], [`Loss::Arctan`] and [`Loss::Tukey`] forget outliers and make further minima. A
//!   model that misses something has no outliers: find what it misses.
//! * **Bounds** are for what cannot be, such as a negative friction, and not for what is unlikely. A value on its bound
//!   has no uncertainty, and the others are those for the bound itself; [`Fit::relaxed_covariance`] has the larger
//!   ones.
//!
//! # Units and conventions
//!
//! Values are in the unit of their [`Parameter`]. The sum of squares is Σ r², without a half; a
//! [`RobustFit::cost`] is half of its sum, as in SciPy. Jacobians are stored column by column.
//!
//! # Guarantees
//!
//! * Bounds are never crossed, in differences neither, and active ones are met exactly.
//! * A difference whose step crosses a jump of the model is taken to the other side, and a step that rounding hides is
//!   lengthened.
//! * How a fit ends is an [`Outcome`] with the best point, errors are for what does not let it begin. A small step
//!   where the gradient does not vanish is [`Outcome::Stalled`] and no success.
//! * A trial point without finite residuals is no error: the search goes less far, and [`Fit::non_finite`] says what it
//!   was.
//! * What is not determined has no uncertainty, but a direction in words.
//! * The same problem, start and options give the same bits, a time limit aside, a [`MultiStart`] on any number
//!   of threads as well.
//!
//! # Cost
//!
//! Mostly the evaluations of the problem: some five to ten from a good start, with derivatives. The solver adds a
//! factorisation each, n (p + 1)(p + 2)/2 products for columns at wide angles and 2 n p² operations for others: 2 µs
//! for 1500 residuals and three parameters, 55 µs for twelve, on a Xeon at 2.8 GHz. Differences cost p evaluations more
//! each time. A joint fit costs the sum of its records. [`Minimizer`] and [`Refit`] use their memory again.
//!
//! # Features
//!
//! All are off by default.
//!
//! * `rayon`: [`MultiStart`] on all threads of the current pool, with the same result.
//! * `sampler`: the posterior of the parameters by the no-U-turn sampler of the crate nuts-rs, which brings faer along.
//!
//! # Neighbours
//!
//! [`fmm-identify`](https://docs.rs/fmm-identify) has the problems of ring-downs and impacts;
//! [`fmm-uq`](https://docs.rs/fmm-uq) propagates what is not in the residuals.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod algebra;
mod comparison;
pub mod design;
mod diagnostics;
mod error;
mod fitting;
#[cfg(feature = "sampler")]
pub mod posterior;
mod problem;
mod regression;
mod result;
mod robust;
mod solver;
mod uncertainty;

pub use comparison::FTest;
pub use diagnostics::{autocorrelation, autocorrelation_time, effective_count};
pub use error::FitError;
pub use fitting::argmin::BoundedLevenbergMarquardt;
pub use fitting::curve::{ClosureProblem, curve, curve_fit};
pub use fitting::joint::Joint;
pub use fitting::multi_start::MultiStart;
pub use fitting::solve::{solve, solve_observed};
pub use fmm_model::{Bounds, Dual, Parameter, Scalar};
pub use problem::automatic::{Automatic, Model};
pub use problem::block::Block;
pub use problem::knowledge::{WithFixed, WithPriors};
pub use problem::residuals::{Derivatives, EvaluationError, Residuals};
pub use problem::weighted::Weighted;
pub use regression::linear_regression::LinearRegression;
pub use regression::polynomial::{Polynomial, StraightLine};
pub use regression::random_effects_line::RandomEffectsLine;
pub use regression::weighting::Weighting;
pub use regression::york::{UncertainPoint, YorkLine};
pub use result::estimate::{Estimate, EstimateStatus};
pub use result::fit::Fit;
pub use result::null_direction::NullDirection;
pub use result::prediction::Prediction;
pub use robust::loss::Loss;
pub use robust::problem::Robust;
pub use robust::robust_fit::{RobustFit, median_deviation, solve_robust};
pub use solver::jacobian_check::{JacobianMismatch, check_jacobian};
pub use solver::minimizer::Minimizer;
pub use solver::options::Options;
pub use solver::outcome::{NonFinite, Outcome};
pub use uncertainty::profile_interval::{ProfileEnd, ProfileInterval, ResidualVariance};
pub use uncertainty::refit::Refit;
pub use uncertainty::sensitivity::Sensitivity;

/// The README's example, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
