//! Values that other mathematics gives: 256-bit reference solutions, each with its own tolerance.

mod free_decay;
mod oracle;
mod sensitivities;
mod thesis_euler;
