//! Why an identification could not be done.

use fmm_fit::FitError;
use fmm_frf::{Channel, FrfError};
use fmm_record::{Quantity, RecordError};

/// Why a record could not be prepared or identified.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// No record was given.
    #[error("there is no record to identify; give at least one ring-down")]
    NoRecord,
    /// The record is not a displacement or a velocity.
    #[error("{subject} must be {needed}, but the record is: {quantity}")]
    Quantity {
        /// What was to be done with the record.
        subject: &'static str,
        /// What it takes.
        needed: &'static str,
        /// What the record is.
        quantity: Quantity,
    },
    /// What was given as a drive is none.
    #[error("the drive of an experiment must be {expected}, but is: {found}")]
    Drive {
        /// What it may be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// The drive is not known during the whole record.
    #[error(
        "the drive is known from {known_from} s to {known_to} s, but the response lasts from {start} s to {end} s; crop the response"
    )]
    DriveTooShort {
        /// Beginning of the drive (s).
        known_from: f64,
        /// Its end (s).
        known_to: f64,
        /// Beginning of the response (s).
        start: f64,
        /// Its end (s).
        end: f64,
    },
    /// A pendulum has no spring that hardens.
    #[error("a pendulum has the sine for its restoring force; leave out the pendulum, or the terms of the spring")]
    TwoSprings,
    /// A force moves a mass, of which nothing is known.
    #[error(
        "a measured force tells the mass: give Machine::unknown() to find mass and stiffness, or a mass or a stiffness that is known"
    )]
    ForceWithoutScale,
    /// The estimator works on free vibrations.
    #[error("{estimator} needs a free vibration, but the record is that of a driven one")]
    FreeVibrationNeeded {
        /// Which estimator.
        estimator: &'static str,
    },
    /// A number that describes an experiment cannot be.
    #[error("{subject} must be {allowed}, not {value}")]
    NotAllowed {
        /// What was given.
        subject: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// No law was given to compare.
    #[error("there is no law to compare; give at least one candidate")]
    NoCandidate,
    /// Records of different quantities or units cannot be fitted together.
    #[error("records fitted together must agree in quantity and unit: one is {first}, another {other}")]
    MixedRecords {
        /// Quantity and unit of the first.
        first: String,
        /// Quantity and unit of one that differs.
        other: String,
    },
    /// Nothing moves.
    #[error("the record is constant at {value} {unit}: nothing moves")]
    NoMotion {
        /// The constant value.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// Too few samples to hold an oscillation.
    #[error("the record has {samples} samples; at least {needed} are needed")]
    TooShort {
        /// How many there are.
        samples: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The offset was to be taken from a rest that the record does not have.
    #[error("the record does not begin at rest, so there is no rest to take the offset from; fit the offset instead")]
    NoRest,
    /// Too few half swings.
    #[error(
        "the record shows {found} half swings above its noise; at least {needed} are needed to see a period and a \
         decay, and four samples in each to see a half swing"
    )]
    TooFewHalfSwings {
        /// How many were found.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Turning points that do not lie to either side of the centre by turns.
    #[error("amplitudes must be positive, but is {amplitude} {unit} at {time} s; end the record before it")]
    Amplitude {
        /// When (s).
        time: f64,
        /// The amplitude found there.
        amplitude: f64,
        /// Its unit.
        unit: String,
    },
    /// An estimator that works on velocities only.
    #[error("{estimator} needs a velocity, but the record is: {quantity}")]
    VelocityNeeded {
        /// Which estimator.
        estimator: &'static str,
        /// What the record is.
        quantity: Quantity,
    },
    /// Times of zero velocity that do not increase or do not lie in the record.
    #[error(
        "times of zero velocity must increase and lie within {start} s and {end} s, but number {index} is {time} s"
    )]
    Reversals {
        /// Number of the time, from 0.
        index: usize,
        /// The time (s).
        time: f64,
        /// First sample of the record (s).
        start: f64,
        /// Last sample of the record (s).
        end: f64,
    },
    /// Parameters that the half swings do not tell apart.
    #[error("{estimator} cannot tell {parameters} apart in this record; hold one of them or give a longer record")]
    Undetermined {
        /// Which estimator.
        estimator: &'static str,
        /// Names of the parameters.
        parameters: String,
    },
    /// A law of this name is not in the catalogue.
    #[error("there is no law called {name:?}; the laws are: {known}")]
    UnknownLaw {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A term of this name cannot stand beside a law.
    #[error(
        "there is no term called {name:?} to put beside a law; the terms are: linear, quadratic, cubic, cubic spring, quintic spring, any sign"
    )]
    UnknownTerm {
        /// The name given.
        name: String,
    },
    /// A linear damping was to be fitted beside a law that has one.
    #[error(
        "{law} has a viscous part: a linear damping of the machine beside it could not be told apart; leave one out"
    )]
    TwoDampings {
        /// Name of the law.
        law: &'static str,
    },
    /// There is no parameter of this name to hold.
    #[error("{law} has no parameter called {name:?} to hold; its parameters are: {known}")]
    NothingToHold {
        /// Name of the law.
        law: &'static str,
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// There is no parameter of this name.
    #[error("there is no parameter called {name:?}; the parameters are: {known}")]
    UnknownParameter {
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A parameter that has no value of its own was given none.
    #[error("{parameter} must be given a value")]
    MissingValue {
        /// Name of the parameter.
        parameter: String,
    },
    /// A parameter was to be held outside its bounds.
    #[error("{name} cannot be held at {value}: it must lie within {lower} and {upper}")]
    HeldOutOfBounds {
        /// Name of the parameter.
        name: String,
        /// The value given.
        value: f64,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// Force and response of a blow do not go together, or nothing was hit.
    #[error(transparent)]
    Impact(#[from] FrfError),
    /// A channel of a blow is not in its SI unit.
    #[error("the {channel} of a blow must be in {expected}, but is in {found}; scale the record")]
    Unit {
        /// Which channel.
        channel: Channel,
        /// The unit it needs.
        expected: &'static str,
        /// The unit it has.
        found: String,
    },
    /// Nothing in a force is a pulse.
    #[error("there is no blow in the force: its largest value is {level} N in a noise of {noise} N")]
    NoPulse {
        /// Largest force (N).
        level: f64,
        /// Standard deviation of its noise (N).
        noise: f64,
    },
    /// A channel of a blow is never quiet.
    #[error("the offset of the {channel} is not known: {samples} samples are quiet, at least {needed} are needed")]
    NoQuiet {
        /// Which channel.
        channel: Channel,
        /// How many samples are quiet.
        samples: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The machine moves against the force.
    #[error(
        "the force pushes one way ({impulse} N s) and the machine moves the other ({velocity} m/s); turn the sign of one channel"
    )]
    OppositeDirections {
        /// Impulse of the blow (N s).
        impulse: f64,
        /// Velocity that follows (m/s).
        velocity: f64,
    },
    /// No line of the spectrum lies in the band.
    #[error("no line of the spectrum lies between {low} Hz and {high} Hz; lines are {spacing} Hz apart")]
    NoLine {
        /// Low end of the band (Hz).
        low: f64,
        /// High end of the band (Hz).
        high: f64,
        /// Distance between lines (Hz).
        spacing: f64,
    },
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
        /// What was wrong.
        source: FitError,
    },
    /// The fitted motion could not be simulated.
    #[error("the motion fitted by {law} could not be simulated: {message}")]
    Simulation {
        /// Name of the law.
        law: &'static str,
        /// What was wrong.
        message: String,
    },
}
