//! Spring on one side of its corners, continued beyond them.

use fmm_model::{Oscillator, Restoring, Scalar};

use crate::scenario::Direction;

/// ω₀ t over the sampled time t below which the spring does not shape the motion (1). A closed form has then lost four
/// digits.
pub(crate) const WEAK_SPRING: f64 = 1e-2;

/// The spring of an oscillator in the range of positions in which the machine is.
///
/// Stages of a step may lie beyond a corner although its end does not: each step takes the force of one range, however
/// far they reach.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spring<'a, D> {
    oscillator: &'a Oscillator<D>,
    pub(crate) range: Range,
}

/// A range of positions without a corner of the spring within.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Range {
    Between,
    /// Beyond the corner on the positive side, or on the negative side.
    Beyond(bool),
}

/// An end of a range.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    /// m.
    pub(crate) position: f64,
    /// The sign of the distance from the corner before it is passed.
    pub(crate) before: f64,
    /// The range behind it.
    pub(crate) next: Range,
}

impl<'a, D: Scalar> Spring<'a, D> {
    /// The spring of `oscillator` between its corners.
    pub(crate) const fn new(oscillator: &'a Oscillator<D>) -> Self {
        Self { oscillator, range: Range::Between }
    }

    /// Takes the range in which a motion goes on from `position` (m) in this `direction`.
    pub(crate) fn begin(&mut self, position: D, direction: Direction) {
        let Some(corner) = self.oscillator.restoring().corner() else { return };
        let position = position.value();
        let distance = position.abs() - corner.value();
        let positive = if position == 0.0 { direction == Direction::Positive } else { position > 0.0 };
        let is_outwards = positive == (direction == Direction::Positive);
        let is_beyond = distance > 0.0 || distance == 0.0 && is_outwards;
        self.range = if is_beyond { Range::Beyond(positive) } else { Range::Between };
    }

    /// The restoring force (N) at `position` (m), continued from this range.
    #[inline]
    pub(crate) fn force(&self, position: D) -> D {
        match (self.oscillator.restoring(), self.range) {
            (Restoring::Bilinear { inner, .. }, Range::Between) => self.oscillator.stiffness() * inner * position,
            (Restoring::Bilinear { corner, inner, outer, .. }, Range::Beyond(positive)) => {
                let sign = if positive { 1.0 } else { -1.0 };
                self.oscillator.stiffness() * (inner * position + (outer - inner) * (position - corner * sign))
            }
            _ => self.oscillator.restoring_force(position),
        }
    }

    /// The slope of the force (N/m) at `position` (m), in this range.
    pub(crate) fn slope(&self, position: D) -> f64 {
        let slope = match (self.oscillator.restoring(), self.range) {
            (Restoring::Bilinear { inner, .. }, Range::Between) => self.oscillator.stiffness() * inner,
            (Restoring::Bilinear { outer, .. }, Range::Beyond(_)) => self.oscillator.stiffness() * outer,
            (restoring, _) => restoring.slope(self.oscillator.stiffness(), position).0,
        };
        slope.value()
    }

    /// The corners at which this range ends.
    pub(crate) fn ends(&self) -> impl Iterator<Item = Corner> + use<D> {
        let distance = self.oscillator.restoring().corner().map(Scalar::value);
        let sides = match self.range {
            Range::Between => [Some((1.0, -1.0, Range::Beyond(true))), Some((-1.0, 1.0, Range::Beyond(false)))],
            Range::Beyond(true) => [Some((1.0, 1.0, Range::Between)), None],
            Range::Beyond(false) => [Some((-1.0, -1.0, Range::Between)), None],
        };
        let corner = move |(side, before, next)| Some(Corner { position: distance? * side, before, next });
        sides.into_iter().flatten().filter_map(corner)
    }

    /// The corner at which a motion of this `direction` leaves the range.
    pub(crate) fn ahead(&self, direction: Direction) -> Option<Corner> {
        self.oscillator.restoring().corner()?;
        self.ends().find(|corner| corner.before == -direction.sign())
    }

    /// The corner behind which the machine is in the range `next`.
    pub(crate) fn end_towards(&self, next: Range) -> Option<Corner> {
        self.ends().find(|corner| corner.next == next)
    }
}
