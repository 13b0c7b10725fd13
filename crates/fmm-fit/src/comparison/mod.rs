//! Comparison of models.

mod contender;
mod model_comparison;
mod model_report;
mod model_table;
mod model_table_error;
mod options;
mod verdict;

pub use contender::Contender;
pub use model_comparison::{ComparisonError, FTest, f_tail, f_test};
pub use model_table::{ModelRow, ModelTable, NestedComparison};
pub use model_table_error::ModelTableError;
pub use options::{ComparisonOptions, Criterion, ResidualCount};
pub use verdict::{Doubt, Verdict};
