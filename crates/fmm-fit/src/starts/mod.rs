//! Start values of a search, and the lowest of its minima.

pub(crate) mod halving;
pub(crate) mod minima;
pub(crate) mod multi_start;
pub(crate) mod start_points;
