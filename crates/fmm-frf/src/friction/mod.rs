//! Friction out of responses: from the height of a peak, its growth with the impulse, and the spectrum of the friction
//! force.

mod coulomb_line;
mod friction_spectrum;
mod impact;

pub use coulomb_line::CoulombLine;
pub use friction_spectrum::{FrictionSpectrum, Harmonic};
pub use impact::{
    coulomb_impact_duration, equivalent_damping_of_friction, friction_force_of_coulomb_impact,
    friction_force_of_viscous_coulomb_impact, peak_receptance_of_coulomb_impact,
    peak_receptance_of_viscous_coulomb_impact,
};
