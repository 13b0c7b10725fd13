//! Groups: results of several runs, operators, specimens or laboratories, and their differences.

mod analysis_of_variance;
mod consensus;
mod precision;

pub use analysis_of_variance::AnalysisOfVariance;
pub use consensus::{Consensus, RandomEffects};
pub use precision::{Outlier, Precision};
