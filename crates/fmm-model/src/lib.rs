//! Machine model for friction measurement: a single-degree-of-freedom oscillator with its damping and its spring, and
//! the types that all FMM crates share, such as [`Parameter`] (name, symbol, unit, bounds) and [`Scalar`] (the number
//! type that a formula is generic in).
//!
//! ```
//! use fmm_model::{Damping, Dual, Oscillator, Scalar};
//!
//! // The flexure machine of the thesis, Table 2.
//! let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::linear(0.275)?);
//! assert!((machine.natural_frequency() - 2.198_08).abs() < 5e-6);
//! assert!((machine.damping_ratio() - 9.581_25e-4).abs() < 1e-9);
//!
//! // The same formula with its derivative in the mass: ∂f₀/∂m = −f₀/2m.
//! let machine = Oscillator::new(Dual::<1>::variable(10.391, 0), Dual::from(1982.0))?;
//! let frequency = machine.natural_frequency();
//! assert!((frequency.partial(0) + frequency.value() / (2.0 * 10.391)).abs() < 1e-15);
//! # Ok::<(), fmm_model::ModelError>(())
//! ```
//!
//! # Which item
//!
//! | question | item |
//! |---|---|
//! | frequencies, damping ratio, decrement, energy of mass and spring | [`Oscillator`]; of a record whose mass is not known, [`Oscillator::per_unit_mass`] |
//! | a pendulum instead of a spring | [`Restoring::Sine`] |
//! | a spring that hardens or softens | [`Restoring::Polynomial`] |
//! | a spring with a stop, a preload or a gap | [`Restoring::stop`], [`Restoring::gap`] |
//! | damping in powers of the velocity | [`Damping`] |
//! | a line fitted to damping over *peak* velocities | [`Damping::from_peak_velocity_line`]; the line taken as a law of the velocity makes the drag 15 % too low |
//! | stiffness, stress, allowed deflection, parasitic motion of a guide | [`Flexure`], [`LeafSpring`] |
//! | the lean of a shaft from two displacements | [`Tilt`] |
//! | name, symbol, unit and limits of an unknown number | [`Parameter`], [`Bounds`] |
//! | units that are read, multiply and print, and their dimensions | [`Unit`], [`Dimension`] |
//! | a formula with exact derivatives | write it over [`Scalar`], evaluate it at [`Dual`] |
//! | a value with its standard uncertainty, and its form in a report | [`Estimated`], [`Rounded`] |
//! | an interval that covers a value, and its factor k | [`Interval`], `coverage_factor` (feature `student`) |
//!
//! # Units and conventions
//!
//! Everything is in SI units. A machine whose mass is not known is described *per unit mass*: stiffness in 1/s²,
//! damping in 1/s, force in m/s²; all formulas hold unchanged. Types of a number type `D` are those of `f64` unless
//! another is named.
//!
//! # Guarantees
//!
//! * Constructors check their arguments; a value that exists is valid, and its methods cannot fail. A result that does
//!   not exist, such as the damped frequency of an overdamped machine, is `None`.
//! * [`Dual`] gives the bits of `f64` as its value, so that branches do not depend on the number type.
//!
//! # Cost
//!
//! Only the texts of a [`Parameter`] made at run time allocate. A [`Dual`] of N directions costs one `f64`
//! operation and up to two products for each of the N. [`Damping::cycle_equivalent`] of a free power is a sum over a
//! cycle; all other functions take a few operations.
//!
//! # Neighbours
//!
//! [`fmm-friction`](https://docs.rs/fmm-friction) has the laws of the contact, [`fmm-sim`](https://docs.rs/fmm-sim)
//! moves the machine, [`fmm-fit`](https://docs.rs/fmm-fit) finds parameters,
//! [`fmm-identify`](https://docs.rs/fmm-identify) finds them in measured records.
//!
//! # Features
//!
//! | feature | |
//! |---|---|
//! | `std` | on by default: elementary functions of the standard library |
//! | `libm` | those of the crate libm where `std` is off, as on a controller; an allocator is needed all the same |
//! | `simd` | `widest`: work for the widest vectors of the processor, by the crate pulp |
//! | `schemars` | their JSON schemas |
//! | `serde` | intervals as text |
//! | `student` | coverage factors and quantiles of Student's t, by statrs |

#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!("fmm-model needs elementary functions: turn on one of the features `std` and `libm`");

mod damping;
mod dimension;
mod dual;
mod error;
mod estimate;
mod flexure;
mod math;
mod oscillator;
mod parameter;
mod restoring;
mod scalar;
#[cfg(feature = "student")]
mod student;
mod symbol;
mod unit;
#[cfg(feature = "simd")]
mod widest;

pub use damping::Damping;
pub use dimension::Dimension;
pub use dual::Dual;
pub use error::ModelError;
pub use estimate::{Estimated, Interval, Rounded};
pub use flexure::{Flexure, LeafSpring, Tilt};
pub use oscillator::Oscillator;
pub use parameter::{Bounds, Parameter};
pub use restoring::Restoring;
pub use scalar::Scalar;
#[cfg(feature = "student")]
pub use student::{coverage_factor, student_quantile};
pub use unit::Unit;
#[cfg(feature = "simd")]
pub use widest::widest;

/// The README's example, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
