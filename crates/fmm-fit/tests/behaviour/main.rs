//! Promises of the solver, and of all that uses it, beyond the numbers of the oracles.

mod curvature;
mod differences;
mod evaluations;
mod refit;
mod robust;
mod searches;
mod solver;
