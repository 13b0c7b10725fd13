//! What the solver and what stands on it promise, beyond the numbers that the oracles hold.

mod curvature;
mod differences;
mod evaluations;
mod refit;
mod robust;
mod searches;
mod solver;
