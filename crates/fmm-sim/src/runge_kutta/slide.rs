//! One stretch of sliding, step by step.

use fmm_friction::SlidingLaw;
use fmm_model::{Restoring, Scalar};

use crate::automaton::{Ended, Ending, Phase, Slide};
use crate::dormand_prince::{COEFFICIENTS, Within};
use crate::error::SimulationError;
use crate::mechanics::{Forcing, WEAK_SPRING, load};
use crate::runge_kutta::by_speed::{BySpeed, Refiner};
use crate::runge_kutta::field::{Field, Guard, Progress, Side};
use crate::runge_kutta::step::{STABLE, Step, first_zero_within};
use crate::scenario::{Scenario, State};
use crate::trajectory::Recorder;

/// Greatest number of steps of one run: some 15 000 periods at the default tolerance, in about a second.
const STEP_BUDGET: usize = 1_000_000;

/// Attempts at landing on an event; Newton's method needs two or three.
pub(super) const LANDINGS: usize = 12;

/// Least dip of the acceleration of a step below zero, in units of its error in the velocity over its length.
const DIP: f64 = 10.0;

/// Error assigned to a step that has found an event and not landed on it: the next step will be half as long.
const NOT_LANDED: f64 = 256.0;

/// Follows stretches of sliding for the Runge-Kutta engine.
pub(super) struct Integrator<'a, D, L: ?Sized> {
    pub(super) field: Field<'a, D, L>,
    tolerance: f64,
    /// ω₀ of small vibrations, or a frequency of little rotation within the sampled time if that is greater (rad/s).
    angular: f64,
    /// Displacement on the spring that the static level holds (m); a smaller motion does not matter.
    held: f64,
    /// Scale of a motion that no spring turns round within the sampled time; `None` with such a spring.
    run: Option<Run>,
    /// Length of the step to try next (s).
    length: f64,
    /// Steps that are taken.
    steps: usize,
    refiner: Refiner<D>,
}

/// Scale of a motion without a spring. An acceleration tells how fast it becomes for as long as a step alone.
struct Run {
    /// Sampled time (s).
    duration: f64,
    /// Largest speed of the stretch (m/s).
    fastest: f64,
}

impl<'a, D: Scalar, L: SlidingLaw<D> + ?Sized> Integrator<'a, D, L> {
    pub(super) fn new(scenario: &'a Scenario<D, L>, drive: &Forcing<D>, tolerance: f64, end: f64) -> Self {
        let oscillator = scenario.oscillator();
        // A spring too weak to matter within the sampled time gives no scale.
        let natural = oscillator.natural_angular_frequency().value();
        let angular = if end > 0.0 { natural.max(WEAK_SPRING / end) } else { natural };
        // Where there is neither a spring nor a time, nothing moves.
        let angular = if angular > 0.0 { angular } else { 1.0 };
        let static_force = (scenario.law().breakaway() * scenario.largest_load()).value();
        let held = static_force / (oscillator.mass().value() * angular * angular);
        Self {
            field: Field::new(scenario, drive),
            tolerance,
            angular,
            held,
            run: (natural * end < 1.0 && end > 0.0).then_some(Run { duration: end, fastest: 0.0 }),
            length: 0.1 / angular,
            steps: 0,
            refiner: Refiner::new(tolerance, angular),
        }
    }

    /// The angular frequency (rad/s) of small vibrations about `position`, or that of the machine if it is greater.
    fn angular_at(&self, position: D) -> f64 {
        match self.field.oscillator.restoring() {
            Restoring::Linear => self.angular,
            // Where a spring pushes away there is none.
            _ => self.angular.max((self.field.spring.slope(position) * self.field.per_mass.value()).sqrt()),
        }
    }

    /// Amplitudes (m, m/s) that errors are relative to, where the machine vibrates with `angular` (rad/s).
    fn scale(&self, state: State<D>, acceleration: D, angular: f64) -> State<f64> {
        let speed = state.velocity.value().abs();
        let speed = match self.run {
            Some(Run { fastest, .. }) => speed.max(fastest),
            None => speed + self.angular * (state.position.value().abs() + self.held),
        };
        self.reached_by(speed.max(f64::MIN_POSITIVE), acceleration.value().abs(), angular)
    }

