//! Start values of a search, and the lowest of its minima.

mod minima;
mod multi_start;
mod start_points;

pub use minima::{Minima, Minimum, StartFailure};
pub use multi_start::MultiStart;
