//! Errors of records, responses and oscillators.

use fmm_model::ModelError;

use crate::{Channel, ResponseForm};

/// Reason why a frequency response or an impulse could not be stated; each variant asks something else of the caller.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrfError {
    /// A quantity that cannot be what it is: give another.
    #[error(transparent)]
    OutOfRange(#[from] ModelError),
    /// Samples, lines or values that are infinite, no numbers, too large, or not in order: look at the data.
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
        /// Of what there are too few, and how many are needed.
        what: String,
    },
    /// A trial without any force: leave it out.
    #[error("the force of the trial is zero from start to end, or so small that its square is; nothing was hit")]
    NoForce,
    /// Nothing finite follows at a frequency: leave this line out.
    #[error("{what}")]
    NotDefined {
        /// The result that does not exist, and the reason.
        what: String,
        /// The frequency (Hz).
        frequency: f64,
    },
    /// A range of samples, times or frequencies that the record or the response does not have: choose another.
    #[error("{what}")]
    Outside {
        /// The range asked for, and the one there is.
        what: String,
    },
    /// A mean of ratios that was not asked for in time.
    #[error("the ratios of the single trials were not kept; ask for them with AverageOptions::keeping_ratios")]
    RatiosNotKept,
    /// A fit that finds no mode or cannot tell its parameters apart: choose another band.
    #[error("{what}")]
    NoFit {
        /// The fit, and its fault.
        what: String,
    },
}

/// Samples, lines and values.
impl FrfError {
    /// Refuses samples that are infinite or not numbers.
    pub(crate) fn require_samples(channel: Channel, samples: &[f64]) -> Result<(), Self> {
        match samples.iter().enumerate().find(|(_, sample)| !sample.is_finite()) {
            Some((index, &value)) => Err(Self::sample_not_finite(channel, index, value)),
            None => Ok(()),
        }
    }

    /// A `value` of sample `index`, in the unit of the channel, that is infinite or not a number.
    pub(crate) fn sample_not_finite(channel: Channel, index: usize, value: f64) -> Self {
        Self::Values { what: format!("sample {index} of the {channel} must be finite, but is {value}") }
    }

    /// A trial whose squares overflow.
    pub(crate) fn too_large(channel: Channel) -> Self {
        Self::Values { what: format!("the samples of the {channel} are so large that their squares overflow") }
    }

    /// A `frequency` (Hz) of line `index` that is negative, not finite or does not increase.
    pub(crate) fn frequencies_not_increasing(index: usize, frequency: f64) -> Self {
        let what =
            format!("frequencies must be finite, not negative and increasing, but line {index} is at {frequency} Hz");
        Self::Values { what }
    }

    /// A response that is infinite or not a number at a `frequency` (Hz).
    pub(crate) fn value_not_finite(form: ResponseForm, frequency: f64) -> Self {
        Self::Values { what: format!("the {form} at {frequency} Hz must be finite") }
    }

    /// Too few samples to integrate.
    pub(crate) fn too_few_samples(found: usize) -> Self {
        Self::TooFew { what: format!("an impulse needs at least two samples of the force, but there are {found}") }
    }

    /// Samples for the baseline that do not exist.
    pub(crate) fn baseline_range(start: usize, end: usize, length: usize) -> Self {
        let what =
            format!("the baseline needs samples {start} to {end} (excluded), but the record has {length}, from 0 on");
        Self::Outside { what }
    }

    /// A force window outside the record; times in s.
    pub(crate) fn window_outside(from: f64, to: f64, duration: f64) -> Self {
        let what = format!("the force window from {from} s to {to} s covers no sample of a record of {duration} s");
        Self::Outside { what }
    }

    /// Segments that do not move on.
    pub(crate) fn overlap(length: usize, overlap: usize) -> Self {
        let what = format!("segments of {length} samples must overlap by less than that, but should by {overlap}");
        Self::Outside { what }
    }

    /// A band (Hz) without lines.
    pub(crate) fn empty_band(low: f64, high: f64) -> Self {
        Self::Outside { what: format!("no line lies between {low} Hz and {high} Hz") }
    }

