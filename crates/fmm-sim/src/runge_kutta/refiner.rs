//! Derivatives of steps whose values are good, and whose derivatives may not be.

use fmm_friction::SlidingLaw;
use fmm_model::Scalar;

use super::by_speed::BySpeed;
use super::field::Field;
use super::progress::Progress;
use super::step::Step;
use crate::State;
use crate::automaton::Phase;

/// The estimated error from which on derivatives of a step are looked at again, in units of the tolerance and at most:
/// the estimate is that of formulas of orders 5 and 3, and the error of a step in which the law is smooth is a small
/// part of it.
const SUSPICIOUS: f64 = 1e5;
const MOST: f64 = 1e-6;

/// The part of the greatest derivative so far below which none matters.
const NEGLIGIBLE: f64 = 1e-3;

/// Watches the error of derivatives.
///
/// The steps are chosen by values alone, so that these are the same with derivatives and without. A steep law parts
/// neighbouring motions within a fraction of such a step: its derivatives are then found with the speed as the
/// independent variable.
pub(super) struct Refiner {
    allowed: f64,
    /// ω₀ (rad/s), which makes a velocity of a position.
    angular: f64,
    /// The greatest derivative so far in each direction, as one of the velocity.
    greatest: Vec<f64>,
}

impl Refiner {
    pub(super) fn new(directions: usize, tolerance: f64, angular: f64) -> Self {
        Self { allowed: (SUSPICIOUS * tolerance).min(MOST), angular, greatest: vec![0.0; directions] }
    }

    /// Puts the derivatives at the end of `step`, which begins at `at`, right, and gives those within; `None` if the
    /// step has good ones, or if its speed is no measure of time.
    pub(super) fn refine<D: Scalar, L: SlidingLaw<D> + ?Sized>(
        &mut self,
        field: &Field<D, L>,
        phase: &Phase<D>,
        at: &Progress<D>,
        step: &mut Step<D>,
    ) -> Option<BySpeed<D>> {
        if D::DIRECTIONS == 0 {
            return None;
        }
        let errors = step.derivative_errors();
        let mut sizes = vec![0.0; D::DIRECTIONS];
        for (direction, size) in sizes.iter_mut().enumerate() {
            let now = self.size(at.state, step, direction);
            // What is not finite is no size.
            let greatest = &mut self.greatest[direction];
            *greatest = greatest.max(if now.is_finite() { now } else { 0.0 });
            *size = now.max(NEGLIGIBLE * *greatest);
        }
        let error = |direction: usize| errors.of(direction, self.angular);
        let good = |direction: usize| error(direction) <= self.allowed * sizes[direction];
        if (0..D::DIRECTIONS).all(good) {
            return None;
        }
        let mut motion = BySpeed::follow(field, phase, at, step)?;
        // One form may be better in one direction and worse in another.
        let better = |direction| !(error(direction) <= motion.error(direction, self.angular));
        let better: Vec<_> = (0..D::DIRECTIONS).map(better).collect();
        if !better.contains(&true) {
            return None;
        }
        motion.replace(better);
        let end = motion.derive(field, phase, step.end, step.last_acceleration().value());
        let acceleration = field.acceleration(phase, at.side, at.time + step.length, end);
        step.correct(end, acceleration - acceleration.value() + step.last_acceleration().value());
        Some(motion)
    }

    /// The size of a derivative over a step from `begin`, as one of the velocity.
    fn size<D: Scalar>(&self, begin: State<D>, step: &Step<D>, direction: usize) -> f64 {
        let of = |state: State<D>| {
            state.velocity.partial(direction).abs() + self.angular * state.position.partial(direction).abs()
        };
        of(begin).max(of(step.end))
    }
}
