//! Pace: length and method of the next step.

use crate::bristle::polynomial::Solved;
use crate::bristle::radau::STAGES;

/// Step times stiffness above which stiffness limits an explicit step while the states follow the motion (1).
const AT_LIMIT: f64 = 0.5;

/// Step times stiffness above which stability limits an explicit step (1).
pub(super) const STABLE: f64 = 4.0;

/// Change of the rates of the states in a step over step times stiffness, below which the states follow the motion (1).
/// In a transient this ratio is about 1.
const FOLLOWS: f64 = 0.2;

/// Angle of the machine in a step that only the motion limits (rad).
const SMOOTH_ANGLE: f64 = 0.25;

/// Relative change of the rates of the states in a step that only the motion limits (1).
const SMOOTH_CHANGE: f64 = 1.0;

/// Explicit steps that one implicit step must replace (1); it costs five to ten of them.
const STIFF: f64 = 8.0;

/// Step times stiffness up to which an implicit step does not replace enough explicit ones (1).
const NOT_STIFF: f64 = 4.0;

/// Steps of the series that one implicit step, of about equal cost, must replace (1).
const WORTH_AN_IMPLICIT_ONE: f64 = 2.0;

/// Part of the longest stable step of the series from which on stiffness limits it (1).
const NEARLY: f64 = 0.9;

/// Part of its estimated reach with which the first implicit step after the series is tried (1).
const PART_OF_REACH: f64 = 0.7;

/// Step times stiffness up to which an implicit step does not replace enough steps of the series (1).
const NOT_STIFF_FOR_SERIES: f64 = 15.0;

/// Greatest part of the way to the next turn in one implicit step (1): laws change with the speed, so that steps become
/// shorter near the turn.
const PART_TO_TURN: f64 = 0.3;

/// Explicit steps limited by stiffness, or implicit steps refused in vain, in a row before the method changes.
const PERSISTENT: usize = 3;

/// Count of unstable explicit steps before the method changes.
const UNSTABLE: usize = 5;

/// Ratio of the errors of a refused step and the one before it above which the shorter step was in vain (1).
const VAIN: f64 = 0.7;

/// Share of the change of the rates in one step that counts in the next (1), as a change may be small by chance.
const FADING: f64 = 0.3;

/// Length of the first implicit step over that of the explicit one before it (1).
const FIRST: f64 = 8.0;

/// Part of a period of the machine on its bristles with which a half cycle begins, if no other has (1).
const BEGINNING: f64 = 0.3;

/// Length (s) and error of a step that is not known.
const NO_STEP: (f64, f64) = (f64::INFINITY, 1.0);

/// Length and method of the steps of one half cycle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    /// True if steps are those of the collocation method.
    pub(super) implicit: bool,
    /// Length of the step to try next (s); infinite at the beginning of a half cycle.
    proposed: f64,
    /// Length (s) and error of the last step, in units of the tolerance.
    last: (f64, f64),
    /// Explicit steps in a row that stiffness has limited.
    stiff_steps: usize,
    /// Relative change of the rates of the states in the last of these steps, per second.
    variation: f64,
    /// Twice the number of explicit steps that stability has refused, less that of good ones. States that follow the
    /// motion to the last digit show no stiffness in a good step.
    unstable: usize,
    /// Greatest rate in a refused step (1/s).
    rate: f64,
    /// Error of the last refused step, in units of the tolerance.
    refused: f64,
    /// Refusals in a row that have been in vain.
    vain: usize,
    /// Length of a first step by the stiffness (s).
    first: f64,
    /// True if the half cycle waits for its first step.
    opens: bool,
    /// True if explicit steps are those of the series.
    expands: bool,
    /// Length of the last first step from rest over that by the stiffness (1).
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

    /// Begins a half cycle, at rest and so without stiffness.
    pub(super) fn turn(&mut self) {
        *self = Self { opening: self.opening, ..Self::new() };
    }

    /// Length of the next step (s), if known.
    pub(super) fn proposed(&self) -> Option<f64> {
        self.proposed.is_finite().then_some(self.proposed)
    }

    /// Length (s) of the first step of a half cycle of this `stiffness` per mass (1/s²).
    pub(super) fn first(&mut self, stiffness: f64) -> f64 {
        self.first = if stiffness > 0.0 { BEGINNING / stiffness.sqrt() } else { f64::MAX };
        self.first * (1.5 * self.opening).min(1.0)
    }

    /// Ends a limit of the steps; from now on the motion has the angular frequency `slow` (rad/s).
    pub(super) fn relax(&mut self, slow: f64) {
        (self.proposed, self.last) = (SMOOTH_ANGLE / slow, NO_STEP);
    }

    /// Notes an accepted step of `length` (s), from relative rest if `at_zero`. The motion has the angular frequency
    /// `slow` (rad/s); `room` (s) is left after the step, and the tangent of the relative velocity reaches zero after
    /// `to_turn` (s).
    pub(super) fn accept(&mut self, solved: Solved, length: f64, at_zero: bool, slow: f64, [room, to_turn]: [f64; 2]) {
        if std::mem::take(&mut self.opens) && at_zero {
            self.opening = length / self.first;
        }
        (self.refused, self.vain) = (f64::INFINITY, 0);
        let growth = self.growth(length, solved.error);
        self.proposed = length * if solved.quick { growth } else { growth.min(1.0) };
        if self.implicit {
            self.proposed = self.proposed.min(PART_TO_TURN * to_turn);
            // A length that still grows is no measure.
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
        // A variation at the limit of stability without following is noise; a variation that decreases is a transient.
        self.variation = (FADING * self.variation).max(if follows { solved.variation / length } else { 0.0 });
        let smooth = (SMOOTH_ANGLE / slow).min(SMOOTH_CHANGE / self.variation).min(room);
        let rate = if often_unstable { self.rate } else { solved.stiffness / length };
        if (self.stiff_steps >= PERSISTENT || often_unstable) && rate * smooth > STIFF {
            (self.implicit, self.unstable) = (true, 0);
            (self.proposed, self.last) = (FIRST * length, NO_STEP);
            (self.stiff_steps, self.variation) = (0, 0.0);
        }
    }

    /// Notes a step of the series of `length` (s). `limited` (1) is its part of the longest stable step, `reach` (1)
    /// the length of an implicit step over its own.
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
        // States that do not begin in their equilibrium jump there in any step that is longer than the jump.
        self.implicit = false;
        (self.last, self.refused, self.vain) = (NO_STEP, f64::INFINITY, 0);
        length / solved.stiffness.max(1.0)
    }

    /// Ratio of the next step to this one of `length` and `error`. A trend to shorter steps goes on.
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

    /// Ratio of the right length of a step to its length, from its error in units of the tolerance.
    fn change(&self, error: f64) -> f64 {
        if self.implicit {
            // At so high an order, the rest of the error allowed is worth little length.
            (0.8 * error.powf(-1.0 / (STAGES + 1) as f64)).clamp(0.1, 2.0)
        } else {
            // The estimate grows with the eighth power of the length.
            (0.9 / error.sqrt().sqrt().sqrt()).clamp(0.1, 3.0)
        }
    }
}
