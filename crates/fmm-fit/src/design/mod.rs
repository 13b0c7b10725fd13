//! Design of experiments: the measurements with the most information, before they are made.

mod design_case;
mod exchange;
mod information;
mod search;

pub use design_case::{DesignCase, DesignCriterion, DesignUncertainty};
pub use information::Information;
pub use search::{ChosenDesign, DesignSearch};
