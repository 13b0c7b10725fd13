//! Least-squares problems: residuals as a function of parameters, and ways to write them.

pub(crate) mod automatic;
pub(crate) mod block;
pub(crate) mod knowledge;
pub(crate) mod residuals;
pub(crate) mod weighted;
