//! Estimators that take no simulation: from amplitudes, energies, the weak form of the equation of motion, and fits of
//! a few cycles.

pub(crate) mod banded;
mod decrement;
mod energy_rates;
mod free_vibration;
mod half_swings;
mod test_function;
mod turning_energies;
mod weak_equations;
mod weak_form;
mod windows;

pub use decrement::{Decrement, decrements};
pub use energy_rates::{EnergyMethod, EnergyRate, EnergyRates};
pub use turning_energies::{HalfSwing, half_swing_losses, half_swing_losses_of};
pub use weak_form::{WeakForm, WeakFormEstimate};
pub use windows::{WindowFit, Windows};
