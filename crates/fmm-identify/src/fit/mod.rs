//! The fit: the least-squares problem of the experiments by one law, where it begins and how it is solved.

pub(crate) mod forces;
pub(crate) mod response;
pub(crate) mod stages;
