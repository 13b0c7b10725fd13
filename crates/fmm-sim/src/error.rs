//! What can be wrong with a simulation.

use fmm_model::ModelError;

/// A scenario that cannot be simulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A load, time, position or velocity that cannot be.
    #[error(transparent)]
    Quantity(#[from] ModelError),
    /// More samples than memory addresses allow, or none.
    #[error(
        "the number of samples must be at least 1 and their last time finite, but {count} samples were asked for at {interval} s"
    )]
    Sampling {
        /// How many samples were asked for.
        count: usize,
        /// Their interval (s).
        interval: f64,
    },
    /// The engine has no closed form for quadratic damping.
    #[error("the exact engine needs linear damping, but the quadratic coefficient is {quadratic} N s²/m²")]
    QuadraticDamping {
        /// The coefficient given (N s²/m²).
        quadratic: f64,
    },
    /// The motion has more events in the sampled time than any record can show.
    #[error("the motion reverses more than {budget} times before {end} s; shorten the sampled time")]
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
