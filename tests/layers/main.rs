//! Floors of the house: crates among each other, rooms inside a crate, names at its root; and links of its pages.

mod crates;
mod links;
mod names;
mod rooms;
mod source;
