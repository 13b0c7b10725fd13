//! The derivatives of a step in which the law is steep, with the speed as the independent variable.

use fmm_friction::SlidingLaw;
use fmm_model::Scalar;

use crate::automaton::Phase;
use crate::dormand_prince::{Rates, dense_stages, errors, interpolated, mean_rate, nested, step};
use crate::runge_kutta::field::{Field, Progress};
use crate::runge_kutta::step::Step;
use crate::scenario::State;

/// The least acceleration of a step, in units of its greatest, with which the speed is still a measure of time.
const LEAST: f64 = 0.05;

/// Time and position as functions of the speed, over the speeds of a step.
///
/// ```text
/// dt/dw = 1/(s x″),   dx/dw = x′/(s x″),   x′ = v_b + s w
/// ```
///
/// At a given speed w the friction of neighbouring motions differs by the change of the parameters, not by its slope
/// over the speed. An infinite slope at rest does not enter these equations.
pub(super) struct BySpeed<D> {
    /// Speed at the beginning, and by how much it grows (m/s).
    begin: f64,
    growth: f64,
    sign: f64,
    start: [D; 2],
    end: [D; 2],
    nested: [[D; 7]; 2],
    rates: [Rates<D>; 2],
    /// 1 in each direction in which these derivatives are better than those of the step, else 0.
    better: D,
    /// Greatest magnitudes of velocity (m/s) and acceleration (m/s²).
    greatest: [f64; 2],
}

impl<D: Scalar> BySpeed<D> {
    /// Follows the motion over `taken`, which begins at `at`; `None` if its speed turns or hardly changes.
    pub(super) fn follow<L: SlidingLaw<D> + ?Sized>(
        field: &Field<D, L>,
        phase: &Phase<D>,
        at: &Progress<D>,
        taken: &Step<D>,
    ) -> Option<Self> {
        let sign = phase.direction.sign();
        let (least, most) = taken.range_of_acceleration();
        let greatest =
            [at.state.velocity.value().abs().max(taken.end.velocity.value().abs()), least.abs().max(most.abs())];
        let [first, last] = [at.state, taken.end].map(|state| field.speed(phase, state.velocity));
        let (begin, growth) = (first.value(), last.value() - first.value());
        let steady = least * most > 0.0 && least.abs().min(most.abs()) >= LEAST * greatest[1];
        if !steady || growth == 0.0 {
            return None;
        }
        // From the time of the step's beginning, which is given, to the speed there.
        let late = -(first - begin) / (at.acceleration.value() * sign);
        let start = [late, at.state.position + late * at.state.velocity.value()];
        let rate = |beyond: f64, now: &[D], stage: usize, rates: &mut [Rates<D>]| {
            let speed = begin + beyond;
            let velocity = field.belt + speed * sign;
            let outside = field.outside(phase, now[0] + at.time);
            let state = State { position: now[1], velocity };
            let acceleration = field.balance(phase, at.side, outside, state, D::from(speed));
            let duration = D::from(sign) / acceleration;
            rates[0][stage] = duration;
            rates[1][stage] = velocity * duration;
        };
        let mut rates = [[D::from(0.0); 16]; 2];
        let (mut now, mut end) = (start, start);
        rate(0.0, &start, 0, &mut rates);
        step(&start, growth, &mut rates, &mut now, &mut end, rate);
        dense_stages(&start, growth, &mut rates, &mut now, rate);
        let nested = [0, 1].map(|unknown| nested(&rates[unknown], mean_rate(&rates[unknown]) * growth, growth));
        Some(Self { begin, growth, sign, start, end, nested, rates, better: D::from(0.0), greatest })
    }

    /// The local error of a derivative in `direction`, as one of the velocity (m/s) of a machine that vibrates with
    /// `angular` (rad/s); see [`error`](crate::dormand_prince::error).
    pub(super) fn error(&self, direction: usize, angular: f64) -> f64 {
        let [time, position] = [0, 1].map(|unknown| errors(&self.rates[unknown]));
        let norm = |time: D, position: D| {
            let (time, position) = (time.partial(direction), position.partial(direction));
            let [velocity, acceleration] = self.greatest;
            (angular * position).powi(2) + (angular * velocity * time).powi(2) + (acceleration * time).powi(2)
        };
        crate::dormand_prince::error(self.growth.abs(), norm(time.0, position.0), norm(time.1, position.1))
    }

