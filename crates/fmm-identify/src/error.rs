//! Errors of an identification.

use std::error::Error;

use fmm_fit::{EvaluationError, FitError};
use fmm_frf::{Channel, FrfError};
use fmm_model::{Bounds, Parameter, Rounded};
use fmm_record::{Quantity, RecordError};

/// Why a record could not be prepared or identified; each variant is something else that the caller can do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// Something that has to be given was not, such as a record, a candidate, or the value of a parameter: give it.
    #[error("{what}")]
    Missing {
        /// The missing input.
        what: String,
    },
    /// A record, a drive or a channel of another kind, quantity or unit than is taken: choose or convert another.
    #[error("{what}")]
    WrongRecord {
        /// Accepted and given input.
        what: String,
    },
    /// Too few samples, half swings or quiet samples: take a longer record, or ask for less of it.
    #[error("{what}")]
    TooFew {
        /// Things of which there are too few.
        what: String,
        /// Number of those that there are.
        found: usize,
        /// Number of those that are needed.
        needed: usize,
    },
    /// The record does not show what is looked for in it: look at the data.
    #[error("{what}")]
    NotSeen {
        /// Unknown name, and the known ones.
        what: String,
    },
    /// A number that cannot be: give another.
    #[error("{what}")]
    OutOfRange {
        /// Subject, value and allowed range.
        what: String,
        /// The value given.
        value: f64,
    },
    /// A law, a term or a parameter of this name does not exist: choose one that does.
    #[error("{what}")]
    UnknownName {
        /// The name given, and the names there are.
        what: String,
    },
    /// The input contradicts itself: leave one part of it out.
    #[error("{what}")]
    Contradiction {
        /// Contradicting parts.
        what: String,
    },
    /// Force and response of a blow do not go together, or nothing was hit.
    #[error(transparent)]
    Impact(#[from] FrfError),
    /// A number given for the preparation cannot be.
    #[error(transparent)]
    InvalidInput(#[from] fmm_model::ModelError),
    /// The record itself does not allow what was asked for.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The fit could not begin.
    #[error("the fit of {law} could not begin: {source}")]
    Fit {
        /// Name of the law.
        law: &'static str,
        /// Cause.
        source: FitError,
    },
    /// A record of a validation could not be predicted.
    #[error("record {record} that is not fitted: {source}")]
    NotPredicted {
        /// Number of the record, from 1.
        record: usize,
        /// Cause.
        source: Box<IdentifyError>,
    },
    /// There is no posterior.
    #[cfg(feature = "sampler")]
    #[error("the posterior of {law} could not be found: {source}")]
    Posterior {
        /// Name of the law.
        law: String,
        /// Cause.
        source: FitError,
    },
    /// The fitted motion could not be simulated.
    #[error("the motion fitted by {law} could not be simulated: {source}")]
    Simulation {
        /// Name of the law.
        law: &'static str,
        /// Cause.
        source: Box<dyn Error + Send + Sync>,
    },
}

impl IdentifyError {
    /// True if another law may be fitted to the same experiments all the same.
    pub(crate) fn is_of_law(&self) -> bool {
        matches!(self, Self::Fit { .. } | Self::Simulation { .. } | Self::TooFew { .. } | Self::OutOfRange { .. })
    }

    /// Something that has to be given.
    pub(crate) fn missing(what: impl Into<String>) -> Self {
        Self::Missing { what: what.into() }
    }

    /// No record at all.
    pub(crate) fn no_record() -> Self {
        Self::missing("there is no record to identify; give at least one ring-down")
    }

    /// Another kind, quantity or unit than is taken.
    pub(crate) fn wrong_record(what: String) -> Self {
        Self::WrongRecord { what }
    }

    /// Another `quantity` than is `needed` where the record is used as `subject`.
    pub(crate) fn wrong_quantity(subject: &str, needed: &str, quantity: Quantity) -> Self {
        Self::wrong_record(format!("{subject} must be {needed}, but the record is: {quantity}"))
    }

    /// The record given as a drive is neither a force nor a motion.
    pub(crate) fn drive(expected: &str, found: &str) -> Self {
        Self::wrong_record(format!("the drive of an experiment must be {expected}, but is: {found}"))
    }

    /// Too few samples to hold an oscillation.
    pub(crate) fn too_short(samples: usize, needed: usize) -> Self {
        let what = format!("the record has {samples} samples; at least {needed} are needed");
        Self::TooFew { what, found: samples, needed }
    }

    /// Too few samples after the first `time` (s), in which a sensor settles.
    pub(crate) fn settling(samples: usize, needed: usize, time: f64) -> Self {
        let what = format!(
            "the low-pass filter of the sensor settles for {time:.3e} s, after which the record has {samples} samples; \
             at least {needed} are needed: state a higher corner frequency, or give a longer record"
        );
        Self::TooFew { what, found: samples, needed }
    }

    /// Too few `runs`, or different values of what was to be told from them.
    pub(crate) fn too_few_runs(runs: &str, found: usize, needed: usize) -> Self {
        Self::TooFew { what: format!("{found} {runs} are given; at least {needed} are needed"), found, needed }
    }

    /// Too few half swings.
    pub(crate) fn too_few_half_swings(found: usize, needed: usize) -> Self {
        let what = format!(
            "the record shows {found} half swings above its noise; at least {needed} are needed to see a period and a \
             decay, and four samples in each to see a half swing; a machine without a spring makes a run-down"
        );
        Self::TooFew { what, found, needed }
    }

    /// A `channel` of a blow that is never quiet.
    pub(crate) fn no_quiet(channel: Channel, samples: usize, needed: usize) -> Self {
        let what = format!(
            "the offset of the {channel} is not known: {samples} samples are quiet, at least {needed} are needed"
        );
        Self::TooFew { what, found: samples, needed }
    }

    /// The record does not show something.
    pub(crate) fn not_seen(what: impl Into<String>) -> Self {
        Self::NotSeen { what: what.into() }
    }

    /// No rest from which the offset is to be taken.
    pub(crate) fn no_rest() -> Self {
        Self::not_seen(
            "the record does not begin at rest, so there is no rest to take the offset from; fit the offset instead",
        )
    }

    /// A record without samples between two times (s), over more `periods` than can be bridged.
    pub(crate) fn long_gap([before, after]: [f64; 2], periods: f64) -> Self {
        let [before, after, periods] =
            [(before, 6), (after, 6), (periods, 2)].map(|(value, count)| Rounded::significant(value, count));
        Self::not_seen(format!(
            "the record has no samples between {before} s and {after} s, {periods} periods of its motion, of which the \
             swings are not seen; use it up to {before} s or from {after} s on"
        ))
    }

    /// A record that is constant at `value` in `unit`.
    pub(crate) fn no_motion(value: f64, unit: &str) -> Self {
        Self::not_seen(format!("the record is constant at {value} {unit}: nothing moves"))
    }

    /// A number that describes an experiment and cannot be.
    pub(crate) fn not_allowed(subject: &str, value: f64, allowed: &str) -> Self {
        Self::OutOfRange { what: format!("{subject} must be {allowed}, not {}", Rounded::every_digit(value)), value }
    }

    /// A finding of which value or variance lies beyond the range of numbers, as a mass of 1e300 kg makes it, or a
    /// level of which a fit leaves nothing.
    pub(crate) fn beyond_numbers(parameter: &Parameter, value: f64) -> Self {
        let (name, unit) = (parameter.name(), parameter.unit());
        let cause = if value.abs() < 1.0 { "the fit leaves nothing of it, or the" } else { "check the" };
        let end = if value.abs() < 1.0 { " are wrong" } else { "" };
        let what = format!(
            "{name} is {value:.3e} {unit}, of which the variance lies beyond the range of numbers: {cause} units of \
             mass, stiffness and load{end}"
        );
        Self::OutOfRange { what, value }
    }

    /// A parameter that was to be held outside its bounds.
    pub(crate) fn held_out_of_bounds(name: &str, value: f64, lower: f64, upper: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "{name} cannot be held at {}: it must be {}",
                Rounded::every_digit(value),
                Bounds::UNBOUNDED.at_least(lower).at_most(upper)
            ),
            value,
        }
    }

    /// A name that none of the `known` parameters has.
    pub(crate) fn unknown_parameter(name: &str, known: &str) -> Self {
        Self::UnknownName { what: format!("there is no parameter called {name:?}; the parameters are: {known}") }
    }

    /// Contradicting parts.
    pub(crate) fn contradiction(what: impl Into<String>) -> Self {
        Self::Contradiction { what: what.into() }
    }

    /// A linear damping beside a `law` that has one.
    pub(crate) fn two_dampings(law: &str) -> Self {
        Self::contradiction(format!(
            "{law} has a viscous part: a linear damping of the machine beside it could not be told apart; leave one out"
        ))
    }

    /// A fitted motion that is not simulated.
    pub(crate) fn simulation(law: &'static str, source: impl Into<EvaluationError>) -> Self {
        Self::Simulation { law, source: source.into().into_boxed() }
    }
}
