//! What can be wrong with a record, a response and an oscillator.

use crate::ResponseForm;

/// Why a frequency response or an impulse could not be stated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrfError {
    /// A quantity that must be positive is zero, negative or not finite.
    #[error("{quantity} must be positive and finite, but is {value} {unit}")]
    NotPositive {
        /// Which quantity.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// Its SI unit.
        unit: &'static str,
    },
    /// A quantity that must not be negative is negative or not finite.
    #[error("{quantity} must be zero or positive and finite, but is {value} {unit}")]
    Negative {
        /// Which quantity.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// Its SI unit.
        unit: &'static str,
    },
    /// A quantity that may have either sign is infinite or not a number.
    #[error("{quantity} must be finite, but is {value} {unit}")]
    NotFinite {
        /// Which quantity.
        quantity: &'static str,
        /// The value given or found.
        value: f64,
        /// Its SI unit.
        unit: &'static str,
    },
    /// A sample that is infinite or not a number.
    #[error("sample {index} of the force must be finite, but is {value} N")]
    SampleNotFinite {
        /// Which sample, counted from 0.
        index: usize,
        /// Its value (N).
        value: f64,
    },
    /// Too few samples to integrate.
    #[error("an impulse needs at least two samples of the force, but there are {found}")]
    TooFewSamples {
        /// How many samples there are.
        found: usize,
    },
    /// Samples for the baseline that do not exist.
    #[error("the baseline needs samples {start} to {end} (excluded), but the record has {length}, from 0 on")]
    BaselineRange {
        /// First sample asked for.
        start: usize,
        /// One past the last sample asked for.
        end: usize,
        /// How many samples there are.
        length: usize,
    },
    /// A response whose frequencies and values are not of one number.
    #[error("a response needs one value for each of its frequencies, but has {frequencies} and {values}")]
    LengthMismatch {
        /// How many frequencies were given.
        frequencies: usize,
        /// How many values were given.
        values: usize,
    },
    /// Frequencies that are negative, not finite or do not increase.
    #[error("frequencies must be finite, not negative and increasing, but line {index} is at {frequency} Hz")]
    FrequenciesNotIncreasing {
        /// Which line, counted from 0.
        index: usize,
        /// Its frequency (Hz).
        frequency: f64,
    },
    /// A response that is infinite or not a number.
    #[error("the {form} at {frequency} Hz must be finite")]
    ValueNotFinite {
        /// The form of the response.
        form: ResponseForm,
        /// The frequency (Hz).
        frequency: f64,
    },
    /// A division by iω at zero frequency, or a factor so extreme that the value overflows.
    #[error("no finite {to} follows from the {from} at {frequency} Hz")]
    NoFiniteForm {
        /// The form given.
        from: ResponseForm,
        /// The form asked for.
        to: ResponseForm,
        /// The frequency (Hz).
        frequency: f64,
    },
    /// An undamped oscillator at its natural frequency.
    #[error("the oscillator has no finite receptance at {frequency} Hz, where it is in resonance without damping")]
    UndampedResonance {
        /// The frequency (Hz).
        frequency: f64,
    },
}

impl FrfError {
    /// Passes `value` through if it is positive and finite.
    pub(crate) fn require_positive(quantity: &'static str, value: f64, unit: &'static str) -> Result<f64, Self> {
        if value > 0.0 && value.is_finite() { Ok(value) } else { Err(Self::NotPositive { quantity, value, unit }) }
    }

    /// Passes `value` through if it is zero or positive and finite.
    pub(crate) fn require_not_negative(quantity: &'static str, value: f64, unit: &'static str) -> Result<f64, Self> {
        if value >= 0.0 && value.is_finite() { Ok(value) } else { Err(Self::Negative { quantity, value, unit }) }
    }

    /// Passes `value` through if it is finite.
    pub(crate) fn require_finite(quantity: &'static str, value: f64, unit: &'static str) -> Result<f64, Self> {
        if value.is_finite() { Ok(value) } else { Err(Self::NotFinite { quantity, value, unit }) }
    }
}
