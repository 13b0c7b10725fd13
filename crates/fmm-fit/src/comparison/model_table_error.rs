//! Errors of a comparison of models.

use fmm_model::Rounded;

/// Why models cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelTableError {
    /// There is no model.
    #[error("there is no model to compare")]
    NoContender,
    /// Two models have the same name.
    #[error("two models are called {name}")]
    SameName {
        /// The name.
        name: String,
    },
    /// A model is said to contain one that does not take part.
    #[error("{name} is said to contain {special}, which does not take part")]
    UnknownSpecialCase {
        /// The model.
        name: String,
        /// The name that no model has.
        special: String,
    },
    /// The models have different numbers of residuals, so they are not of the same data.
    #[error("{name} has {residuals} residuals instead of {expected}; models must be of the same data")]
    DifferentData {
        /// The model.
        name: String,
        /// Its number of residuals.
        residuals: usize,
        /// That of the first model.
        expected: usize,
    },
    /// A model leaves no residual to judge it by.
    #[error("{name} has {parameters} parameters for {residuals} residuals; at least two more residuals are needed")]
    TooFewResiduals {
        /// The model.
        name: String,
        /// Number of its parameters.
        parameters: usize,
        /// Number of residuals.
        residuals: usize,
    },
    /// Residuals of a model are not finite.
    #[error("the residuals of {name} are not finite")]
    NotFinite {
        /// The model.
        name: String,
    },
    /// The number of residuals to count, or another setting, makes no sense.
    #[error("the {setting} must be {expected}, but is {value}", value = Rounded::every_digit(*.value))]
    BadSetting {
        /// What was set.
        setting: &'static str,
        /// What it may be.
        expected: &'static str,
        /// The value given.
        value: f64,
    },
}