    /// Amplitudes of a motion of this `speed` (m/s) that an `acceleration` (m/s²) makes faster.
    fn reached_by(&self, speed: f64, acceleration: f64, angular: f64) -> State<f64> {
        if let Some(Run { duration, .. }) = self.run {
            let velocity = speed + acceleration * self.length.min(duration);
            return State { position: velocity * duration, velocity };
        }
        let velocity = speed + acceleration / angular;
        State { position: velocity / angular, velocity }
    }

    /// Amplitudes at the end of `step`.
    fn last_scale(&self, step: &Step<D>) -> State<f64> {
        self.scale(step.end, step.last_acceleration(), self.angular_at(step.end.position))
    }

    /// The value at the end of `step` of `guard`, positive before the event.
    fn guard(&self, phase: &Phase<D>, side: Side, step: &Step<D>, guard: Guard) -> D {
        match guard {
            Guard::Steady => step.last_acceleration() * guard.sign(phase) + self.field.noise(phase, side, step.end),
            Guard::Rest | Guard::Escape => self.field.spare_speed(phase, side, step.end.velocity, guard),
        }
    }

    /// The rate of the guard at the end of a step that begins at `at`, if it is zero there.
    fn rate(&self, phase: &Phase<D>, at: &Progress<D>, step: &Step<D>, guard: Guard) -> f64 {
        let rate = match guard {
            // At constant speed the law does not change, only the loads do.
            Guard::Steady => {
                let load = load(self.field.oscillator, phase.piece, D::from(at.time + step.length), step.end);
                let friction = self.field.friction_slope(phase, at.side, step.end);
                ((load.derivative().at(D::from(0.0)) - friction) * self.field.per_mass).value()
            }
            Guard::Rest | Guard::Escape => step.last_acceleration().value(),
        };
        rate * guard.sign(phase)
    }

    /// True if the guard, positive at both ends of `step`, may be zero in between.
    fn may_dip(&self, phase: &Phase<D>, at: &Progress<D>, step: &Step<D>, guard: Guard) -> bool {
        if guard == Guard::Steady {
            // Nothing that the step knows bounds the change of the acceleration.
            return true;
        }
        let (least, most) = step.range_of_acceleration();
        let falls = if guard.sign(phase) > 0.0 { -least } else { most };
        let [begin, end] =
            [at.state, step.end].map(|state| self.field.spare_speed(phase, at.side, state.velocity, guard).value());
        // Down and up again by half of this at most.
        least < 0.0 && most > 0.0 && begin.min(end) <= step.length * falls
    }

    /// The guard that `step` reaches first, and the part of the step at which it does.
    fn reached(&self, phase: &Phase<D>, at: &Progress<D>, step: &mut Step<D>) -> Option<(Guard, f64)> {
        let mut first: Option<(Guard, f64)> = None;
        for guard in Guard::of(phase, at.side, self.field.capture.is_some()) {
            let crossed = self.guard(phase, at.side, step, guard).value() <= 0.0;
            if !(crossed || self.may_dip(phase, at, step, guard)) {
                continue;
            }
            let sign = guard.sign(phase);
            let velocity = self.within(phase, at, step).velocity().map(|coefficient| coefficient.value() * sign);
            let mut powers = velocity;
            if guard == Guard::Steady {
                powers = [0.0; COEFFICIENTS];
                for power in 1..COEFFICIENTS {
                    powers[power - 1] = velocity[power] * power as f64;
                }
                if !crossed {
                    // A dip within the error of the step is none.
                    powers[0] += DIP * self.tolerance * self.last_scale(step).velocity;
                }
            } else {
                powers[0] = self.field.spare_speed(phase, at.side, at.state.velocity, guard).value();
            }
            if powers[0] <= 0.0 {
                // A stretch that begins on its guard leaves it, against rounding.
                (powers[0], powers[1]) = (0.0, powers[1].max(0.0));
            }
            let theta = first_zero_within(powers).or(crossed.then_some(1.0));
            if let Some(theta) = theta.filter(|theta| first.is_none_or(|(_, other)| *theta < other)) {
                first = Some((guard, theta));
            }
        }
        first
    }

