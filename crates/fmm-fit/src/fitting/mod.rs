//! From a problem and a start to a result.

pub(crate) mod argmin;
pub(crate) mod curve;
pub(crate) mod joint;
pub(crate) mod solve;
