//! Errors of the parameters of a law.

use alloc::format;
use alloc::string::String;
use core::error::Error;
use core::fmt;

use fmm_model::{Bounds, Parameter, Rounded};

/// Parameters that make no law: a category to act on, and a sentence with the values.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LawError {
    /// A parameter is not finite or lies outside its bounds: give another value.
    OutOfBounds {
        /// The parameter, its bounds and the value.
        what: String,
        /// The value given.
        value: f64,
    },
    /// Parameters contradict each other, or a law and its use do: change one of them.
    Contradiction {
        /// The condition, with the values that break it.
        what: String,
    },
    /// The wrong number of values or elements: give as many as the law has.
    WrongCount {
        /// The law, and the numbers expected and given.
        what: String,
        /// Number of values given.
        got: usize,
    },
}

impl fmt::Display for LawError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfBounds { what, .. } | Self::Contradiction { what } | Self::WrongCount { what, .. } => {
                f.write_str(what)
            }
        }
    }
}

impl Error for LawError {}

/// All digits of a value.
pub(crate) fn digits(value: f64) -> impl fmt::Display {
    Rounded::every_digit(value)
}

impl LawError {
    /// A `value` that is not finite or lies outside the bounds of its `parameter`.
    pub(crate) fn out_of_bounds(parameter: &Parameter, value: f64) -> Self {
        let (name, bounds) = (parameter.name(), parameter.bounds());
        let bounds = Bounds::UNBOUNDED.at_least(bounds.lower()).at_most(bounds.upper());
        let unit = if parameter.unit() == "1" { String::new() } else { format!(" {}", parameter.unit()) };
        // Beside an infinite value, one finite bound does not say what is wrong.
        let is_half = bounds.lower().is_finite() != bounds.upper().is_finite();
        let finite = if is_half && !value.is_finite() { " and finite" } else { "" };
        Self::OutOfBounds { what: format!("{name} must be {bounds}{unit}{finite}, but is {}", digits(value)), value }
    }

    /// A static level below the sliding level at zero speed: the contact would slip while it sticks.
    pub(crate) fn static_below_sliding(breakaway: f64, sliding: f64) -> Self {
        let [breakaway, sliding] = [breakaway, sliding].map(digits);
        Self::Contradiction {
            what: format!("the static coefficient {breakaway} must not be below the sliding coefficient {sliding}"),
        }
    }

    /// A number of values that is not that of the law's parameters.
    pub(crate) fn wrong_count(law: &str, expected: usize, got: usize) -> Self {
        Self::WrongCount { what: format!("the law {law} has {expected} parameters, but {got} values were given"), got }
    }
}
