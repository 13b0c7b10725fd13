//! Posteriors whose moments have a closed form or come from quadrature.

mod bounded;
mod calibration;
mod closed_forms;
mod correlated;
mod problems;
mod refusals;
mod strd;
