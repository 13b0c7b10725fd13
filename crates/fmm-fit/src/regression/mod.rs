//! Models that are linear in their parameters or nearly so, without a start.

mod linear_regression;
mod polynomial;
mod power_law;
mod random_effects_line;
mod refined_least_squares;
mod regression_error;
mod straight_line;
mod twofold;
mod weighting;
mod york;

pub use linear_regression::LinearRegression;
pub use polynomial::Polynomial;
pub use power_law::PowerLaw;
pub use random_effects_line::RandomEffectsLine;
pub use regression_error::RegressionError;
pub use straight_line::StraightLine;
pub use weighting::Weighting;
pub use york::{UncertainPoint, YorkLine};
