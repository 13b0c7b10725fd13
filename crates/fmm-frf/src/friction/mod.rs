//! Friction out of responses: from the height of a peak, its growth with the impulse, and the spectrum of the friction
//! force.

mod coulomb_impact;
mod coulomb_line;
mod describing_function;
mod friction_spectrum;
mod viscous_coulomb_impact;

pub use coulomb_impact::{
    coulomb_impact_duration, friction_force_of_coulomb_impact, peak_receptance_of_coulomb_impact,
};
pub use coulomb_line::{CoulombLine, friction_force_of_slope};
pub use describing_function::equivalent_damping_of_friction;
pub use friction_spectrum::{FrictionSpectrum, Harmonic};
pub use viscous_coulomb_impact::{friction_force_of_viscous_coulomb_impact, peak_receptance_of_viscous_coulomb_impact};
