//! Error: a category to act on, and a sentence.

use std::fmt;

use fmm_model::ModelError;

/// Reason why a frequency response or an impulse could not be stated; each variant asks another step of the caller.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrfError {
    /// A quantity outside its range: give another.
    #[error(transparent)]
    OutOfRange(#[from] ModelError),
    /// Samples, lines or values that are infinite, no numbers, too large or not in order, or a force that is zero: look
    /// at the data, or leave the trial out.
    #[error("{what}")]
    Values {
        /// The values, and their fault.
        what: String,
    },
    /// Channels, records or responses that do not go together: bring them to the same length, rate, start, quantity or
    /// form.
    #[error("{what}")]
    Mismatch {
        /// The two things that do not agree.
        what: String,
    },
    /// Too few samples, trials or points: take more.
    #[error("{what}")]
    TooFew {
        /// The things that are too few, and the number needed.
        what: String,
    },
    /// Nothing finite follows at a frequency: leave this line out.
    #[error("{what}")]
    NotDefined {
        /// The result that does not exist, and the reason.
        what: String,
        /// The frequency (Hz).
        frequency: f64,
    },
    /// A range of samples, times or frequencies that the record or the response does not have, or ratios that were not
    /// kept: choose another, or ask for it in time.
    #[error("{what}")]
    Outside {
        /// The thing asked for, and the one there is.
        what: String,
    },
    /// A fit that finds no mode or cannot separate its parameters: choose another band.
    #[error("{what}")]
    NoFit {
        /// The fit, and its fault.
        what: String,
    },
}

impl FrfError {
    pub(crate) fn values(what: impl Into<String>) -> Self {
        Self::Values { what: what.into() }
    }

    pub(crate) fn mismatch(what: impl Into<String>) -> Self {
        Self::Mismatch { what: what.into() }
    }

    pub(crate) fn too_few(what: impl Into<String>) -> Self {
        Self::TooFew { what: what.into() }
    }

    pub(crate) fn outside(what: impl Into<String>) -> Self {
        Self::Outside { what: what.into() }
    }

    pub(crate) fn not_defined(what: impl Into<String>, frequency: f64) -> Self {
        Self::NotDefined { what: what.into(), frequency }
    }

    /// Refuses samples of a `channel` that are infinite or not numbers.
    pub(crate) fn require_samples(channel: impl fmt::Display, samples: &[f64]) -> Result<(), Self> {
        match samples.iter().enumerate().find(|(_, sample)| !sample.is_finite()) {
            Some((index, value)) => {
                Err(Self::values(format!("sample {index} of the {channel} must be finite, but is {value}")))
            }
            None => Ok(()),
        }
    }

    /// A force that is zero throughout.
    pub(crate) fn no_force() -> Self {
        Self::values(
            "the force of the trial is zero from start to end, or so small that its square is; there is no impact",
        )
    }

    /// Too few samples to integrate.
    pub(crate) fn too_few_samples(found: usize) -> Self {
        Self::too_few(format!("an impulse needs at least two samples of the force, but there are {found}"))
    }

    /// A channel that is not as long as the average, or as the other channel.
    pub(crate) fn sample_count(channel: impl fmt::Display, expected: usize, found: usize) -> Self {
        Self::mismatch(format!("the {channel} needs {expected} samples, but has {found}"))
    }

    /// A response that is infinite or not a number at a `frequency` (Hz).
    pub(crate) fn value_not_finite(form: impl fmt::Display, frequency: f64) -> Self {
        Self::values(format!("the {form} at {frequency} Hz must be finite"))
    }

    /// A band (Hz) without lines.
    pub(crate) fn empty_band(low: f64, high: f64) -> Self {
        Self::outside(format!("no line lies between {low} Hz and {high} Hz"))
    }

    /// A `frequency` (Hz) at which no trial has force.
    pub(crate) fn no_force_at(frequency: f64) -> Self {
        let what = format!("no trial has force at {frequency} Hz; average over a band without this line");
        Self::not_defined(what, frequency)
    }

    /// Too few lines or points for a fit.
    pub(crate) fn too_few_points(needed: usize, found: usize) -> Self {
        Self::too_few(format!("the fit needs at least {needed} points, but has {found}"))
    }

    /// Points in which the parameters of a `fit` cannot be separated.
    pub(crate) fn undetermined(fit: &str, points: usize) -> Self {
        Self::NoFit { what: format!("the {fit} cannot tell its parameters apart in these {points} points") }
    }

    /// A band (Hz) without an oscillating mode.
    pub(crate) fn no_mode(fit: &str, low: f64, high: f64) -> Self {
        Self::NoFit { what: format!("the {fit} finds no oscillating mode between {low} Hz and {high} Hz") }
    }
}
