//! What can be wrong with a record or with what is asked of it.

use crate::Quantity;

/// A record that cannot be, or an operation that it does not allow.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// No samples at all.
    #[error("a record needs at least one sample, but none were given")]
    Empty,
    /// Samples that are infinite or not a number.
    #[error("{count} of {length} samples are not finite; the first is sample {index} (at {time} s)")]
    NonFinite {
        /// Index of the first such sample.
        index: usize,
        /// Its time (s).
        time: f64,
        /// How many such samples there are.
        count: usize,
        /// How many samples were given.
        length: usize,
    },
    /// A sampling interval that is zero, negative or not finite.
    #[error("the sampling interval must be positive and finite, but is {interval} s")]
    Interval {
        /// The interval given (s).
        interval: f64,
    },
    /// A sampling rate that is zero, negative or not finite.
    #[error("the sampling rate must be positive and finite, but is {rate} Hz")]
    Rate {
        /// The rate given (Hz).
        rate: f64,
    },
    /// A start or end that lies too far out for its time stamps to be told apart.
    #[error("with a start of {start} s and an interval of {interval} s, {length} time stamps cannot be told apart")]
    TimeOutOfRange {
        /// Start given (s).
        start: f64,
        /// Interval given (s).
        interval: f64,
        /// How many samples were given.
        length: usize,
    },
    /// As many times as values are needed.
    #[error("{times} time stamps were given for {values} values")]
    LengthMismatch {
        /// How many time stamps were given.
        times: usize,
        /// How many values were given.
        values: usize,
    },
    /// One time stamp, or none, does not give an interval.
    #[error("{count} time stamps do not give a sampling interval; at least 2 are needed")]
    TooFewTimes {
        /// How many time stamps were given.
        count: usize,
    },
    /// A time stamp that is infinite or not a number.
    #[error("time stamp {index} is {time} s; it must be finite")]
    TimeNotFinite {
        /// Index of the time stamp.
        index: usize,
        /// The time stamp (s).
        time: f64,
    },
    /// A time stamp that repeats its predecessor or precedes it.
    #[error("time must increase, but time stamp {index} is {time} s after {previous} s")]
    TimeNotIncreasing {
        /// Index of the later time stamp.
        index: usize,
        /// The time stamp (s).
        time: f64,
        /// Its predecessor (s).
        previous: f64,
    },
    /// Time stamps that do not lie on a uniform grid.
    #[error(
        "sampling is not uniform: time stamp {index} is {time} s, but a uniform interval of {interval} s puts it at \
         {expected} s ({deviation} s off); resample the record, with the band of its motion, or give its rate"
    )]
    NonUniform {
        /// Index of the time stamp.
        index: usize,
        /// The time stamp (s).
        time: f64,
        /// Where the uniform grid puts it (s).
        expected: f64,
        /// `time − expected` (s).
        deviation: f64,
        /// The interval of the grid (s).
        interval: f64,
    },
    /// Time stamps in a unit that is not known.
    #[error(
        "the time stamps \"{name}\" are in \"{unit}\", which is no unit of time that is known; give the sampling rate"
    )]
    TimeUnit {
        /// Name of the column or variable.
        name: String,
        /// What is written as its unit.
        unit: String,
    },
    /// A series that counts samples and tells no time.
    #[error("\"{name}\" counts samples and tells no time; give the sampling rate, or time stamps with their unit")]
    Counter {
        /// Name of the column or variable.
        name: String,
    },
    /// A band that is not positive, or too wide for a rate.
    #[error(
        "the band of a motion must be positive and at most 0.45 of the rates, but is {band} Hz at a rate of {rate} Hz"
    )]
    Band {
        /// The band given (Hz).
        band: f64,
        /// The rate for which it is too wide (Hz).
        rate: f64,
    },
    /// Time stamps that leave a motion of the band unknown.
    #[error(
        "at {time} s, the time stamps are too far apart: a motion of up to {band} Hz is known there with a relative error of \
         {error} only; give a narrower band, or crop the record"
    )]
    Unresolved {
        /// Where it is known least (s).
        time: f64,
        /// Its relative error (1).
        error: f64,
        /// The band (Hz).
        band: f64,
    },
    /// A span of time in which the record has no sample.
    #[error("no sample lies between {from} s and {to} s; the record spans {start} s to {end} s")]
    NothingLeft {
        /// Begin of the span asked for (s).
        from: f64,
        /// End of the span asked for (s).
        to: f64,
        /// First sample of the record (s).
        start: f64,
        /// Last sample of the record (s).
        end: f64,
    },
    /// A scale factor that is zero or not finite.
    #[error("a scale factor must be finite and not zero, but is {factor}")]
    Factor {
        /// The factor given.
        factor: f64,
    },
    /// An offset or initial value that is not finite.
    #[error("an offset or initial value must be finite, but is {value}")]
    Offset {
        /// The value given.
        value: f64,
    },
    /// A moving average needs a centre sample.
    #[error("the span of a moving average must be odd, but is {span}; use {} or {}", span.saturating_sub(1).max(1), span + 1)]
    EvenSpan {
        /// The span given.
        span: usize,
    },
    /// A polynomial that a window does not determine, or that no filter needs.
    #[error(
        "the degree of a smoothing polynomial must be below its span and at most 8, but is {degree} for {span} samples"
    )]
    Degree {
        /// The degree given.
        degree: usize,
        /// The span given.
        span: usize,
    },
    /// Too few samples for the operation.
    #[error("{operation} needs at least {needed} samples, but the record has {length}")]
    TooShort {
        /// What was asked for.
        operation: &'static str,
        /// How many samples it needs.
        needed: usize,
        /// How many there are.
        length: usize,
    },
    /// The quantity has no integral that the crate knows.
    #[error("a record of {quantity} cannot be integrated; only acceleration and velocity can")]
    NoIntegral {
        /// Quantity of the record.
        quantity: Quantity,
    },
    /// The quantity has no derivative that the crate knows.
    #[error("a record of {quantity} cannot be differentiated; only displacement and velocity can")]
    NoDerivative {
        /// Quantity of the record.
        quantity: Quantity,
    },
}