    /// The `state`, of this `acceleration` (m/s²), with these derivatives if they are better, at a given time.
    ///
    /// Next to rest on a steep law the acceleration changes within the error of a step. The acceleration of the state
    /// itself therefore converts a speed to a time, so that the time of an event is that of its speed.
    pub(super) fn derive<L: SlidingLaw<D> + ?Sized>(
        &self,
        field: &Field<D, L>,
        phase: &Phase<D>,
        state: State<D>,
        acceleration: f64,
    ) -> State<D> {
        let speed = field.speed(phase, state.velocity).value();
        let part = ((speed - self.begin) / self.growth).clamp(0.0, 1.0);
        let [time, position] = if part == 1.0 {
            self.end
        } else {
            [0, 1].map(|unknown| interpolated(self.start[unknown], &self.nested[unknown], part))
        };
        // From that speed to the given time.
        let late = -(time - time.value());
        let derivatives =
            [position + late * state.velocity.value(), field.belt + speed * self.sign + late * acceleration];
        State {
            position: self.graft(derivatives[0], state.position),
            velocity: self.graft(derivatives[1], state.velocity),
        }
    }

    /// One number with the derivatives of another in the directions in which these are better.
    fn graft(&self, derivatives: D, number: D) -> D {
        let from = |direction| if self.better.partial(direction) == 1.0 { derivatives } else { number };
        by_direction::<D>(|direction| from(direction).partial(direction)) + number.value()
    }
}

/// A number of value zero with these derivatives: room for one plain number a direction that takes no memory.
fn by_direction<D: Scalar>(of: impl Fn(usize) -> f64) -> D {
    (0..D::DIRECTIONS).fold(D::from(0.0), |sum, direction| sum + D::variable(0.0, direction) * of(direction))
}

/// Estimated error of a derivative above which it is computed again, in units of the tolerance. The estimate is that of
/// formulas of orders 5 and 3; the error of a step on a smooth law is a small part of it.
const SUSPICIOUS: f64 = 1e5;

/// Greatest estimated error of a derivative that is not computed again, relative to the derivative (1).
const MOST: f64 = 1e-6;

/// The part of the greatest derivative so far below which none matters.
const NEGLIGIBLE: f64 = 1e-3;

/// Watches the error of derivatives.
///
/// The steps are chosen by values alone, so that derivatives do not change the values. A steep law parts neighbouring
/// motions within a fraction of such a step: its derivatives are then found with the speed as the independent variable.
pub(super) struct Refiner<D> {
    allowed: f64,
    /// ω₀ (rad/s), which makes a velocity of a position.
    angular: f64,
    /// The greatest derivative so far in each direction, as one of the velocity.
    greatest: D,
}

impl<D: Scalar> Refiner<D> {
    pub(super) fn new(tolerance: f64, angular: f64) -> Self {
        Self { allowed: (SUSPICIOUS * tolerance).min(MOST), angular, greatest: D::from(0.0) }
    }

    /// Puts the derivatives at the end of `step`, which begins at `at`, right, and gives those within; `None` if the
    /// step has good ones, or if its speed is no measure of time.
    pub(super) fn refine<L: SlidingLaw<D> + ?Sized>(
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
        let error = |direction: usize| errors.of(direction, self.angular);
        let (mut greatest, mut are_good) = (self.greatest, true);
        for direction in 0..D::DIRECTIONS {
            let (now, known) = (self.size(at.state, step, direction), greatest.partial(direction));
            // A size that is not finite does not count.
            if now.is_finite() && now > known {
                greatest += D::variable(0.0, direction) * (now - known);
            }
            are_good &= error(direction) <= self.allowed * now.max(NEGLIGIBLE * greatest.partial(direction));
        }
        self.greatest = greatest;
        if are_good {
            return None;
        }
        let mut motion = BySpeed::follow(field, phase, at, step)?;
        // One form may be better in one direction and worse in another.
        let better = |direction| !(error(direction) <= motion.error(direction, self.angular));
        motion.better = by_direction(|direction| f64::from(better(direction)));
        if (0..D::DIRECTIONS).all(|direction| motion.better.partial(direction) == 0.0) {
            return None;
        }
        let end = motion.derive(field, phase, step.end, step.last_acceleration().value());
        let acceleration = field.acceleration(phase, at.side, at.time + step.length, end);
        step.correct(end, acceleration - acceleration.value() + step.last_acceleration().value());
        Some(motion)
    }

    /// The size of a derivative over a step from `begin`, as one of the velocity.
    fn size(&self, begin: State<D>, step: &Step<D>, direction: usize) -> f64 {
        let of = |state: State<D>| {
            state.velocity.partial(direction).abs() + self.angular * state.position.partial(direction).abs()
        };
        of(begin).max(of(step.end))
    }
}
