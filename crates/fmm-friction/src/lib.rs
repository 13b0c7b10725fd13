//! What a sliding contact *does*: friction laws, each its formula written once.
//!
//! A law is generic in its number type [`Scalar`](fmm_model::Scalar): at `f64` it gives the friction
//! coefficient, at a dual number also the exact derivative in every parameter. Its parameters are named fields
//! with symbol and unit, and [`LawFamily`] lists them, so that a fit, a budget or a report can speak of them.
//!
//! Two small traits say what a law is: [`SlidingLaw`] for laws of the sliding speed alone, which need a stick
//! phase, and [`BristleLaw`] for laws with an internal state, which do not. [`PiecewiseLinearLaw`] marks
//! the laws that can be simulated in closed form. [`Shifted`] and [`Smoothed`] make a law of another law.
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

mod acceleration_coulomb;
mod affine;
mod berger;
mod blend;
mod bouc_wen;
mod coulomb;
mod coulomb_static;
mod coulomb_viscous;
mod dahl;
mod elements;
mod error;
mod exponential_pair;
mod family;
mod gms;
mod hyperbolic;
mod karnopp;
mod law;
mod lugre;
mod makkar_dixon;
mod maxwell_slip;
mod power;
mod power_law;
mod regularised_stribeck;
mod shifted;
mod smoothed;
mod stribeck;
mod stribeck_lorentzian;
mod viscous;

#[cfg(test)]
mod bristle_properties;
#[cfg(test)]
mod sliding_properties;

pub use acceleration_coulomb::AccelerationCoulomb;
pub use affine::{Affine, Element, PiecewiseLinearLaw};
pub use berger::Berger;
pub use bouc_wen::BoucWen;
pub use coulomb::Coulomb;
pub use coulomb_static::CoulombStatic;
pub use coulomb_viscous::CoulombViscous;
pub use dahl::Dahl;
pub use error::LawError;
pub use exponential_pair::ExponentialPair;
pub use family::{LawFamily, LawParameter, Role};
pub use gms::Gms;
pub use hyperbolic::Hyperbolic;
pub use karnopp::Karnopp;
pub use law::{BristleLaw, Regime, SlidingLaw};
pub use lugre::LuGre;
pub use makkar_dixon::MakkarDixon;
pub use maxwell_slip::MaxwellSlip;
pub use power_law::PowerLaw;
pub use regularised_stribeck::RegularisedStribeck;
pub use shifted::{Inflected, Shifted};
pub use smoothed::Smoothed;
pub use stribeck::Stribeck;
pub use stribeck_lorentzian::StribeckLorentzian;
pub use viscous::Viscous;

/// The README's example, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
