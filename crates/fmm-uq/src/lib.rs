//! Measurement uncertainty after the *Guide to the expression of uncertainty in measurement* (GUM, JCGM 100:2008):
//! a measurement is a set of [`Inputs`] and a function of them; [`propagate`] gives the [`Budget`] of its result.
//!
//! ```text
//! y = f(x₁ … x_n),   u²(y) = Σᵢ Σⱼ c_i c_j u_i u_j r_ij,   c_i = ∂f/∂x_i
//! ```
//!
//! The sensitivities c are exact derivatives: the model is an ordinary closure over [`Dual`] numbers. Nothing is
//! reported in silence that does not hold: impossible correlations, results that are no numbers, degrees of
//! freedom outside the Welch–Satterthwaite formula, and a first-order uncertainty of zero are told apart.
//!
//! ```
//! use fmm_uq::{DualNum, Input, Inputs, propagate};
//!
//! // Stiffness of a flexure from its mass and its natural frequency: k = m (2π f)².
//! let inputs = Inputs::new([
//!     Input::new("mass", 10.391, 0.005, "kg")?,
//!     Input::new("frequency", 2.198_08, 0.0004, "Hz")?.with_degrees_of_freedom(9.0)?,
//! ])?;
//! let stiffness = propagate(&inputs, |x| x[0] * (x[1] * std::f64::consts::TAU).powi(2))?.named("stiffness", "N/m");
//! assert!((stiffness.estimate() - 1982.0).abs() < 0.01);
//! assert!((stiffness.standard_uncertainty() - 1.1958).abs() < 5e-5);
//! let interval = stiffness.expanded(0.95)?;
//! assert_eq!(interval.degrees_of_freedom, 67.0);
//! assert!((interval.uncertainty - 2.39).abs() < 5e-3);
//! # Ok::<(), fmm_uq::UncertaintyError>(())
//! ```

mod budget;
mod coverage;
mod error;
mod input;
mod inputs;
mod propagate;
mod table;

pub use budget::{Budget, Contribution, Expanded};
pub use coverage::coverage_factor;
pub use error::UncertaintyError;
pub use input::Input;
pub use inputs::Inputs;
pub use num_dual::DualNum;
pub use propagate::{Dual, propagate, try_propagate};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
