//! Results and budgets as text.

pub(crate) mod rounding;
mod statement;
mod table;

pub use statement::{Statement, TrialStatement};
