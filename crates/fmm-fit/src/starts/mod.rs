//! Start values of a search, and the lowest of its minima.

mod halving;
mod minima;
mod multi_start;
mod start_points;

pub use halving::solve_best;
pub use minima::{Minima, Minimum, StartFailure};
pub use multi_start::MultiStart;
