//! What can be wrong with inputs, with a model and with a question put to a budget.

/// Why an uncertainty could not be stated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UncertaintyError {
    /// An input without a name cannot be told apart in a budget.
    #[error("an input needs a name, but the one of value {value} {unit} has none")]
    Unnamed {
        /// The value given.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// The estimate of an input is infinite or not a number.
    #[error("the value of {input} must be finite, but is {value} {unit}")]
    ValueNotFinite {
        /// Which input.
        input: String,
        /// The value given.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// A standard uncertainty is negative or not finite.
    #[error("the standard uncertainty of {input} must be zero or positive and finite, but is {value} {unit}")]
    UncertaintyOutOfRange {
        /// Which input, or "the result".
        input: String,
        /// The standard uncertainty.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// Degrees of freedom below 1 or not a number.
    #[error("the degrees of freedom of {of} must be at least 1 and may be infinite, but are {value}")]
    DegreesOfFreedomOutOfRange {
        /// Which input, or "the result".
        of: String,
        /// The degrees of freedom given.
        value: f64,
    },
    /// A model of no inputs has no uncertainty to propagate.
    #[error("at least one input is needed, but none was given")]
    NoInputs,
    /// Two inputs of the same name.
    #[error("each input needs a name of its own, but `{name}` is given twice")]
    DuplicateName {
        /// The name given twice.
        name: String,
    },
    /// A correlation with an input that does not exist.
    #[error("there is no input `{name}`; the inputs are {known}")]
    UnknownName {
        /// The name given.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// A correlation of an input with itself; it is 1 and cannot be set.
    #[error("the correlation of `{name}` with itself is 1 and cannot be set")]
    SelfCorrelation {
        /// The name given on both sides.
        name: String,
    },
    /// The same pair of inputs twice in one list of correlations.
    #[error("the correlation of `{first}` and `{second}` is given twice")]
    RepeatedPair {
        /// One of the pair.
        first: String,
        /// The other.
        second: String,
    },
    /// A correlation coefficient outside [−1, 1] or not a number.
    #[error("the correlation of `{first}` and `{second}` must lie in [-1, 1], but is {value}")]
    CorrelationOutOfRange {
        /// One of the pair.
        first: String,
        /// The other.
        second: String,
        /// The coefficient given.
        value: f64,
    },
    /// Correlation coefficients that no set of quantities can have together.
    #[error(
        "no quantities can be correlated like this: the smallest eigenvalue of the correlation matrix is \
         {smallest_eigenvalue:.3e}, and it must not be negative"
    )]
    NotPositiveSemidefinite {
        /// The smallest eigenvalue of the matrix (1).
        smallest_eigenvalue: f64,
    },
    /// The model itself reported an error.
    #[error("the model failed at {at}")]
    ModelFailed {
        /// The values of the inputs.
        at: String,
        /// What the model reported.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The model gave an infinite result or no number.
    #[error("the model gives {result} at {at}")]
    ResultNotFinite {
        /// The result.
        result: f64,
        /// The values of the inputs.
        at: String,
    },
    /// A sensitivity is infinite or not a number, or its product with the uncertainty overflows.
    #[error("the sensitivity to {input} is {sensitivity}, which cannot be propagated, at {at}")]
    SensitivityNotFinite {
        /// Which input.
        input: String,
        /// The derivative of the result with respect to it.
        sensitivity: f64,
        /// The values of the inputs.
        at: String,
    },
    /// The model gave different results for the same values.
    #[error("the model gives {first}, then {again}, for the same values {at}; it must be deterministic")]
    ModelNotRepeatable {
        /// The first result.
        first: f64,
        /// The differing result.
        again: f64,
        /// The values of the inputs.
        at: String,
    },
    /// The first-order uncertainty is zero although inputs are uncertain, so that no interval follows from it.
    #[error(
        "the first-order uncertainty is zero although inputs are uncertain: the linear approximation cannot see \
         them, and no coverage interval follows from it"
    )]
    LinearisationSuspect,
    /// The Welch–Satterthwaite formula does not hold, so that a coverage factor has to be chosen by the caller.
    #[error(
        "inputs of finite degrees of freedom are correlated, where the Welch-Satterthwaite formula does not hold; \
         choose the degrees of freedom and use coverage_factor"
    )]
    DegreesOfFreedomUndefined,
    /// A coverage probability that is not strictly between 0 and 1.
    #[error("the coverage probability must lie between 0 and 1, such as 0.95, but is {level}")]
    LevelOutOfRange {
        /// The probability given.
        level: f64,
    },
    /// Two budgets compared that do not rest on the same inputs.
    #[error("the two budgets do not rest on the same inputs, so that their covariance is not known")]
    DifferentInputs,
}
