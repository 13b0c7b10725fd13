//! Pace: length and method of the next step.

use super::motion::Solved;
use super::radau::STAGES;

/// Step times stiffness above which states that follow the motion are what limits an explicit step.
const AT_LIMIT: f64 = 0.5;

/// Step times stiffness above which explicit steps are as long as they are for the sake of stability.
pub(super) const STABLE: f64 = 4.0;

/// Change of the rates of the states over a step, in units of step times stiffness, below which they follow the motion;
/// a transient changes as much as it is stiff.
const FOLLOWS: f64 = 0.2;

/// The angle (rad) by which a machine goes on, and the change of the rates of the states, in a step that only the
/// motion limits.
const SMOOTH_ANGLE: f64 = 0.25;
const SMOOTH_CHANGE: f64 = 1.0;

/// Step times stiffness from which on an implicit step is worth the explicit ones that it replaces, and up to which it
/// is not. An implicit one costs five to ten explicit ones.
const STIFF: f64 = 8.0;
const NOT_STIFF: f64 = 4.0;

/// Steps of the series that an implicit one, which costs about as much, must be worth, the part of the longest stable
/// one from which on they are limited by stiffness, the part of its reach that the first implicit one is tried with,
/// and step times stiffness up to which an implicit step is not worth those that it replaces.
const WORTH_AN_IMPLICIT_ONE: f64 = 2.0;
const NEARLY: f64 = 0.9;
const PART_OF_REACH: f64 = 0.7;
const NOT_STIFF_FOR_SERIES: f64 = 15.0;

/// The part of the way to the next turn that an implicit step goes at most: laws fall with the speed, so that steps
/// become shorter with it.
const PART_TO_TURN: f64 = 0.3;

/// Explicit steps that have to be limited by stiffness in a row, and implicit ones that have to be refused in vain.
const PERSISTENT: usize = 3;

/// The count of unstable explicit steps from which on their stiffness is believed.
const UNSTABLE: usize = 5;

/// What a shorter step has to leave of the error, or it was in vain.
const VAIN: f64 = 0.7;

/// How much of the change of the rates in one step counts in the next, as one may be small by chance.
const FADING: f64 = 0.3;

/// The first implicit step after explicit ones, in units of these.
const FIRST: f64 = 8.0;

/// The part of a period of the machine on its bristles with which a swing begins, if no other has.
const BEGINNING: f64 = 0.3;

/// Nothing is known of a step before.
const NO_STEP: (f64, f64) = (f64::INFINITY, 1.0);

/// Length and method of the steps of one swing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    /// Whether steps are those of the collocation method.
    pub(super) implicit: bool,
    /// Length of the step to try next (s); infinite at the beginning of a swing.
    proposed: f64,
    /// Length (s) and error of the last step, in units of the tolerance.
    last: (f64, f64),
    /// Explicit steps in a row that stiffness has limited, and the relative change of the rates of the states in the
    /// last of these, per second.
    stiff_steps: usize,
    variation: f64,
    /// Twice the explicit steps that stability has refused, less those that were good, and the greatest rate (1/s)
    /// then: states that follow the motion to the last digit show no stiffness in a good step.
    unstable: usize,
    rate: f64,
    /// Error of the last refused step, and how many refusals in a row have been in vain.
    refused: f64,
    vain: usize,
    /// Length that a first step would have by the stiffness (s), whether the swing waits for its first step, and the
    /// part of that length that the last first step from rest has had.
    first: f64,
    opens: bool,
    /// Whether explicit steps are those of the series.
    expands: bool,
    opening: f64,
}

impl Pace {
    pub(super) const fn new() -> Self {
        Self {
            implicit: false,
            proposed: f64::INFINITY,
            last: NO_STEP,
            stiff_steps: 0,
            variation: 0.0,
            unstable: 0,
            rate: 0.0,
            refused: f64::INFINITY,
            vain: 0,
            first: 0.0,
            opens: true,
            expands: false,
            opening: f64::INFINITY,
        }
    }

    /// A swing begins, at rest and so without stiffness.
    pub(super) fn turn(&mut self) {
        *self = Self { opening: self.opening, ..Self::new() };
    }

    /// Length of the next step (s), if anything is known of it.
    pub(super) fn proposed(&self) -> Option<f64> {
        self.proposed.is_finite().then_some(self.proposed)
    }

    /// Length (s) of the first step of a swing of this `stiffness` per mass (1/s²).
    pub(super) fn first(&mut self, stiffness: f64) -> f64 {
        self.first = if stiffness > 0.0 { BEGINNING / stiffness.sqrt() } else { f64::MAX };
        self.first * (1.5 * self.opening).min(1.0)
    }

    /// What has kept steps short is over; from now on the motion goes on with the angular frequency `slow` (rad/s).
    pub(super) fn relax(&mut self, slow: f64) {
        (self.proposed, self.last) = (SMOOTH_ANGLE / slow, NO_STEP);
    }