    /// Lines too far apart (Hz) to tell harmonics from each other, or that do not `reach` (Hz) them.
    pub(crate) fn harmonics_outside(fundamental: f64, order: u32, reach: f64, spacing: f64) -> Self {
        let what = format!(
            "harmonics of {fundamental} Hz up to order {order} need lines that reach {reach} Hz, at most {spacing} Hz apart"
        );
        Self::Outside { what }
    }
}

/// Errors of things that do not go together.
impl FrfError {
    /// A response whose frequencies and values are not of one number.
    pub(crate) fn length_mismatch(frequencies: usize, values: usize) -> Self {
        let what =
            format!("a response needs one value for each of its frequencies, but has {frequencies} and {values}");
        Self::Mismatch { what }
    }

    /// Impulses and receptance peaks that are not of one number.
    pub(crate) fn point_count(impulses: usize, peaks: usize) -> Self {
        let what =
            format!("there must be one peak for each impulse, but there are {impulses} impulses and {peaks} peaks");
        Self::Mismatch { what }
    }

    /// A channel that is not as long as the average, or as the other channel.
    pub(crate) fn sample_count(channel: Channel, expected: usize, found: usize) -> Self {
        Self::Mismatch { what: format!("the {channel} needs {expected} samples, but has {found}") }
    }

    /// Two responses that differ from `line` on; from 0 if their forms do.
    pub(crate) fn responses_differ(line: usize) -> Self {
        let what =
            format!("both responses must be of one form and at the same frequencies, but differ from line {line} on");
        Self::Mismatch { what }
    }
}

/// Trials and lines.
impl FrfError {
    /// An estimate without a trial.
    pub(crate) fn no_trials() -> Self {
        Self::TooFew { what: "there is no trial to average over yet".to_owned() }
    }

    /// An uncertainty from an average that is worth fewer than two trials.
    pub(crate) fn too_few_trials(found: f64) -> Self {
        Self::TooFew { what: format!("scatter needs more than one trial, but the average is worth {found}") }
    }

    /// A `frequency` (Hz) at which no trial has force.
    pub(crate) fn no_force_at(frequency: f64) -> Self {
        let what = format!("no trial has force at {frequency} Hz; average over a band without this line");
        Self::NotDefined { what, frequency }
    }

    /// A `frequency` (Hz) at which force and response have nothing in common.
    pub(crate) fn no_cross_spectrum_at(frequency: f64) -> Self {
        let what = format!(
            "the response has nothing of the force at {frequency} Hz, so that neither phase nor H2 can be stated"
        );
        Self::NotDefined { what, frequency }
    }

    /// A division by iω at zero `frequency` (Hz), or a factor so extreme that the value overflows.
    pub(crate) fn no_finite_form(from: ResponseForm, to: ResponseForm, frequency: f64) -> Self {
        Self::NotDefined { what: format!("no finite {to} follows from the {from} at {frequency} Hz"), frequency }
    }

    /// An undamped oscillator at its natural `frequency` (Hz).
    pub(crate) fn undamped_resonance(frequency: f64) -> Self {
        let what = format!(
            "the oscillator has no finite receptance at {frequency} Hz, where it is in resonance without damping"
        );
        Self::NotDefined { what, frequency }
    }

    /// A linear response that is zero at a `frequency` (Hz), of which a measured one is no multiple.
    pub(crate) fn linear_response_zero(frequency: f64) -> Self {
        let what = format!("the linear response is zero at {frequency} Hz; leave this line out");
        Self::NotDefined { what, frequency }
    }
}

/// Fits.
impl FrfError {
    /// Too few lines or points.
    pub(crate) fn too_few_points(needed: usize, found: usize) -> Self {
        Self::TooFew { what: format!("the fit needs at least {needed} points, but has {found}") }
    }

    /// Points in which the parameters cannot be told apart.
    pub(crate) fn undetermined(fit: &str, points: usize) -> Self {
        Self::NoFit { what: format!("the {fit} cannot tell its parameters apart in these {points} points") }
    }

    /// A fit that did not settle.
    pub(crate) fn not_converged(fit: &str) -> Self {
        Self::NoFit { what: format!("the {fit} did not settle; a narrower band around one resonance may help") }
    }

    /// A band (Hz) without an oscillating mode.
    pub(crate) fn no_mode(fit: &str, low: f64, high: f64) -> Self {
        Self::NoFit { what: format!("the {fit} finds no oscillating mode between {low} Hz and {high} Hz") }
    }
}
