//! Errors of the parameters of a law.

use alloc::format;
use alloc::string::String;
use core::error::Error;
use core::fmt;

use fmm_model::{Bounds, Rounded};

/// Parameters that make no law.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LawError {
    /// A parameter is not finite or lies outside its bounds.
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
    StaticBelowSliding {
        /// The static level given.
        breakaway: f64,
        /// The sliding level at zero speed.
        sliding: f64,
    },
    /// Two parameters of which the first must be the greater.
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
    Condition {
        /// Name of the law.
        law: &'static str,
        /// The condition, with the values that break it if they help.
        condition: String,
    },
    /// Shape parameters of a hysteresis loop that would create energy or grow without bound.
    NotDissipative {
        /// The β given.
        beta: f64,
        /// The γ given.
        gamma: f64,
    },
    /// No elements, or more than a [`Regime`](crate::Regime) can tell apart.
    ElementCount {
        /// Number of elements given.
        got: usize,
        /// Largest number of elements.
        most: usize,
    },
    /// The elements do not share the whole contact.
    SharesNotOne {
        /// Their sum.
        sum: f64,
    },
    /// A law whose friction differs between growing and falling speed cannot be smoothed in the speed alone.
    DependsOnAcceleration,
    /// The wrong number of parameter values.
    WrongCount {
        /// Name of the law.
        law: &'static str,
        /// Number of parameters of the law.
        expected: usize,
        /// Number of values given.
        got: usize,
    },
}

impl fmt::Display for LawError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = |value: &f64| Rounded::every_digit(*value);
        match self {
            Self::OutOfBounds { parameter, value, unit, lower, upper } => {
                let bounds = Bounds::UNBOUNDED.at_least(*lower).at_most(*upper);
                let unit = if unit == "1" { "" } else { &format!(" {unit}") };
                // Of an infinite value, one bound that is a number does not say what is wrong.
                let is_half = lower.is_finite() != upper.is_finite();
                let finite = if is_half && !value.is_finite() { " and finite" } else { "" };
                write!(f, "{parameter} must be {bounds}{unit}{finite}, but is {}", digits(value))
            }
            Self::StaticBelowSliding { breakaway, sliding } => {
                let [breakaway, sliding] = [breakaway, sliding].map(digits);
                write!(f, "the static coefficient {breakaway} must not be below the sliding coefficient {sliding}")
            }
            Self::NotOrdered { greater, greater_value, lesser, lesser_value } => {
                let [most, least] = [greater_value, lesser_value].map(digits);
                write!(f, "{greater} must be greater than {lesser}, but {greater} = {most} and {lesser} = {least}")
            }
            Self::Condition { law, condition } => write!(f, "the parameters of the law {law} must satisfy {condition}"),
            Self::NotDissipative { beta, gamma } => {
                let [beta, gamma] = [beta, gamma].map(digits);
                write!(f, "a Bouc-Wen loop needs −β < γ ≤ β, but β = {beta} and γ = {gamma}")
            }
            Self::ElementCount { got, most } => {
                write!(f, "a law of elements has 1 to {most} of them, but {got} were given")
            }
            Self::SharesNotOne { sum } => {
                write!(f, "the shares of the elements must sum to 1 within 1e-9, but sum to {}", digits(sum))
            }
            Self::DependsOnAcceleration => f.write_str(
                "a law that depends on the acceleration has two levels at one speed and cannot be smoothed in the speed",
            ),
            Self::WrongCount { law, expected, got } => {
                write!(f, "the law {law} has {expected} parameters, but {got} values were given")
            }
        }
    }
}

impl Error for LawError {}
