//! The instants at which the motion changes its law.

use fmm_model::Scalar;

/// Sign of a sliding velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Towards negative positions.
    Negative,
    /// Towards positive positions.
    Positive,
}

impl Direction {
    /// The direction of a number that is not zero; zero counts as positive.
    pub(crate) fn of(value: f64) -> Self {
        if value < 0.0 { Self::Negative } else { Self::Positive }
    }

    /// −1 or +1.
    pub const fn sign(self) -> f64 {
        match self {
            Self::Negative => -1.0,
            Self::Positive => 1.0,
        }
    }
}

/// What the contact does between two events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mode {
    /// It slides in one direction.
    Slip(Direction),
    /// It holds.
    Stick,
}

/// What happens at an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum EventKind {
    /// The initial state.
    Start,
    /// The velocity reached zero and the load drives the contact back.
    Reversal,
    /// The velocity reached zero and the contact holds.
    Stop,
    /// The load left the static level and the contact slides again.
    Breakaway,
}

/// An event of a trajectory: when, where, what, and how narrowly it was decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event<D = f64> {
    /// What happened.
    pub kind: EventKind,
    /// t, time since the initial state (s), with its derivatives.
    pub time: D,
    /// x, position at that time (m), with its derivatives.
    pub position: D,
    /// v, velocity right after the event (m/s).
    pub velocity: D,
    /// What the contact does from here on.
    pub next: Mode,
    /// |L|, magnitude of the load on the contact at zero relative velocity (N).
    pub load: f64,
    /// F_s, the static level that the load is compared with (N).
    pub static_level: f64,
}

impl<D: Scalar> Event<D> {
    /// How far the load is beyond the static level, (|L| − F_s)/F_s: positive where the contact passes, zero or
    /// negative where it holds, and infinite where there is a load and nothing to hold it.
    ///
    /// It says something only where the velocity is zero: at a start in motion nothing is decided. Where the load
    /// exceeds the level by no more than rounding, the contact holds although the margin is not negative.
    ///
    /// A margin near zero says that a small change of the inputs turns a reversal into a stop or back; a
    /// gradient does not see that change.
    pub fn margin(&self) -> f64 {
        if self.load == self.static_level { 0.0 } else { (self.load - self.static_level) / self.static_level }
    }
}
