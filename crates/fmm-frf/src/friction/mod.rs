//! Friction out of responses: from the height of a peak, its growth with the impulse, and the spectrum of the friction
//! force.

mod coulomb_line;
mod friction_spectrum;
mod impact;

pub use coulomb_line::CoulombLine;
pub use friction_spectrum::{FrictionSpectrum, Harmonic};
pub use impact::coulomb_impact_duration;
