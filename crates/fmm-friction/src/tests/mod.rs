//! Properties of all laws, at random parameters.

mod bristle;
mod sliding;
