//! Passage of the corners of a spring.

use fmm_friction::SlidingLaw;
use fmm_model::Scalar;

use crate::automaton::Phase;
use crate::mechanics::Corner;
use crate::runge_kutta::field::Progress;
use crate::runge_kutta::slide::{Integrator, LANDINGS};
use crate::runge_kutta::step::Step;
use crate::scenario::State;

/// Attempts at landing on a corner: halvings follow where tangents do not lead there.
const ATTEMPTS: usize = LANDINGS + 60;

impl<D: Scalar, L: SlidingLaw<D> + ?Sized> Integrator<'_, D, L> {
    /// The `corner` of the spring, if `state` lies beyond it by more than rounding.
    ///
    /// Between two events a machine moves in one direction: it can pass the corner that is ahead, and no other.
    pub(super) fn passed(corner: Option<Corner>, state: State<D>) -> Option<Corner> {
        corner.filter(|corner| {
            let distance = (state.position.value() - corner.position) * corner.before;
            distance < -4.0 * f64::EPSILON * corner.position.abs()
        })
    }

    /// The step from `at` that ends at `corner`, beyond which `step` has gone.
    ///
    /// The force is continuous there: nothing shifts with the inputs, but no polynomial follows a motion across it.
    pub(super) fn to_corner(&self, phase: &Phase<D>, at: &Progress<D>, step: &Step<D>, corner: Corner) -> Step<D> {
        let distance = |state: State<D>| (state.position.value() - corner.position) * corner.before;
        let (mut before, mut beyond) = (0.0, step.length);
        let from = distance(at.state);
        let mut length = step.length * (from / (from - distance(step.end)));
        let mut landed = self.take(phase, at, length);
        for attempt in 0..ATTEMPTS {
            if self.is_near(corner, landed.end) {
                break;
            }
            let left = distance(landed.end);
            (before, beyond) = if left > 0.0 { (length, beyond) } else { (before, length) };
            let next = length - left / (landed.end.velocity.value() * corner.before);
            // Next to a turn, tangents may lead anywhere.
            let by_tangent = attempt < LANDINGS && next > before && next < beyond;
            length = if by_tangent { next } else { 0.5 * (before + beyond) };
            if !(length > before && length < beyond) {
                break;
            }
            landed = self.take(phase, at, length);
        }
        landed
    }

    /// Goes on behind `corner`, next to which the machine is.
    pub(super) fn pass(&mut self, phase: &Phase<D>, at: &mut Progress<D>, corner: Corner) {
        self.field.spring.range = corner.next;
        // An acceleration of the range before would be an error of the first stage.
        at.acceleration = self.field.acceleration(phase, at.side, at.time, at.state);
    }

    /// True if a straight line reaches from `state` to `corner`.
    fn is_near(&self, corner: Corner, state: State<D>) -> bool {
        (state.position.value() - corner.position).abs() <= state.velocity.value().abs() * self.close()
    }

    /// True if `state` is next to `corner`, or has passed it by rounding.
    pub(super) fn is_there(&self, corner: Corner, state: State<D>) -> bool {
        self.is_near(corner, state) || (state.position.value() - corner.position) * corner.before <= 0.0
    }
}
