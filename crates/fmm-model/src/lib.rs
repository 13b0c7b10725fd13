//! What a friction measuring machine *is*: a single-degree-of-freedom oscillator with its damping, and the two
//! words that all FMM crates share, [`Parameter`] (name, symbol, unit, bounds) and [`Scalar`] (the number type
//! that a formula is generic in).
//!
//! | what | for |
//! |---|---|
//! | [`Oscillator`], [`Restoring`] | mass and spring: frequencies, damping ratio, logarithmic decrement, energies |
//! | [`Damping`] | damping in powers of the velocity, and the viscous damping it amounts to over a cycle |
//! | [`Flexure`], [`LeafSpring`] | leaf springs that guide a platform: stiffness, stress, allowed deflection, parasitic motion |
//! | [`Tilt`] | the lean of a shaft from two displacements |
//! | [`Parameter`], [`Bounds`], [`Rounded`] | names, symbols, units, limits, and values as they are written |
//! | [`Scalar`], [`Dual`] | formulas written once, with exact derivatives on request |
//!
//! Everything is in SI units. A machine whose mass is not known is described *per unit mass*: stiffness in
//! 1/s², damping in 1/s, force in m/s²; all formulas hold unchanged.
//!
//! ```
//! use fmm_model::{Damping, Oscillator};
//!
//! // The flexure machine of the thesis, Table 2.
//! let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::linear(0.275)?);
//! assert!((machine.natural_frequency() - 2.198_08).abs() < 5e-6);
//! assert!((machine.damping_ratio() - 9.581_25e-4).abs() < 1e-9);
//! # Ok::<(), fmm_model::ModelError>(())
//! ```

mod bounds;
mod damping;
mod dual;
mod error;
mod flexure;
mod leaf_spring;
mod oscillator;
mod parameter;
mod restoring;
mod rounded;
mod scalar;
mod tilt;
mod widest;

pub use bounds::Bounds;
pub use damping::Damping;
pub use dual::Dual;
pub use error::ModelError;
pub use flexure::Flexure;
pub use leaf_spring::LeafSpring;
pub use oscillator::Oscillator;
pub use parameter::Parameter;
pub use restoring::Restoring;
pub use rounded::Rounded;
pub use scalar::Scalar;
pub use tilt::Tilt;
pub use widest::widest;

/// The README's example, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
