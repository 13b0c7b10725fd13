//! Random numbers, and points that fill a cube more evenly than those.

mod sobol_directions;
pub(crate) mod sobol_sequence;
pub(crate) mod stream;
pub(crate) mod ziggurat;
