//! Errors of a simulation.

use fmm_model::{ModelError, Oscillator, Rounded, Scalar};

/// A scenario that cannot be simulated; each variant is something else that the caller can do about it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A load, time, position or velocity that cannot be.
    #[error(transparent)]
    Quantity(#[from] ModelError),
    /// Samples, an initial state or an option of an engine that cannot be: give others.
    #[error("{what}")]
    OutOfRange {
        /// Subject of the value, and the allowed range.
        what: String,
        /// The value given; of samples, their number or the time that is wrong (s).
        value: f64,
    },
    /// More samples than there is memory for.
    #[error("there is no memory for {count} samples; keep fewer channels or simulate window by window")]
    Memory {
        /// Number of samples asked for.
        count: usize,
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
    /// A law with internal state that is not odd in velocity and state together, as such laws promise to be.
    #[error(
        "the law is not odd: at {velocity} m/s it is not the mirror image of what it is at the opposite velocity and state; a contact cannot tell directions apart",
        velocity = Rounded::every_digit(*.velocity)
    )]
    NotOdd {
        /// Velocity at which it was seen (m/s).
        velocity: f64,
    },
    /// The motion has come to where the spring no longer restores.
    #[error(
        "at {time} s the position is {position} m, where the spring pushes away from the origin: its polynomial does not hold that far out",
        time = Rounded::every_digit(*.time),
        position = Rounded::every_digit(*.position)
    )]
    NotRestoring {
        /// Time (s).
        time: f64,
        /// Position (m).
        position: f64,
    },
    /// More events or steps than any record needs, or steps below the resolution of time: shorten the sampled time, or
    /// ask for less accuracy.
    #[error("{what}")]
    Exhausted {
        /// Of what there are too many, and until when.
        what: String,
    },
    /// The motion leaves the range of the number type.
    #[error(
        "the motion is not finite at {time} s; the inputs are too large or too small to be simulated together",
        time = Rounded::every_digit(*.time)
    )]
    NotFinite {
        /// Time of the failure (s).
        time: f64,
    },
}

/// Input that engines of fixed step cannot take.
pub(crate) const NOT_UNIFORM: &str =
    "samples that are not equally spaced; simulate with another engine or sample uniformly";

impl SimulationError {
    /// Checks that the spring restores at the `position` (m) reached at `time` (s).
    pub(crate) fn require_restoring<D: Scalar>(oscillator: &Oscillator<D>, time: f64, position: D) -> Result<(), Self> {
        if oscillator.restoring().restores(position) {
            return Ok(());
        }
        Err(Self::NotRestoring { time, position: position.value() })
    }

    /// Checks that a method can keep a relative `tolerance` (1).
    pub(crate) fn require_tolerance(tolerance: f64) -> Result<(), Self> {
        if (1e-15..=1e-2).contains(&tolerance) { Ok(()) } else { Err(Self::tolerance(tolerance)) }
    }

    /// No samples, or more than have exact times.
    pub(crate) fn sampling(count: usize, interval: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "the number of samples must lie between 1 and 2^53 and their last time be finite, but {count} samples were asked for at {interval} s",
                interval = Rounded::every_digit(interval)
            ),
            value: count as f64,
        }
    }

    /// Sample times that do not ascend from zero.
    pub(crate) fn times(index: usize, time: f64, before: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "sample times must be finite and ascend from 0, but time {index} is {time} s after {before} s",
                time = Rounded::every_digit(time),
                before = Rounded::every_digit(before)
            ),
            value: time,
        }
    }

    /// The engine has no closed form for this machine, or its normal load.
    pub(crate) fn not_linear(found: &str) -> Self {
        Self::NoClosedForm {
            what: format!(
                "the exact engine needs linear damping, a linear spring and a constant normal load, but there is {found}; take the Runge-Kutta engine"
            ),
        }
    }

    /// A machine that is hardly damped is driven so near its natural frequency that the closed form loses its digits.
    pub(crate) fn resonance(angular_frequency: f64) -> Self {
        Self::NoClosedForm {
            what: format!(
                "a wave of {angular_frequency} rad/s is too near the resonance of a machine with hardly any damping for the closed form; take the Runge-Kutta engine",
                angular_frequency = Rounded::every_digit(angular_frequency)
            ),
        }
    }

    /// The spring is too weak, beside the forces that act and the time that passes, for the closed form to keep nine
    /// digits.
    pub(crate) fn weak_spring(stiffness: f64) -> Self {
        Self::NoClosedForm {
            what: format!(
                "a spring of {stiffness} N/m is too weak for the closed form, which would be a small difference of large numbers; take an engine that integrates",
                stiffness = Rounded::every_digit(stiffness)
            ),
        }
    }

    /// An initial state that the law does not have, or beyond its bound.
    pub(crate) fn deflection(index: usize, deflection: f64, bound: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "state {index} of the law must begin within ±{bound}, but is {deflection}; a bound of 0 may mean that there is no such state",
                deflection = Rounded::every_digit(deflection),
                bound = Rounded::every_digit(bound)
            ),
            value: deflection,
        }
    }

    /// A tolerance that no method can keep.
    pub(crate) fn tolerance(tolerance: f64) -> Self {
        Self::OutOfRange {
            what: format!(
                "the relative tolerance must lie between 1e-15 and 1e-2, but is {tolerance}",
                tolerance = Rounded::every_digit(tolerance)
            ),
            value: tolerance,
        }
    }

    /// A θ for which the θ-method is not stable.
    pub(crate) fn theta(theta: f64) -> Self {
        Self::OutOfRange {
            what: format!("theta must lie between 1/2 and 1, but is {theta}", theta = Rounded::every_digit(theta)),
            value: theta,
        }
    }

    /// The steps that the tolerance asks for are smaller than the resolution of time.
    pub(crate) fn step_too_small(tolerance: f64, time: f64) -> Self {
        Self::Exhausted {
            what: format!(
                "the motion cannot be integrated to a relative tolerance of {tolerance} at {time} s; ask for less",
                tolerance = Rounded::every_digit(tolerance),
                time = Rounded::every_digit(time)
            ),
        }
    }

    /// The integration takes more steps than any record needs.
    pub(crate) fn step_budget(budget: usize, end: f64) -> Self {
        Self::Exhausted {
            what: format!(
                "the motion takes more than {budget} steps before {end} s; shorten the sampled time or ask for less accuracy, neither of which helps where a contact creeps on a law that is steep at rest",
                end = Rounded::every_digit(end)
            ),
        }
    }

    /// The works of the motion have more pieces than are added up.
    pub(crate) fn piece_budget(budget: usize, end: f64) -> Self {
        Self::Exhausted {
            what: format!(
                "the works are added up over more than {budget} pieces before {end} s, one at least for each sample and several for each period of a fast wave; sample less often, shorten the sampled time, or take slower waves",
                end = Rounded::every_digit(end)
            ),
        }
    }

    /// The motion has more events in the sampled time than any record can show.
    pub(crate) fn event_budget(budget: usize, end: f64) -> Self {
        Self::Exhausted {
            what: format!(
                "the motion has more than {budget} events before {end} s; shorten the sampled time",
                end = Rounded::every_digit(end)
            ),
        }
    }
}
