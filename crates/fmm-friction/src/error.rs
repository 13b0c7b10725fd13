//! What can be wrong with the parameters of a law.

/// Parameters that make no law.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// A parameter is not finite or lies outside its bounds.
    #[error("{parameter} must lie in [{lower}, {upper}] {unit}, but is {value}")]
    OutOfBounds {
        /// Name of the parameter.
        parameter: String,
        /// The value given.
        value: f64,
        /// Its unit.
        unit: String,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// The static level is below the sliding level at zero speed, so the contact would slip while it sticks.
    #[error("the static coefficient {breakaway} must not be below the sliding coefficient {sliding}")]
    StaticBelowSliding {
        /// The static level given.
        breakaway: f64,
        /// The sliding level at zero speed.
        sliding: f64,
    },
    /// The wrong number of parameter values.
    #[error("the law {law} has {expected} parameters, but {got} values were given")]
    WrongCount {
        /// Name of the law.
        law: &'static str,
        /// How many it has.
        expected: usize,
        /// How many were given.
        got: usize,
    },
}
