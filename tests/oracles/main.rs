//! Values that other mathematics gives: 256-bit reference solutions, each with its own tolerance.

mod bristle;
mod free_decay;
mod identities;
mod impact;
mod laws;
mod oracle;
mod sensitivities;
mod stick_slip;
mod thesis_euler;
