//! A contact at constant velocity on a spring that is not linear, and the time at which a level of friction is used up.

use fmm_model::{Oscillator, Restoring, Scalar};

use crate::error::SimulationError;
use crate::mechanics::{Curve, Piece, ROUNDING, SEARCH_BUDGET, Spring};
use crate::scenario::{Direction, State};

/// Excess of a level of friction over the load, along a motion of constant velocity.
///
/// ```text
/// r(τ) = F + F′ τ − s L(τ),   L = f(t + τ) − F_c(v) − F_k(x + v τ)
/// ```
pub(crate) struct SteadyReserve<'a, D> {
    pub(crate) oscillator: &'a Oscillator<D>,
    pub(crate) piece: &'a Piece<D>,
    /// t, beginning of the motion (s), and the state then.
    pub(crate) time: f64,
    pub(crate) state: State<f64>,
    /// F and F′, the level (N) and its slope (N/s).
    pub(crate) level: (f64, f64),
    /// s, the sign of the load that uses the level up.
    pub(crate) sign: f64,
}

impl<D: Scalar> SteadyReserve<'_, D> {
    /// Time within `span` (s) at which the reserve, positive at first but for rounding, falls to zero.
    ///
    /// Between corners of the spring the reserve lies above its tangent less the parabola of its greatest curvature:
    /// each step ends where that is zero, so that no zero is missed.
    pub(crate) fn first_zero(&self, span: f64, budget: &mut usize) -> Result<Option<f64>, SimulationError> {
        let Self { oscillator, piece, state, sign, .. } = self;
        let State { position: begin, velocity } = *state;
        let direction = Direction::of(velocity);
        let mut spring = Spring::new(oscillator);
        spring.begin(D::from(begin), direction);
        let damping = oscillator.damping_force(D::from(velocity)).value();
        let mut elapsed = 0.0;
        while elapsed < span {
            let position = begin + velocity * elapsed;
            let force = Curve::force(piece, D::from(self.time + elapsed)).plain_without_decay().jet(0.0);
            let restoring = spring.force(D::from(position)).value();
            let level = self.level.0 + self.level.1 * elapsed;
            let value = level - sign * (force.value - damping - restoring);
            let slope = self.level.1 - sign * (force.slope - spring.slope(D::from(position)) * velocity);
            if !(value.is_finite() && slope.is_finite()) {
                return Err(SimulationError::NotFinite { time: self.time + elapsed });
            }
            let size = level.abs() + force.size + damping.abs() + restoring.abs();
            let low = value <= ROUNDING * size;
            if low && slope < 0.0 {
                return Ok(Some(elapsed));
            }
            let corner = spring.ahead(direction);
            let to_corner = corner.map_or(f64::INFINITY, |corner| (corner.position - begin) / velocity);
            let end = span.min(to_corner);
            let value = value.max(0.0);
            let next = self.reach(elapsed, end, value, slope, force.most_curvature);
            if next >= end {
                if end == span {
                    return Ok(None);
                }
                elapsed = end;
                spring.range = corner.map_or(spring.range, |corner| corner.next);
            } else if next > elapsed {
                elapsed = next;
            } else {
                return Ok(Some(elapsed));
            }
            *budget =
                budget.checked_sub(1).ok_or_else(|| SimulationError::event_budget(SEARCH_BUDGET, self.time + span))?;
        }
        Ok(None)
    }

    /// Time before which a reserve of this `value` and `slope` at `elapsed` is not used up, or `end`, under a force of
    /// this greatest `curvature` (N/s²).
    fn reach(&self, elapsed: f64, end: f64, value: f64, slope: f64, curvature: f64) -> f64 {
        let mut end = end;
        loop {
            let curvature = curvature + self.bend(end);
            // The positive root of value + slope h − curvature h²/2, without cancellation.
            let root = (slope * slope + 2.0 * curvature * value).sqrt();
            let step = if slope > 0.0 { (slope + root) / curvature } else { 2.0 * value / (root - slope) };
            let half = elapsed + 0.5 * (end - elapsed);
            if !(half > elapsed && half < end) {
                return elapsed;
            }
            // The less of the way the bound has to hold for, the less is the curvature.
            let gains = !curvature.is_finite() || self.bend(half) < self.bend(end);
            if !gains || elapsed + step >= half {
                return (elapsed + step).min(end);
            }
            end = half;
        }
    }

    /// Greatest curvature (N/s²) of the spring force in time, from the beginning until `elapsed`.
    fn bend(&self, elapsed: f64) -> f64 {
        let State { position, velocity } = self.state;
        match self.oscillator.restoring() {
            Restoring::Polynomial { cubic, quintic } => {
                let most = position.abs().max((position + velocity * elapsed).abs());
                let bend = 6.0 * cubic.value().abs() + 20.0 * quintic.value().abs() * most * most;
                self.oscillator.stiffness().value() * bend * most * velocity * velocity
            }
            _ => 0.0,
        }
    }
}
