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
    /// Under a law that depends on the acceleration, the contact begins to gain, to lose or to keep its speed.
    BranchChange,
    /// The element of this index of a bristle law begins to slide.
    Yield(usize),
}

/// An event of a trajectory: kind, time, place, and the margin of its decision.
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
    /// True for an event that was only grazed. Its time has no derivative, and derivatives after it leave its change
    /// out.
    pub grazing: bool,
}

impl<D: Scalar> Event<D> {
    /// Distance of the load from the static level, (|L| − F_s)/F_s (1): positive if the contact passes, zero or
    /// negative if it holds, and infinite under a load without a static level.
    ///
    /// It has a meaning only at zero velocity: a start in motion decides nothing. If the load exceeds the level by no
    /// more than rounding, the contact holds although the margin is positive.
    ///
    /// With a margin near zero a small change of the inputs turns a reversal into a stop or back. A gradient does not
    /// show that change.
    pub fn margin(&self) -> f64 {
        if self.load == self.static_level { 0.0 } else { (self.load - self.static_level) / self.static_level }
    }
}
