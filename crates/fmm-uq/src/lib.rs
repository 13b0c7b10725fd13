//! Measurement uncertainty after the *Guide to the expression of uncertainty in measurement* (GUM, JCGM 100:2008) and
//! its supplements (JCGM 101:2008, JCGM 102:2011). A measurement is a set of [`Inputs`] and a function of them.
//!
//! ```
//! use fmm_uq::{Input, Inputs, MonteCarlo, Scalar, propagate};
//!
//! // Stiffness of a flexure from its mass and its natural frequency: k = m (2π f)².
//! fn stiffness<D: Scalar>(x: &[D]) -> D {
//!     let angular_frequency = x[1] * std::f64::consts::TAU;
//!     x[0] * angular_frequency * angular_frequency
//! }
//! let inputs = Inputs::new([
//!     Input::new("mass", 10.391, 0.005, "kg")?,
//!     Input::new("frequency", 2.198_08, 0.0004, "Hz")?.with_degrees_of_freedom(9.0)?,
//! ])?;
//! let budget = propagate(&inputs, stiffness)?.named("stiffness", "N/m");
//! assert!((budget.estimate() - 1982.0).abs() < 0.01);
//! assert!((budget.standard_uncertainty() - 1.1958).abs() < 5e-5);
//! let interval = budget.expanded(0.95)?;
//! assert_eq!(interval.degrees_of_freedom, 67.0);
//! assert!((interval.uncertainty - 2.39).abs() < 5e-3);
//!
//! let trials = MonteCarlo::new(&inputs, 100_000)?.run(stiffness)?;
//! // Student's t of ν = 9 spreads wider than its scale, by √(9/7): 1.257 N/m together with the mass.
//! assert!((trials.standard_uncertainty(0)? - 1.257).abs() < 0.015);
//! # Ok::<(), fmm_uq::UncertaintyError>(())
//! ```
//!
//! # Which item
//!
//! | question | answer | not for |
//! |---|---|---|
//! | what is known of an input? | [`Distribution`], [`Input`], [`Observations`] (type A), [`Inputs`] (correlated) | |
//! | uncertainty of the result of a nearly linear model? | [`propagate`], [`Gum`]: a [`Budget`] | models that jump; [`Linearisation`] flags models that bend too much |
//! | the same for a model that takes plain numbers, such as a fit? | [`Gum::propagate_by_differences`] | |
//! | uncertainty of the result of any other model? | [`MonteCarlo`]: an [`OutputSample`] | models of a second a trial, unless many machines share the run |
//! | how many trials? | [`Adaptive`], until the digits are stable | a cost that must be known in advance |
//! | is the interval of the GUM valid? | [`validate`], with [`Adaptive::for_validation`] | |
//! | which input matters? | [`Budget::contributions`]; with interactions [`VarianceShare`] (Sobol') | [`VarianceShare`]: correlated inputs |
//! | a trial takes a second? | many machines and [`PartialRun`]s | |
//! | the model is a text, known at run time only? | `Formula` (feature `formula`) | models with conditions or loops |
//! | does it keep its limits? | [`ToleranceInterval`]: specific risk, guard band, limits of acceptance | risks over a production, which need its spread |
//! | how is a result stated? | a [`Budget`] prints; [`Budget::statement`], [`MonteCarlo::statement`] | |
//! | what differs between runs, laboratories or specimens? | [`AnalysisOfVariance`], [`Precision`] | |
//! | which value do several results agree on? | [`Consensus`], [with what they share](Consensus::with_shared) | shared errors that nobody stated |
//! | several results together? | [`Propagation`] with its regions, [`OutputSample::ellipsoid`], [`OutputSample::rectangle`] | |
//!
//! Write a model once, generic in its number: `f64` for trials, [`Taylor`] for exact derivatives. A closure has one
//! number type: write it over [`Taylor`], and give trials [its values](Taylor::at_values).
//!
//! # Units and conventions
//!
//! The unit of an input is a label and is not converted: all must belong to one coherent system. Uncertainties are
//! standard ones. A number of degrees of freedom makes Student's t of a normal input. Levels are probabilities (0.95),
//! outputs are counted from 0.
//!
//! # Guarantees
//!
//! * The bits of a run depend on seed, inputs, model and number of trials: not on the number of threads, nor on how
//!   blocks are spread over machines of one kind.
//! * Invalid results are errors or flagged: impossible correlations, results that are not finite, degrees of
//!   freedom outside the Welch–Satterthwaite formula, a first-order uncertainty of zero, and failed trials.
//! * One failed trial is an error, unless [a share](MonteCarlo::with_allowed_failures) is allowed; then all failures
//!   are counted.
//!
//! # Cost
//!
//! | | for n inputs, M trials | on a Xeon at 2.8 GHz |
//! |---|---|---|
//! | [`propagate`] | n²/2 + 2n evaluations of [`Taylor`] numbers, n/2 for the first order alone | 4.5 µs for four inputs |
//! | [`MonteCarlo`] | M evaluations and n M draws; 8 bytes a value | 29 ns a trial of four normal inputs |
//! | intervals | M values partly sorted | 2 ns a trial; the shortest 4 to 8 ns |
//! | [`VarianceShare`] | M (n + 2) evaluations | 21 ns each |
//!
//! # Features
//!
//! All are off by default.
//!
//! * `formula`: models as text, `Formula`.
//! * `rayon`: blocks of trials on all threads of the current pool, with the same bits.
//! * `schemars`: JSON schemas of budgets and statements.
//! * `serde`: [`PartialRun`]s, failures, intervals, statements and budgets as text.
//!
//! # Neighbours
//!
//! [`fmm-fit`](https://docs.rs/fmm-fit) repeats a fit with other values of its fixed parameters (`Refit`): the model of
//! a Monte Carlo over a fit; [`fmm-model`](https://docs.rs/fmm-model) has the number types.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod conformity;
mod distributions;
mod error;
mod failure;
mod groups;
mod gum;
mod inputs;
mod model;
mod moments;
mod monte_carlo;
mod region;
mod rounding;
mod stream;
mod validation;

pub use conformity::ToleranceInterval;
pub use distributions::Distribution;
pub use error::UncertaintyError;
pub use failure::{Failure, FailureKind, Failures};
pub use fmm_model::Scalar;
pub use groups::{AnalysisOfVariance, Consensus, Outlier, Precision, RandomEffects};
pub use gum::{Budget, Contribution, Expanded, Gum, Linearisation, Propagation, SecondOrder, Statement, propagate};
pub use inputs::{Evaluation, Input, Inputs, Observations};
#[cfg(feature = "formula")]
pub use model::Formula;
pub use model::{ModelOutput, Taylor};
pub use moments::Moments;
pub use monte_carlo::{
    Adaptive, IntervalKind, MonteCarlo, OutputSample, PartialRun, Progress, TrialStatement, VarianceShare,
};
pub use region::Region;
pub use validation::{Validation, validate};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
