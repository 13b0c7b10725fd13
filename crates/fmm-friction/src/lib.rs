//! Friction laws of a sliding contact, each with its formula written once, and with named and bounded parameters.
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
//!
//! # Which law
//!
//! | behaviour of the contact | law | not for |
//! |---|---|---|
//! | one level | [`Coulomb`] | a static level of its own: [`CoulombStatic`], which a free decay hardly shows |
//! | a level and a part proportional to the speed | [`CoulombViscous`] | telling that part from the damping of the machine |
//! | no dry friction | [`Viscous`], the hypothesis to be refuted | contacts that stop |
//! | falls with speed | [`Berger`] (exponential, to a floor), [`Hyperbolic`] (two parameters, to zero) | records of one amplitude: correlation of floor and excess −0.999 |
//! | falls, then rises | [`Stribeck`], [`StribeckLorentzian`] | records that do not cover both sides of the minimum |
//! | rises with a power of the speed | [`PowerLaw`] | stick-slip: it creeps above its floor |
//! | differs between growing and falling speed | [`AccelerationCoulomb`] (two levels), [`ExponentialPair`] (two curves) | smoothing |
//! | a peak over a smooth curve | [`MakkarDixon`], [`RegularisedStribeck`]; [`ShiftedMakkarDixon`] makes the first stick | holding a load: without the shift they creep |
//! | gives before it slides, path only | [`Dahl`], [`BoucWen`] or, by its level, [`BoucWenByLevel`] (one state), [`MaxwellSlip`] (elements) | records that do not resolve some micrometres |
//! | gives, lags and falls | [`LuGre`], [`Gms`] | fits without fixed constants: seven parameters and more |
//! | has to agree with another simulator | [`Karnopp`] (dead zone), [`Smoothed`] (any law times tanh) | anything else: their error grows with the zone |
//!
//! # The traits
//!
//! [`SlidingLaw`] is for laws of the sliding speed alone, which need a stick phase, and [`BristleLaw`] for laws with an
//! internal state, which do not; their pages state the contract of an implementor and its reasons.
//! [`PiecewiseLinearLaw`] marks the laws that move a linear machine in closed form. [`LawFamily`] names the parameters
//! and builds a law at any number type, for fits, budgets and reports. [`MaxwellSlip`] and [`Gms`] are lists of
//! elements; their families for a given number of elements are [`MaxwellSlipOf`] and [`GmsOf`]. A user's law that
//! implements it is simulated and fitted like these, as is, more slowly, an [`OwnLaw`] whose formula is known at run
//! time only. A family also states its kind: a [`LawVisitor`] has one method for
//! each kind of law, and [`catalogue()`] leads a [`FamilyVisitor`] through all families by name. A family states its
//! [`SearchRole`] too: the stages at which a search for the law of a record tries it.
//!
//! [`FeedForward`] follows a law with internal state along given velocities, for a controller that compensates friction.
//!
//! # Units and conventions
//!
//! All laws give a *coefficient*, the friction force divided by the normal load. With a normal load of 1 the
//! coefficient is the force itself (N); per unit mass it is F/m (m/s²). Speeds are in m/s and never negative: the
//! simulation sets the sign of the force, so that a law cannot push.
//!
//! # Guarantees
//!
//! * Constructors refuse parameters out of bounds and those that contradict each other: a static level below the
//!   sliding one, a loop that makes energy. The error names parameter, value, unit and bounds.
//! * The coefficient of a law is nowhere negative, and its limit at rest is not above the static level; states
//!   of bristle laws stay within their [`bound`](BristleLaw::bound).
//! * Special cases agree: [`Berger`] without excess is [`Coulomb`], bit for bit.
//!
//! # Cost
//!
//! A coefficient is a handful of operations: arithmetic alone for laws that are a level plus a slope, one exponential
//! for [`Berger`], four functions for [`MakkarDixon`]. Only [`MaxwellSlip`] and [`Gms`] allocate, when they are made.
//! [`ShiftedMakkarDixon`] searches its inflection once, when it is made, and so once for each evaluation of a fit.
//!
//! # Neighbours
//!
//! [`fmm-sim`](https://docs.rs/fmm-sim) moves a machine under a law, [`fmm-identify`](https://docs.rs/fmm-identify)
//! finds its parameters in a record, and [`fmm-model`](https://docs.rs/fmm-model) has the number types.
//!
//! # Features
//!
//! | feature | |
//! |---|---|
//! | `std` | on by default: elementary functions of the standard library |
//! | `libm` | those of the crate libm if `std` is off, for a controller; lists of elements and messages need an allocator |

#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

mod catalogue;
mod law;
mod laws;
#[cfg(test)]
mod tests;

pub use catalogue::{catalogue, family_named};
pub use law::{
    Affine, BristleLaw, Element, Expansion, FamilyMember, FamilyVisitor, FeedForward, LawError, LawFamily, LawKind,
    LawParameter, LawVisitor, OwnLaw, PiecewiseLinearLaw, Regime, Reparametrisation, Role, SearchRole, SearchStage,
    SearchTrial, SlidingLaw, SpecialCase, SpeedFormula,
};
pub use laws::{
    AccelerationCoulomb, Berger, BoucWen, BoucWenByLevel, Coulomb, CoulombStatic, CoulombViscous, Dahl,
    ExponentialPair, Gms, GmsOf, Hyperbolic, Karnopp, LuGre, MakkarDixon, MaxwellSlip, MaxwellSlipOf, PowerLaw,
    RegularisedStribeck, ShiftedMakkarDixon, Smoothed, Stribeck, StribeckLorentzian, Viscous,
};

/// The README's example, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