    #[inline]
    pub(super) fn take(&self, phase: &Phase<D>, at: &Progress<D>, length: f64) -> Step<D> {
        Step::take(at.state, at.acceleration, length, |elapsed, state| {
            self.field.acceleration(phase, at.side, at.time + elapsed, state)
        })
    }

    fn within(&self, phase: &Phase<D>, at: &Progress<D>, step: &mut Step<D>) -> Within<D> {
        step.within(|elapsed, state| self.field.acceleration(phase, at.side, at.time + elapsed, state))
    }

    /// Greatest distance of a step's end from an event (s) that a straight line may cover: the curvature adds less than
    /// rounding.
    pub(super) fn close(&self) -> f64 {
        1e-9 / self.angular
    }

    /// The step from `at` that ends near the zero of the guard, about `length` long and shorter than `longest`.
    fn land(&self, phase: &Phase<D>, at: &Progress<D>, guard: Guard, mut length: f64, longest: f64) -> Step<D> {
        let mut step = self.take(phase, at, length);
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..LANDINGS {
            let value = self.guard(phase, at.side, &step, guard).value();
            let mut rate = self.rate(phase, at, &step, guard);
            if let (Guard::Steady, Some((other, at_other))) = (guard, before) {
                // Away from the event the acceleration changes with the law as well.
                rate = (value - at_other) / (length - other);
            }
            before = Some((length, value));
            let correction = value / rate;
            let next = length - correction;
            if !(rate < 0.0 && correction.abs() > self.close() && next > 0.0 && next <= longest) {
                break;
            }
            length = next;
            step = self.take(phase, at, length);
        }
        step
    }

    /// A size of the rate of the guard, as long as it does not turn there.
    fn rate_scale(&self, step: &Step<D>, guard: Guard) -> f64 {
        let acceleration = self.last_scale(step).velocity * self.angular;
        if guard == Guard::Steady { acceleration * self.angular } else { acceleration }
    }

    /// True if the guard is zero at the end of `step` within rounding.
    fn has_landed(&self, phase: &Phase<D>, at: &Progress<D>, step: &Step<D>, guard: Guard) -> bool {
        let value = self.guard(phase, at.side, step, guard).value().abs();
        let rate = self.rate(phase, at, step, guard).abs();
        value <= rate * self.close() || value <= 16.0 * f64::EPSILON * self.rate_scale(step, guard) / self.angular
    }

    /// The event at the end of `step`, which begins at `at`.
    fn ended(&self, phase: &Phase<D>, at: &Progress<D>, step: &Step<D>, guard: Guard) -> Ended<D> {
        let time = D::from(at.time + step.length);
        let value = self.guard(phase, at.side, step, guard);
        let rate = self.rate(phase, at, step, guard);
        // The slope is too flat to locate the zero: rounding moves it by as much as a period.
        let flat = rate.abs() <= 4.0 * f64::EPSILON.sqrt() * self.rate_scale(step, guard);
        let late = if flat { D::from(0.0) } else { -value / rate };
        // A zero within rounding of the step's end is at its end.
        let late = if late.value().abs() <= self.close() { late } else { late - late.value() };
        // Nor is an event before the step that leads to it.
        let early = at.time - (time + late).value();
        let late = if early > 0.0 { late + early } else { late };
        let state = State {
            position: step.end.position + step.end.velocity * late,
            velocity: step.end.velocity + step.last_acceleration() * late,
        };
        let ending = if guard == Guard::Steady { Ending::SteadySpeed } else { Ending::RelativeRest };
        Ended { ending, time: time + late, state, grazing: flat && D::DIRECTIONS > 0 }
    }

