//! What a sliding contact *does*: friction laws, each its formula written once.
//!
//! A law is generic in its number type [`Scalar`](fmm_model::Scalar): at `f64` it gives the friction
//! coefficient, at a dual number also the exact derivative in every parameter. Its parameters are named fields
//! with symbol and unit, and [`LawFamily`] lists them, so that a fit, a budget or a report can speak of them.
//!
//! Two small traits say what a law is: [`SlidingLaw`] for laws of the sliding speed alone, which need a stick
//! phase, and [`BristleLaw`] for laws with an internal state, which do not. [`AffineLaw`] marks the sliding laws
//! that are a level plus a slope and can therefore be simulated in closed form.
//!
//! All laws give a *coefficient*, the friction force divided by the normal load. With a normal load of 1 the
//! coefficient is the force itself.
//!
//! ```
//! use fmm_friction::{CoulombViscous, LawFamily, SlidingLaw};
//! use fmm_model::{Dual, Scalar};
//!
//! let law = CoulombViscous::new(0.15, 0.02)?;
//! assert_eq!(law.coefficient(0.5), 0.16);
//! assert_eq!(law.breakaway(), 0.15);
//!
//! // The same formula with derivatives in both parameters.
//! let law = CoulombViscous::at(&[Dual::<2>::variable(0.15, 0), Dual::variable(0.02, 1)])?;
//! let coefficient = law.coefficient(Dual::from(0.5));
//! assert_eq!((coefficient.partial(0), coefficient.partial(1)), (1.0, 0.5));
//! # Ok::<(), fmm_friction::LawError>(())
//! ```

mod affine;
mod coulomb;
mod coulomb_static;
mod coulomb_viscous;
mod dahl;
mod error;
mod family;
mod law;
mod viscous;

pub use affine::{Affine, AffineLaw};
pub use coulomb::Coulomb;
pub use coulomb_static::CoulombStatic;
pub use coulomb_viscous::CoulombViscous;
pub use dahl::Dahl;
pub use error::LawError;
pub use family::{LawFamily, LawParameter, Role};
pub use law::{BristleLaw, SlidingLaw};
pub use viscous::Viscous;

/// The README's example, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
