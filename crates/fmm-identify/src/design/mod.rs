//! Design of the next tests: information of planned tests about machine and law.
//!
//! ```text
//! guess + planned test ── local ──> the problem of that experiment ── Jacobian, Schur complement, chain rule ──> information
//! information of tests + of what is known ── plan ──> predicted findings, the best set, a sentence for each test
//!                            levels in place of the law ── curve ──> predicted friction over the speed
//! ```

mod curve;
mod guess;
mod inputs;
mod local;
mod plan;
mod planned_test;
mod prediction;

pub use curve::PlannedCurve;
pub use guess::Guess;
pub use plan::{Aim, Plan};
pub use planned_test::{PlannedSensor, PlannedTest};
pub use prediction::DesignPrediction;