    /// Writes the samples before `stop` and the work until `end` of `step`, which begins at `at`; derivatives are those
    /// of `by_speed`, if given.
    fn record(
        &self,
        phase: &Phase<D>,
        at: &Progress<D>,
        step: &mut Step<D>,
        by_speed: Option<&BySpeed<D>>,
        (end, stop): (f64, f64),
        recorder: &mut Recorder<D>,
    ) -> Result<(), SimulationError> {
        let length = step.length;
        if !recorder.sampling.wants_work() && !recorder.has_samples_before(stop) {
            return Ok(());
        }
        let within = self.within(phase, at, step);
        let first = recorder.written;
        if recorder.has_samples_before(stop) {
            let [position, velocity] = [within.position(), within.velocity()];
            let of = |component| if component == 0 { position } else { velocity };
            recorder.polynomials(stop, at.time, length, of)?;
        }
        let state = |time: f64| {
            let state = within.at((time - at.time) / length);
            let derive = |motion: &BySpeed<D>| {
                let acceleration = self.field.acceleration(phase, at.side, time, state).value();
                motion.derive(&self.field, phase, state, acceleration)
            };
            by_speed.map_or(state, derive)
        };
        if by_speed.is_some() {
            recorder.partials(first, state);
        }
        recorder.accelerations(first, |time, state| self.field.acceleration(phase, at.side, time, state))?;
        recorder.work(at.time, end, end - at.time, |time| self.field.power(phase, at.side, time, state(time)))
    }

    /// The motion that follows an event or a jump, carried from the `time` of the event, which has derivatives, to the
    /// value of that time.
    fn depart(&self, phase: &Phase<D>, time: D, state: State<D>, side: Side) -> Progress<D> {
        let late = -time + time.value();
        let time = time.value();
        let acceleration = self.field.acceleration(phase, side, time, state);
        let state =
            State { position: state.position + state.velocity * late, velocity: state.velocity + acceleration * late };
        Progress { time, state, acceleration: self.field.acceleration(phase, side, time, state), side }
    }

    /// Proposes the next step after one of `length` that was good, at most `most` times as long.
    fn adapt(&mut self, length: f64, most: f64, error: f64) {
        let proposed = length * factor(error).min(most);
        self.length = if length < self.length { self.length.max(proposed) } else { proposed };
    }

    /// Proposes `length` for the step from `at`, which has failed with a longer one.
    fn shorten(&mut self, at: &Progress<D>, length: f64) -> Result<(), SimulationError> {
        self.length = length;
        if at.time + length > at.time {
            return Ok(());
        }
        let finite = at.acceleration.value().is_finite() && at.state.position.value().is_finite();
        Err(if finite {
            SimulationError::step_too_small(self.tolerance, at.time)
        } else {
            SimulationError::NotFinite { time: at.time }
        })
    }

    /// The longest step that resolves the machine and every wave (s).
    fn longest(&self, phase: &Phase<D>) -> f64 {
        1.0 / phase.piece.frequencies().fold(self.angular, f64::max)
    }
}

/// Largest growth of a step with this `error`, for which 1 is allowed: the error grows with the eighth power of the
/// length, and a tenth is a margin.
fn factor(error: f64) -> f64 {
    0.9 / error.sqrt().sqrt().sqrt()
}

