//! Where to begin, and which of many ends is the lowest.

mod minima;
mod multi_start;
mod start_points;

pub use minima::{Minima, Minimum, StartFailure};
pub use multi_start::MultiStart;
