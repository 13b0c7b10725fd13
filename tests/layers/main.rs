//! Floors of the house: crates among each other, rooms inside a crate, names at its root.

mod crates;
mod names;
mod rooms;
mod source;
