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

/// Mode of the contact between two events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mode {
    /// It slides in one direction.
    Slip(Direction),
    /// It slides and gains speed, under a law that depends on the acceleration.
    Gaining(Direction),
    /// It slides at constant speed, its friction being between the two levels of a law that depends on the
    /// acceleration.
    Steady(Direction),
    /// It slides and loses speed, under a law that depends on the acceleration.
    Losing(Direction),
    /// It holds.
    Stick,
}

impl Mode {
    /// The direction in which it slides; `None` if it holds.
    pub const fn direction(self) -> Option<Direction> {
        match self {
            Self::Slip(direction) | Self::Gaining(direction) | Self::Steady(direction) | Self::Losing(direction) => {
                Some(direction)
            }
            Self::Stick => None,
        }
    }
}

/// Kind of an event.
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
    /// The contact begins to gain speed, to lose it, or to keep it, under a law that depends on the acceleration.
    BranchChange,
    /// The element of this index of a bristle law begins to slide.
    Yield(usize),
}

/// An event of a trajectory: when, where, what, and how narrowly it was decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event<D = f64> {
    /// Kind of the event.
    pub kind: EventKind,
    /// t, time since the initial state (s), with its derivatives.
    pub time: D,
    /// x, position at that time (m), with its derivatives.
    pub position: D,
    /// v, velocity right after the event (m/s), with its derivatives.
    pub velocity: D,
    /// Mode of the contact after the event.
    pub next: Mode,
    /// |L|, magnitude of the load on the contact at zero relative velocity (N).
    pub load: f64,
    /// F_s, the static level that the load is compared with (N).
    pub static_level: f64,
    /// Whether the event was only grazed, so that its time has no derivative; derivatives after it leave its change
    /// out.
    pub grazing: bool,
}

impl<D: Scalar> Event<D> {
    /// Distance of the load from the static level, (|L| − F_s)/F_s (1): positive where the contact passes, zero or
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
