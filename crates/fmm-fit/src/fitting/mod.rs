//! Fits: a problem and a start in, a result out.

pub(crate) mod argmin;
pub(crate) mod curve;
pub(crate) mod joint;
pub(crate) mod multi_start;
pub(crate) mod solve;
