//! Design of the next tests: what candidates would tell about machine and law before they are made.
//!
//! ```text
//! guess + planned test ── local ──> the experiment's own problem ── Jacobian, Schur complement, chain rule ──> information
//! information of tests + of what is known ── plan ──> predicted findings, the best set, in words what each tells
//! ```

mod guess;
mod inputs;
mod local;
mod plan;
mod planned_test;
mod prediction;
mod telling;

pub use guess::Guess;
pub use plan::{Aim, Plan};
pub use planned_test::{PlannedSensor, PlannedTest};
pub use prediction::DesignPrediction;
