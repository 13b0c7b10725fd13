//! Comparison of models.

pub(crate) mod contender;
pub(crate) mod model_comparison;
mod model_report;
pub(crate) mod model_table;
