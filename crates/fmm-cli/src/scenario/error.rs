//! Errors of a scenario file.

use fmm_friction::LawError;
use fmm_model::{ModelError, Rounded};
use fmm_sim::SimulationError;

use super::EngineName;

/// A scenario that cannot be simulated, and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum ScenarioError {
    /// Not JSON, or not the fields of a scenario; the parser says where.
    #[error("the scenario cannot be read: {0}")]
    Json(#[from] serde_json::Error),
    /// Not an object of one law.
    #[error("a law is an object with one key, its name, such as {{\"coulomb\": {{\"mu\": 0.2}}}}; {known}")]
    NotOneLaw {
        /// The names of all laws.
        known: String,
    },
    /// A law that is not in the catalogue.
    #[error("there is no law \"{law}\"; {known}")]
    UnknownLaw {
        /// The name given.
        law: String,
        /// The names of all laws.
        known: String,
    },
    /// A parameter that the law does not have.
    #[error("the law {law} has no parameter \"{key}\"; its parameters are {known}")]
    UnknownParameter {
        /// Name of the law.
        law: &'static str,
        /// The key given.
        key: String,
        /// All parameters of the law.
        known: String,
    },
    /// A parameter without a value and without a default.
    #[error("the law {law} needs {missing}; its parameters are {known}")]
    MissingParameter {
        /// Name of the law.
        law: &'static str,
        /// The parameter with its unit.
        missing: String,
        /// All parameters of the law.
        known: String,
    },
    /// Two keys for one parameter.
    #[error("the law {law} has its parameter {parameter} twice, once as \"{key}\"")]
    GivenTwice {
        /// Name of the law.
        law: &'static str,
        /// The parameter.
        parameter: String,
        /// The second key.
        key: String,
    },
    /// A number where a list belongs, or the reverse.
    #[error("{parameter} of the law {law} must be {expected}")]
    WrongShape {
        /// Name of the law.
        law: &'static str,
        /// The parameter.
        parameter: String,
        /// What it must be.
        expected: &'static str,
    },
    /// Lists of different lengths that describe the same elements.
    #[error(
        "the law {law} needs two numbers for each element, but {stiffnesses} stiffnesses and {others} others were given"
    )]
    ElementLists {
        /// Name of the law.
        law: &'static str,
        /// Length of the first list.
        stiffnesses: usize,
        /// Length of the second list.
        others: usize,
    },
    /// Parameters that make no law.
    #[error("the law {law}: {source}")]
    Law {
        /// Name of the law.
        law: &'static str,
        /// What is wrong.
        source: LawError,
    },
    /// A law that is not one of the sliding speed alone cannot be smoothed in it.
    #[error("the law {law} has an internal state and cannot be smoothed in the speed; {known} can")]
    NotSliding {
        /// Name of the law.
        law: &'static str,
        /// The names of the laws that can.
        known: String,
    },
    /// Engine and law do not go together.
    #[error("the engine {engine} cannot take the law {law}; its engines are {possible}")]
    Engine {
        /// The engine asked for.
        engine: EngineName,
        /// Name of the law.
        law: &'static str,
        /// The engines that can.
        possible: String,
    },
    /// An engine of laws that a machine without one does not have.
    #[error("the engine {engine} needs a law, and none was given; without one the engines are {possible}")]
    EngineWithoutLaw {
        /// The engine asked for.
        engine: EngineName,
        /// The engines that can.
        possible: String,
    },
    /// A tolerance for an engine that has none.
    #[error("a tolerance belongs to the engines runge_kutta and bristle, but the engine is {engine}")]
    NoTolerance {
        /// The engine asked for.
        engine: EngineName,
    },
    /// Two descriptions of the same damping.
    #[error(
        "damping is given by linear and quadratic, or by peak_velocity_line, which stands for both; not by both ways"
    )]
    TwoDampings,
    /// Nothing says when the motion ends.
    #[error("the scenario needs a duration (s), or output times, the last of which is then the end")]
    NoEnd,
    /// More samples than this program gives out.
    #[error(
        "{count} samples were asked for, and at most {most} are given; lower the rate or the duration",
        count = Rounded::every_digit(*.count)
    )]
    TooManySamples {
        /// How many.
        count: f64,
        /// How many there may be.
        most: f64,
    },
    /// A quantity that cannot be.
    #[error(transparent)]
    Quantity(#[from] ModelError),
    /// The simulation has no answer.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}
