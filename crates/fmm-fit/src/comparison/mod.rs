//! Comparison of models.

pub(crate) mod contender;
pub(crate) mod model_comparison;
pub(crate) mod model_report;
pub(crate) mod model_table;
pub(crate) mod options;
pub(crate) mod verdict;
