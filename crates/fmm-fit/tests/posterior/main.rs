//! Posteriors whose moments have a closed form or come from quadrature.

mod bounded;
mod closed_forms;
mod correlated;
mod problems;
mod refusals;
mod strd;
