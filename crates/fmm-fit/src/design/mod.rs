//! Design of experiments: which measurements tell most about the parameters, before they are made.

mod chosen_design;
mod design_case;
mod design_error;
mod exchange;
mod information;
mod search;

pub use chosen_design::ChosenDesign;
pub use design_case::{DesignCase, DesignCriterion};
pub use design_error::DesignError;
pub use information::Information;
pub use search::DesignSearch;
