//! Free decays before a fit: their modes, and frequency and damping over the amplitude.

mod backbone;
mod decay_modes;
mod half_cycles;
mod isolated;
mod local;
mod point;
mod spring;
mod suggestion;

pub use backbone::{Backbone, BackboneOptions};
pub use decay_modes::{DecayMode, decay_modes};
pub use isolated::IsolatedMode;
pub use point::BackbonePoint;
pub use suggestion::{DampingTerm, DampingTermKind, Suggestion};
