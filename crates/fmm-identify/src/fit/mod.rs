//! The fit: the least-squares problem of the experiments by one law, where it begins and how it is solved.

pub(crate) mod first_guess;
pub(crate) mod free_vibration;
pub(crate) mod identification;
pub(crate) mod layout;
mod machine_problem;
pub(crate) mod pool;
pub(crate) mod problem;
mod profile;
pub(crate) mod response;
pub(crate) mod stages;
pub(crate) mod tangent;
pub(crate) mod threads;

pub use identification::{FittedMotion, Identification, identify, identify_observed, identify_with};
pub use machine_problem::MachineProblem;
pub use problem::Problem;
pub use profile::{Profile, Profiles};
