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
    /// Two parameters of which the first must be the greater.
    #[error("{greater} must be greater than {lesser}, but {greater} = {greater_value} and {lesser} = {lesser_value}")]
    NotOrdered {
        /// Symbol of the parameter that must be the greater.
        greater: &'static str,
        /// The value given for it.
        greater_value: f64,
        /// Symbol of the parameter that must be the lesser.
        lesser: &'static str,
        /// The value given for it.
        lesser_value: f64,
    },
    /// A condition between the parameters of a law does not hold; for laws of one's own.
    #[error("the parameters of the law {law} must satisfy {condition}")]
    Condition {
        /// Name of the law.
        law: &'static str,
        /// The condition, with the values that break it if they help.
        condition: String,
    },
    /// Shape parameters of a hysteresis loop that would create energy or grow without bound.
    #[error("a Bouc-Wen loop needs −β < γ ≤ β, but β = {beta} and γ = {gamma}")]
    NotDissipative {
        /// The β given.
        beta: f64,
        /// The γ given.
        gamma: f64,
    },
    /// No elements, or more than a [`Regime`](crate::Regime) can tell apart.
    #[error("a law of elements has 1 to {most} of them, but {got} were given")]
    ElementCount {
        /// How many were given.
        got: usize,
        /// How many there may be.
        most: usize,
    },
    /// The elements do not share the whole contact.
    #[error("the shares of the elements must sum to 1 within 1e-9, but sum to {sum}")]
    SharesNotOne {
        /// Their sum.
        sum: f64,
    },
    /// A law whose friction differs between growing and falling speed cannot be smoothed in the speed alone.
    #[error("a law that depends on the acceleration has two levels at one speed and cannot be smoothed in the speed")]
    DependsOnAcceleration,
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
