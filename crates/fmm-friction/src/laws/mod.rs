//! The laws, a file for laws of one kind.

mod acceleration;
mod bouc_wen;
mod dahl;
mod gms;
mod levels;
mod lugre;
mod makkar_dixon;
mod maxwell_slip;
mod of_speed;
mod regularised;
mod stribeck;

pub use acceleration::{AccelerationCoulomb, ExponentialPair};
pub use bouc_wen::{BoucWen, BoucWenByLevel};
pub use dahl::Dahl;
pub use gms::{Gms, GmsOf};
pub use levels::{Coulomb, CoulombStatic, CoulombViscous, Viscous};
pub use lugre::LuGre;
pub use makkar_dixon::{MakkarDixon, ShiftedMakkarDixon};
pub use maxwell_slip::{MaxwellSlip, MaxwellSlipOf};
pub use of_speed::{Berger, Hyperbolic, PowerLaw};
pub use regularised::{Karnopp, RegularisedStribeck, Smoothed};
pub use stribeck::{Stribeck, StribeckLorentzian};
