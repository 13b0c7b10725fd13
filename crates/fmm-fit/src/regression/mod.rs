//! Models that are linear in their parameters or nearly so, without a start.

pub(crate) mod double_double;
pub(crate) mod linear_regression;
pub(crate) mod polynomial;
pub(crate) mod random_effects_line;
pub(crate) mod refined_least_squares;
pub(crate) mod weighting;
pub(crate) mod york;
