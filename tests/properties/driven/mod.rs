//! Machines under every law, force, damping and restoring force, on the engines that take them.

mod agreement;
mod bristles;
mod contact;
mod energy;
mod gradient;
mod hard;
mod missed;
mod modes;
mod reversal;
mod sampling;
mod setup;
mod symmetry;