impl<D: Scalar, L: SlidingLaw<D> + ?Sized> Slide<D> for Integrator<'_, D, L> {
    fn slide(&mut self, phase: &Phase<D>, recorder: &mut Recorder<D>) -> Result<Ended<D>, SimulationError> {
        self.field.spring.begin(phase.state.position, phase.direction);
        let mut at = self.depart(phase, phase.time, phase.state, self.field.first_side(phase));
        let longest = self.longest(phase);
        if let Some(run) = &mut self.run {
            run.fastest = phase.state.velocity.value().abs();
        }
        while at.time < phase.limit {
            let rest = phase.limit - at.time;
            let mut length = self.length.min(longest);
            if length >= rest {
                length = rest;
            } else if 2.0 * length > rest {
                // Two halves instead of a step and a sliver that would cost as much.
                length = 0.5 * rest;
            }
            self.steps += 1;
            recorder.sampling.require_steps(self.steps, STEP_BUDGET)?;
            let corner = self.field.spring.ahead(phase.direction);
            if let Some(corner) = corner.filter(|corner| self.is_there(*corner, at.state)) {
                self.pass(phase, &mut at, corner);
                continue;
            }
            let mut step = self.take(phase, &at, length);
            let mut passed = Self::passed(corner, step.end);
            if let Some(corner) = passed {
                step = self.to_corner(phase, &at, &step, corner);
                length = step.length;
            }
            let angular = self.angular_at(at.state.position).max(self.angular_at(step.end.position));
            let mut scale = self.scale(at.state, at.acceleration, angular);
            if self.field.is_driven {
                // A motion may begin from nothing; then it is as large as the force makes it.
                let force = |time| phase.piece.force(time).value();
                let rise = (force(at.time + length) - force(at.time)).abs() * self.field.per_mass.value();
                scale = self.reached_by(scale.velocity, rise, angular);
            }
            let mut error = step.error(scale) / self.tolerance;
            // In a creeping motion, values stay good beyond the limit of stability for long, but derivatives grow.
            let stable = 0.9 * STABLE / step.stiffness;
            if error <= 1.0 && step.stiffness > STABLE {
                self.shorten(&at, length * stable.max(0.1))?;
                continue;
            }
            let crossed = Guard::of(phase, at.side, self.field.capture.is_some())
                .any(|guard| !(self.guard(phase, at.side, &step, guard).value() > 0.0));
            if (crossed || error <= 1.0)
                && let Some((guard, theta)) = self.reached(phase, &at, &mut step)
            {
                // What lies behind the event does not belong to the stretch; the step that ends there must be good.
                let mut landed = self.land(phase, &at, guard, theta * length, length);
                error = landed.error(scale) / self.tolerance;
                passed = Self::passed(corner, landed.end);
                if let Some(corner) = passed {
                    // Nor is the event that of the spring behind its corner.
                    step = self.to_corner(phase, &at, &landed, corner);
                    (length, error) = (step.length, step.error(scale) / self.tolerance);
                } else if error <= 1.0 && self.has_landed(phase, &at, &landed, guard) {
                    self.adapt(length, 1.0, error);
                    let by_speed = self.refiner.refine(&self.field, phase, &at, &mut landed);
                    let ended = self.ended(phase, &at, &landed, guard);
                    let end = ended.time.value();
                    self.record(phase, &at, &mut landed, by_speed.as_ref(), (end, end), recorder)?;
                    if guard != Guard::Escape {
                        return Ok(ended);
                    }
                    at = self.depart(phase, ended.time, ended.state, Side::Above);
                    continue;
                } else {
                    // A step too long for the machine may see an event that is none.
                    (length, error) = (landed.length, error.max(NOT_LANDED));
                }
            }
            if !(error <= 1.0) {
                self.shorten(&at, length * if error.is_finite() { factor(error).clamp(0.1, 0.9) } else { 0.1 })?;
                continue;
            }
            self.adapt(length, stable.min(5.0), error);
            let (next, whole) = (at.time + length, length == rest);
            let next = if whole { phase.limit } else { next };
            let stop = if whole { phase.samples_end() } else { next };
            let by_speed = self.refiner.refine(&self.field, phase, &at, &mut step);
            self.record(phase, &at, &mut step, by_speed.as_ref(), (next, stop), recorder)?;
            at = Progress { time: next, state: step.end, acceleration: step.last_acceleration(), side: at.side };
            if let Some(run) = &mut self.run {
                run.fastest = run.fastest.max(at.state.velocity.value().abs());
            }
            SimulationError::require_restoring(self.field.oscillator, at.time, at.state.position)?;
            if let Some(corner) = passed {
                self.pass(phase, &mut at, corner);
            }
        }
        let first = recorder.written;
        recorder.samples(phase.samples_end(), |_| at.state)?;
        recorder.accelerations(first, |time, state| self.field.acceleration(phase, at.side, time, state))?;
        Ok(Ended { ending: Ending::Limit, time: D::from(phase.limit), state: at.state, grazing: false })
    }
}
