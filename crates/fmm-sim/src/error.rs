//! Errors of a simulation.

use std::fmt::Display;

use fmm_model::{ModelError, Oscillator, Rounded, Scalar};

/// A scenario that cannot be simulated; each variant is something else that the caller can do about it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A load, time, position or velocity that cannot be.
    #[error(transparent)]
    Quantity(#[from] ModelError),
    /// Samples, an initial state, a law or an option of an engine that cannot be: give others.
    #[error("{what}")]
    OutOfRange {
        /// Subject of the value, and the allowed range.
        what: String,
        /// The value given; of samples, their number or the time that is wrong (s).
        value: f64,
    },
    /// The motion of this machine has no closed form, or none that keeps its digits: take an engine that integrates.
    #[error("{what}")]
    NoClosedForm {
        /// The motion without a closed form, and the reason.
        what: String,
    },
    /// The law and the engine, or a property of the scenario, do not go together: take another engine.
    #[error("the {engine} engine cannot take {what}")]
    NotSupported {
        /// Name of the engine.
        engine: &'static str,
        /// The input that the engine cannot take.
        what: &'static str,
    },
    /// More samples than there is memory for, more events or steps than any record needs, or steps below the resolution
    /// of time: sample less, shorten the sampled time, or ask for less accuracy.
    #[error("{what}")]
    Exhausted {
        /// The number that is too large, and the time that is reached.
        what: String,
    },
    /// The motion leaves the range of the number type.
    #[error(
        "the motion is not finite at {time} s; the inputs are too large or too small to be simulated together",
        time = digits(*.time)
    )]
    NotFinite {
        /// Time of the failure (s).
        time: f64,
    },
}

/// Input that engines of fixed step cannot take.
pub(crate) const NOT_UNIFORM: &str =
    "samples that are not equally spaced; simulate with another engine or sample uniformly";

/// All digits of a value.
fn digits(value: f64) -> impl Display {
    Rounded::every_digit(value)
}

impl SimulationError {
    /// Checks that the spring restores at the `position` (m) reached at `time` (s).
    pub(crate) fn require_restoring<D: Scalar>(oscillator: &Oscillator<D>, time: f64, position: D) -> Result<(), Self> {
        if oscillator.restoring().restores(position) {
            return Ok(());
        }
        let value = position.value();
        let what = format!(
            "at {} s the position is {} m, where the spring pushes away from the origin: its polynomial does not hold \
             that far out",
            digits(time),
            digits(value)
        );
        Err(Self::OutOfRange { what, value })
    }

    /// Checks that a method can keep a relative `tolerance` (1).
    pub(crate) fn require_tolerance(tolerance: f64) -> Result<(), Self> {
        if (1e-15..=1e-2).contains(&tolerance) {
            return Ok(());
        }
        let what = format!("the relative tolerance must lie between 1e-15 and 1e-2, but is {}", digits(tolerance));
        Err(Self::OutOfRange { what, value: tolerance })
    }

    /// No samples, or more than have exact times.
    pub(crate) fn sampling(count: usize, interval: f64) -> Self {
        let what = format!(
            "the number of samples must lie between 1 and 2^53 and their last time be finite, but {count} samples were \
             asked for at {} s",
            digits(interval)
        );
        Self::OutOfRange { what, value: count as f64 }
    }

    /// Sample times that do not ascend from zero.
    pub(crate) fn times(index: usize, time: f64, before: f64) -> Self {
        let [at, after] = [time, before].map(digits);
        let what = format!("sample times must be finite and ascend from 0, but time {index} is {at} s after {after} s");
        Self::OutOfRange { what, value: time }
    }

    /// An initial state that the law does not have, or beyond its bound.
    pub(crate) fn deflection(index: usize, deflection: f64, bound: f64) -> Self {
        let what = format!(
            "state {index} of the law must begin within ±{}, but is {}; a bound of 0 may mean that there is no such \
             state",
            digits(bound),
            digits(deflection)
        );
        Self::OutOfRange { what, value: deflection }
    }

    /// A law with internal state that is not odd in `velocity` (m/s) and state together, as such laws promise to be.
    pub(crate) fn not_odd(velocity: f64) -> Self {
        let what = format!(
            "the law is not odd: at {} m/s it is not the mirror image of its value at the opposite velocity and state; \
             a contact cannot tell directions apart",
            digits(velocity)
        );
        Self::OutOfRange { what, value: velocity }
    }

    /// The engine has no closed form for this machine, or its normal load.
    pub(crate) fn not_linear(found: &str) -> Self {
        let what = format!(
            "the exact engine needs linear damping, a linear spring and a constant normal load, but there is {found}; \
             take the Runge-Kutta engine"
        );
        Self::NoClosedForm { what }
    }

    /// A machine that is hardly damped is driven so near its natural frequency that the closed form loses its digits.
    pub(crate) fn resonance(angular_frequency: f64) -> Self {
        let what = format!(
            "a wave of {} rad/s is too near the resonance of a machine with hardly any damping for the closed form; \
             take the Runge-Kutta engine",
            digits(angular_frequency)
        );
        Self::NoClosedForm { what }
    }

    /// The spring is too weak, beside the forces that act and the time that passes, for the closed form to keep nine
    /// digits.
    pub(crate) fn weak_spring(stiffness: f64) -> Self {
        let what = format!(
            "a spring of {} N/m is too weak for the closed form, which would be a small difference of large numbers; \
             take an engine that integrates",
            digits(stiffness)
        );
        Self::NoClosedForm { what }
    }

    /// No memory for this number of samples.
    pub(crate) fn memory(count: usize) -> Self {
        let what = format!("there is no memory for {count} samples; keep fewer channels or simulate window by window");
        Self::Exhausted { what }
    }

    /// Steps at the tolerance that are smaller than the resolution of time.
    pub(crate) fn step_too_small(tolerance: f64, time: f64) -> Self {
        let [tolerance, time] = [tolerance, time].map(digits);
        let what =
            format!("the motion cannot be integrated to a relative tolerance of {tolerance} at {time} s; ask for less");
        Self::Exhausted { what }
    }

    /// More steps than any record needs.
    pub(crate) fn step_budget(budget: usize, end: f64) -> Self {
        let what = format!(
            "the motion takes more than {budget} steps before {} s; shorten the sampled time or ask for less accuracy, \
             neither of which helps where a contact creeps on a law that is steep at rest",
            digits(end)
        );
        Self::Exhausted { what }
    }

    /// More pieces of the integral of the work than are added up.
    pub(crate) fn piece_budget(budget: usize, end: f64) -> Self {
        let what = format!(
            "the works are added up over more than {budget} pieces before {} s, one at least for each sample and \
             several for each period of a fast wave; sample less often, shorten the sampled time, or take slower waves",
            digits(end)
        );
        Self::Exhausted { what }
    }

    /// More events in the sampled time than any record can show.
    pub(crate) fn event_budget(budget: usize, end: f64) -> Self {
        let what =
            format!("the motion has more than {budget} events before {} s; shorten the sampled time", digits(end));
        Self::Exhausted { what }
    }
}
