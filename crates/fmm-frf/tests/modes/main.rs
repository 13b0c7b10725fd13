//! Modes of structures with many, by closed forms, with noise, and refused.

mod chain;
mod closed_forms;
mod coverage;
mod other_programs;
mod refusals;
