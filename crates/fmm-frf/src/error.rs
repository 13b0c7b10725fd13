//! What can be wrong with a record, a response and an oscillator.

use fmm_model::ModelError;
use fmm_record::Quantity;

use crate::{Channel, ResponseForm};

/// Why a frequency response or an impulse could not be stated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrfError {
    /// A quantity that cannot be what it is.
    #[error(transparent)]
    OutOfRange(#[from] ModelError),
    /// A sample that is infinite or not a number.
    #[error("sample {index} of the {channel} must be finite, but is {value}")]
    SampleNotFinite {
        /// Which channel.
        channel: Channel,
        /// Which sample, counted from 0.
        index: usize,
        /// Its value, in the unit of the channel.
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
    /// Impulses and receptance peaks that are not of one number.
    #[error("there must be one peak for each impulse, but there are {impulses} impulses and {peaks} peaks")]
    PointCount {
        /// How many impulses were given.
        impulses: usize,
        /// How many peaks were given.
        peaks: usize,
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
    /// A channel that is not as long as the average, or as the other channel.
    #[error("the {channel} needs {expected} samples, but has {found}")]
    SampleCount {
        /// Which channel.
        channel: Channel,
        /// How many samples it needs.
        expected: usize,
        /// How many it has.
        found: usize,
    },
    /// A transform of records of another length.
    #[error("a transform of {expected} samples was given {found}")]
    TransformLength {
        /// How many samples it takes.
        expected: usize,
        /// How many it was given.
        found: usize,
    },
    /// A record of another rate than the average.
    #[error("the {channel} was sampled at {found} Hz, but the average is of records at {expected} Hz")]
    Rate {
        /// Which channel.
        channel: Channel,
        /// Rate of the average (Hz).
        expected: f64,
        /// Rate of the record (Hz).
        found: f64,
    },
    /// A record of another quantity than the channel needs.
    #[error("the {channel} must be a record of {expected}, but is one of {found}")]
    WrongQuantity {
        /// Which channel.
        channel: Channel,
        /// What it must be.
        expected: Quantity,
        /// What it is.
        found: Quantity,
    },
    /// Force and response that do not begin at the same time.
    #[error(
        "force and response must begin together, but begin at {force} s and {response} s; crop them to the same begin"
    )]
    Begin {
        /// Begin of the force (s).
        force: f64,
        /// Begin of the response (s).
        response: f64,
    },
    /// A trial without any force.
    #[error("the force of the trial is zero from begin to end, or so small that its square is; nothing was hit")]
    NoForce,
    /// A trial whose squares overflow.
    #[error("the samples of the {channel} are so large that their squares overflow")]
    TooLarge {
        /// Which channel.
        channel: Channel,
    },
    /// An estimate without a trial.
    #[error("there is no trial to average over yet")]
    NoTrials,
    /// An uncertainty from too few trials.
    #[error("scatter needs more than one trial, but the average is worth {found}")]
    TooFewTrials {
        /// Effective number of averages.
        found: f64,
    },
    /// A frequency at which no trial has force.
    #[error("no trial has force at {frequency} Hz; average over a band without this line")]
    NoForceAt {
        /// The frequency (Hz).
        frequency: f64,
    },
    /// A frequency at which force and response have nothing in common.
    #[error("the response has nothing of the force at {frequency} Hz, so that neither phase nor H2 can be stated")]
    NoCrossSpectrumAt {
        /// The frequency (Hz).
        frequency: f64,
    },
    /// A mean of ratios that was not asked for in time.
    #[error("the ratios of the single trials were not kept; ask for them with AverageOptions::keeping_ratios")]
    RatiosNotKept,
    /// A band of frequencies without lines.
    #[error("no line lies between {low} Hz and {high} Hz")]
    EmptyBand {
        /// Low end (Hz).
        low: f64,
        /// High end (Hz).
        high: f64,
    },
    /// A force window outside the record.
    #[error("the force window from {from} s to {to} s covers no sample of a record of {duration} s")]
    WindowOutside {
        /// Begin of the window (s).
        from: f64,
        /// End of the window (s).
        to: f64,
        /// Duration of the record (s).
        duration: f64,
    },
    /// Segments that do not move on.
    #[error("segments of {length} samples must overlap by less than that, but should by {overlap}")]
    Overlap {
        /// Samples of a segment.
        length: usize,
        /// Samples that two segments were to share.
        overlap: usize,
    },
    /// Too few lines or points for a fit.
    #[error("the fit needs at least {needed} points, but has {found}")]
    TooFewPoints {
        /// How many it needs.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// Points in which the parameters of a fit cannot be told apart.
    #[error("the {fit} cannot tell its parameters apart in these {points} points")]
    Undetermined {
        /// Which fit.
        fit: &'static str,
        /// How many points there are.
        points: usize,
    },
    /// A fit that did not settle.
    #[error("the {fit} did not settle; a narrower band around one resonance may help")]
    NotConverged {
        /// Which fit.
        fit: &'static str,
    },
    /// A band without an oscillating mode.
    #[error("the {fit} finds no oscillating mode between {low} Hz and {high} Hz")]
    NoMode {
        /// Which fit.
        fit: &'static str,
        /// Low end (Hz).
        low: f64,
        /// High end (Hz).
        high: f64,
    },
    /// Two responses that are not of the same form and lines.
    #[error("both responses must be of one form and at the same frequencies, but differ from line {line} on")]
    ResponsesDiffer {
        /// The first line that differs, counted from 0; 0 if the forms differ.
        line: usize,
    },
    /// A linear response that is zero, of which a measured one is no multiple.
    #[error("the linear response is zero at {frequency} Hz; leave this line out")]
    LinearResponseZero {
        /// The frequency (Hz).
        frequency: f64,
    },
    /// Lines too far apart to tell harmonics from each other, or that do not reach them.
    #[error(
        "harmonics of {fundamental} Hz up to order {order} need lines that reach {reach} Hz, at most {spacing} Hz apart"
    )]
    HarmonicsOutside {
        /// The fundamental frequency (Hz).
        fundamental: f64,
        /// The highest order asked for.
        order: u32,
        /// Frequency of that order (Hz).
        reach: f64,
        /// Largest spacing of lines that tells orders apart (Hz).
        spacing: f64,
    },
}

impl FrfError {
    /// Refuses samples that are infinite or not numbers.
    pub(crate) fn require_samples(channel: Channel, samples: &[f64]) -> Result<(), Self> {
        match samples.iter().enumerate().find(|(_, sample)| !sample.is_finite()) {
            Some((index, &value)) => Err(Self::SampleNotFinite { channel, index, value }),
            None => Ok(()),
        }
    }
}
