//! A scenario file and the motion it describes.
//!
//! ```text
//! text ── file ──> Simulation ── run ──> Motion ──> JSON or text
//!           │
//!           └─ catalogue: a law by its name, its parameters by name or symbol
//! ```

mod catalogue;
mod contact;
mod entries;
mod file;
mod keys;
mod law;
mod motion;
mod plan;
mod run;
#[cfg(test)]
mod tests;

pub(crate) use catalogue::{Entry, laws};
pub(crate) use contact::EngineName;
pub(crate) use entries::{Entries, Field};
pub(crate) use keys::Slot;
pub(crate) use law::given_twice;
pub(crate) use motion::Motion;
pub(crate) use plan::Plan;
pub(crate) use run::Simulation;