    /// Takes note of an accepted step of `length` (s) from relative rest (`at_zero`) or not, where the motion has the
    /// angular frequency `slow` (rad/s), and `room` (s) is left after it, `to_turn` (s) to where the relative velocity
    /// would pass zero if it went on falling as it does.
    pub(super) fn accept(&mut self, solved: Solved, length: f64, at_zero: bool, slow: f64, [room, to_turn]: [f64; 2]) {
        if std::mem::take(&mut self.opens) && at_zero {
            self.opening = length / self.first;
        }
        (self.refused, self.vain) = (f64::INFINITY, 0);
        let growth = self.growth(length, solved.error);
        self.proposed = length * if solved.quick { growth } else { growth.min(1.0) };
        if self.implicit {
            self.proposed = self.proposed.min(PART_TO_TURN * to_turn);
            // What still grows is no measure.
            let not_stiff = if self.expands { NOT_STIFF_FOR_SERIES } else { NOT_STIFF };
            if solved.stiffness <= not_stiff && self.proposed <= 1.5 * length {
                self.implicit = false;
                (self.proposed, self.last) = (length / solved.stiffness.max(1.0), NO_STEP);
            }
            return;
        }
        let often_unstable = self.unstable >= UNSTABLE;
        self.unstable = self.unstable.saturating_sub(1);
        let follows = solved.variation < FOLLOWS * solved.stiffness && solved.stiffness > AT_LIMIT;
        let at_limit = solved.stiffness > STABLE;
        if !(follows || at_limit || often_unstable) {
            (self.stiff_steps, self.variation) = (0, 0.0);
            return;
        }
        self.stiff_steps += 1;
        // What varies at the limit of stability and does not follow is noise; what varies less and less is a transient.
        self.variation = (FADING * self.variation).max(if follows { solved.variation / length } else { 0.0 });
        let smooth = (SMOOTH_ANGLE / slow).min(SMOOTH_CHANGE / self.variation).min(room);
        let rate = if often_unstable { self.rate } else { solved.stiffness / length };
        if (self.stiff_steps >= PERSISTENT || often_unstable) && rate * smooth > STIFF {
            (self.implicit, self.unstable) = (true, 0);
            (self.proposed, self.last) = (FIRST * length, NO_STEP);
            (self.stiff_steps, self.variation) = (0, 0.0);
        }
    }

    /// Takes note of a step of the series of `length` (s), where `limited` (1) is its part of the longest one that is
    /// stable, and an implicit step would `reach` so many times as far.
    pub(super) fn expand(&mut self, limited: f64, reach: f64, length: f64) {
        (self.opens, self.expands) = (false, true);
        (self.proposed, self.last) = (length, NO_STEP);
        if limited > NEARLY && reach > WORTH_AN_IMPLICIT_ONE {
            self.implicit = true;
            self.proposed = PART_OF_REACH * reach.min(FIRST) * length;
        }
    }

    /// Length (s) with which to try a step again that was too long.
    pub(super) fn refuse(&mut self, solved: Solved, length: f64) -> f64 {
        if !self.implicit && solved.stiffness > STABLE {
            (self.unstable, self.rate) = (self.unstable + 2, solved.stiffness / length);
        }
        let in_vain = self.implicit && solved.error > VAIN * self.refused;
        (self.refused, self.vain) = (solved.error, if in_vain { self.vain + 1 } else { 0 });
        if self.vain < PERSISTENT {
            return length * self.change(solved.error);
        }
        // States that do not begin where they would follow the motion jump there, however short the step is, until it
        // is as short as the jump.
        self.implicit = false;
        (self.last, self.refused, self.vain) = (NO_STEP, f64::INFINITY, 0);
        length / solved.stiffness.max(1.0)
    }

    /// By which factor the next step may be longer than this one of `length` and `error`.
    ///
    /// Steps that become shorter with the motion go on doing so.
    ///
    /// # References
    /// K. Gustafsson, "Control-theoretic techniques for stepsize selection in implicit Runge-Kutta methods", ACM Trans.
    /// Math. Software 20 (1994) 496, doi 10.1145/198429.198437.
    fn growth(&mut self, length: f64, error: f64) -> f64 {
        let growth = self.change(error);
        let (before, error_before) = std::mem::replace(&mut self.last, (length, error));
        let trend = if before.is_finite() { length / before * growth / self.change(error_before) } else { 1.0 };
        growth * trend.clamp(0.5, 1.0)
    }

    /// By which factor to change the length of a step with this error, in units of the tolerance.
    fn change(&self, error: f64) -> f64 {
        if self.implicit {
            // Of so high an order, a step hardly longer is one too long: what is left of the error is worth little
            // length.
            (0.8 * error.powf(-1.0 / (STAGES + 1) as f64)).clamp(0.1, 2.0)
        } else {
            // The estimate grows with the eighth power of the length.
            (0.9 / error.sqrt().sqrt().sqrt()).clamp(0.1, 3.0)
        }
    }
}
