//! What can be wrong with a simulation.

use fmm_model::{ModelError, Oscillator, Scalar};

/// A scenario that cannot be simulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A load, time, position or velocity that cannot be.
    #[error(transparent)]
    Quantity(#[from] ModelError),
    /// No samples, or more than have exact times.
    #[error(
        "the number of samples must lie between 1 and 2^53 and their last time be finite, but {count} samples were asked for at {interval} s"
    )]
    Sampling {
        /// How many samples were asked for.
        count: usize,
        /// Their interval (s).
        interval: f64,
    },
    /// More samples than there is memory for.
    #[error("there is no memory for {count} samples; keep fewer channels or simulate window by window")]
    Memory {
        /// How many samples were asked for.
        count: usize,
    },
    /// Sample times that do not ascend from zero.
    #[error("sample times must be finite and ascend from 0, but time {index} is {time} s after {before} s")]
    Times {
        /// Which one is wrong.
        index: usize,
        /// What it is (s).
        time: f64,
        /// The one before it, or 0 (s).
        before: f64,
    },
    /// A method of fixed step was asked for samples that are not equally spaced.
    #[error("a method of fixed step needs uniform sampling; simulate with another engine or sample uniformly")]
    NotUniform,
    /// The engine has no closed form for this machine, or its normal load.
    #[error(
        "the exact engine needs linear damping, a linear spring and a constant normal load, but there is {found}; take the Runge-Kutta engine"
    )]
    NotLinear {
        /// What is not linear.
        found: &'static str,
    },
    /// The motion has come to where the spring no longer restores.
    #[error(
        "at {time} s the position is {position} m, where the spring pushes away from the origin: its polynomial does not hold so far"
    )]
    NotRestoring {
        /// When (s).
        time: f64,
        /// Where (m).
        position: f64,
    },
    /// A machine that is hardly damped is driven so near its natural frequency that the closed form loses its digits.
    #[error(
        "a wave of {angular_frequency} rad/s is too near the resonance of a machine with hardly any damping for the closed form; take the Runge-Kutta engine"
    )]
    Resonance {
        /// Frequency of the wave (rad/s).
        angular_frequency: f64,
    },
    /// The spring is too weak, beside the forces that act and the time that passes, for the closed form to keep nine digits.
    #[error(
        "a spring of {stiffness} N/m is too weak for the closed form, which would be a small difference of large numbers; take an engine that integrates"
    )]
    WeakSpring {
        /// Its stiffness (N/m).
        stiffness: f64,
    },
    /// A law with internal state that is not odd in velocity and state together, as such laws promise to be.
    #[error(
        "the law is not odd: at {velocity} m/s it is not the mirror image of what it is at the opposite velocity and state; a contact cannot tell directions apart"
    )]
    NotOdd {
        /// Velocity at which it was seen (m/s).
        velocity: f64,
    },
    /// An initial state that the law does not have, or beyond its bound.
    #[error(
        "state {index} of the law must begin within ±{bound}, but is {deflection}; a bound of 0 may mean that there is no such state"
    )]
    Deflection {
        /// Which state.
        index: usize,
        /// What it was to be, in the law's unit.
        deflection: f64,
        /// What its magnitude may be; 0 if there is no such state.
        bound: f64,
    },
    /// The law and the engine, or a property of the scenario, do not go together.
    #[error("the {engine} engine cannot take {what}")]
    NotSupported {
        /// Name of the engine.
        engine: &'static str,
        /// What it cannot take.
        what: &'static str,
    },
    /// A tolerance that no method can keep.
    #[error("the relative tolerance must lie between 1e-15 and 1e-2, but is {tolerance}")]
    Tolerance {
        /// The tolerance given (1).
        tolerance: f64,
    },
    /// A θ for which the θ-method is not stable.
    #[error("theta must lie between 1/2 and 1, but is {theta}")]
    Theta {
        /// The value given (1).
        theta: f64,
    },
    /// The steps that the tolerance asks for are smaller than the resolution of time.
    #[error("the motion cannot be integrated to a relative tolerance of {tolerance} at {time} s; ask for less")]
    StepTooSmall {
        /// The tolerance (1).
        tolerance: f64,
        /// Where it happened (s).
        time: f64,
    },
    /// The integration takes more steps than any record needs.
    #[error(
        "the motion takes more than {budget} steps before {end} s; shorten the sampled time or ask for less accuracy, neither of which helps where a contact creeps on a law that is steep at rest"
    )]
    StepBudget {
        /// How many steps are allowed.
        budget: usize,
        /// End of the sampled time (s).
        end: f64,
    },
    /// The motion has more events in the sampled time than any record can show.
    #[error("the motion has more than {budget} events before {end} s; shorten the sampled time")]
    EventBudget {
        /// How many events are allowed.
        budget: usize,
        /// End of the sampled time (s).
        end: f64,
    },
    /// The motion leaves the range of the number type.
    #[error("the motion is not finite at {time} s; the inputs are too large or too small to be simulated together")]
    NotFinite {
        /// When it happened (s).
        time: f64,
    },
}

impl SimulationError {
    /// That the spring restores at the `position` (m) reached at `time` (s).
    pub(crate) fn require_restoring<D: Scalar>(oscillator: &Oscillator<D>, time: f64, position: D) -> Result<(), Self> {
        if oscillator.restoring().restores(position) {
            return Ok(());
        }
        Err(Self::NotRestoring { time, position: position.value() })
    }

    /// That a relative `tolerance` (1) is one that a method can keep.
    pub(crate) fn require_tolerance(tolerance: f64) -> Result<(), Self> {
        if (1e-15..=1e-2).contains(&tolerance) { Ok(()) } else { Err(Self::Tolerance { tolerance }) }
    }
}
