//! One stretch of sliding, step by step.

use fmm_friction::SlidingLaw;
use fmm_model::{Oscillator, Scalar};

use super::step::{Step, first_zero_within};
use crate::automaton::{Branch, Ended, Ending, Phase, Slide, load, rounding};
use crate::drive::Drive;
use crate::first_zero::ROUNDING;
use crate::recorder::Recorder;
use crate::within::{COEFFICIENTS, Within};
use crate::work::Power;
use crate::{Scenario, SimulationError, State};

/// Steps of one run; they last for some 15 000 periods at the default tolerance, and take about a second.
const STEP_BUDGET: usize = 1_000_000;

/// ω₀ t over the sampled time t below which the spring does not shape the motion.
const WEAK: f64 = 1e-2;

/// Attempts at landing on an event; Newton's method needs two or three.
const LANDINGS: usize = 12;

/// How far below zero the acceleration of a step must dip, in units of its error in the velocity over its length.
const DIP: f64 = 10.0;

/// What counts as the error of a step that has found an event and not landed on it: the next will be half as long.
const NOT_LANDED: f64 = 256.0;

/// Follows stretches of sliding for the Runge-Kutta engine.
pub(super) struct Integrator<'a, D, L> {
    oscillator: &'a Oscillator<D>,
    law: &'a L,
    normal_load: D,
    belt: D,
    /// 1/m.
    per_mass: D,
    /// The damping coefficient, if damping is linear.
    linear_damping: Option<D>,
    /// Whether any force acts from outside.
    is_driven: bool,
    tolerance: f64,
    /// ω₀ of small vibrations, or what turns little within the sampled time if that is faster (rad/s).
    angular: f64,
    /// Displacement that the static level holds on the spring (m), below which no motion matters.
    held: f64,
    /// Length of the step to try next (s).
    length: f64,
    budget: usize,
}

/// A stretch in progress: the state at a time that is a plain number.
struct Progress<D> {
    time: f64,
    state: State<D>,
    acceleration: D,
    /// Whether the speed has exceeded the capture speed of the law, at which it is then caught.
    armed: bool,
}

impl<'a, D: Scalar, L: SlidingLaw<D>> Integrator<'a, D, L> {
    pub(super) fn new(scenario: &'a Scenario<D, L>, drive: &Drive<D>, tolerance: f64, end: f64) -> Self {
        let oscillator = scenario.oscillator();
        // A spring too weak to matter within the sampled time gives no scale.
        let natural = oscillator.natural_angular_frequency().value();
        let angular = if end > 0.0 { natural.max(WEAK / end) } else { natural };
        let law = scenario.law();
        let static_force = (law.breakaway() * scenario.normal_load()).value();
        let held = static_force / (oscillator.mass().value() * angular * angular);
        Self {
            oscillator,
            law,
            normal_load: scenario.normal_load(),
            belt: drive.belt(),
            per_mass: D::from(1.0) / oscillator.mass(),
            linear_damping: oscillator.damping().is_linear().then(|| oscillator.damping().linear_coefficient()),
            is_driven: !scenario.excitations().is_empty(),
            tolerance,
            angular,
            held,
            length: 0.1 / angular,
            budget: STEP_BUDGET,
        }
    }

    /// Friction force while sliding with `velocity` in the direction of `phase`.
    #[inline]
    fn friction(&self, phase: &Phase<D>, velocity: D) -> D {
        let sign = phase.direction.sign();
        let speed = (velocity - self.belt) * sign;
        let at = |speed| match phase.branch {
            Branch::Losing => self.law.coefficient_losing_speed(speed),
            Branch::Only | Branch::Gaining => self.law.coefficient(speed),
        };
        // Stages may look past the stop, and a law knows no negative speed: its curve is turned about its end, which keeps
        // the slope.
        let coefficient = if speed.value() >= 0.0 { at(speed) } else { at(D::from(0.0)) * 2.0 - at(-speed) };
        self.normal_load * coefficient * sign
    }

    #[inline]
    fn acceleration(&self, phase: &Phase<D>, time: f64, state: State<D>) -> D {
        // The other forms cost as much as everything else here together.
        let damping = match self.linear_damping {
            Some(coefficient) => state.velocity * coefficient,
            None => self.oscillator.damping().force(state.velocity),
        };
        let mut force =
            -self.friction(phase, state.velocity) - damping - self.oscillator.restoring_force(state.position);
        if self.is_driven {
            force = force + phase.piece.force(time);
        }
        force * self.per_mass
    }

    /// Amplitudes (m, m/s) that errors are relative to.
    fn scale(&self, state: State<D>, acceleration: D) -> State<f64> {
        let velocity = state.velocity.value().abs()
            + self.angular * (state.position.value().abs() + self.held)
            + acceleration.value().abs() / self.angular;
        let velocity = velocity.max(f64::MIN_POSITIVE);
        State { position: velocity / self.angular, velocity }
    }

    /// The speed less that at which the contact is caught.
    fn spare_speed(&self, phase: &Phase<D>, velocity: D, armed: bool) -> D {
        let speed = (velocity - self.belt) * phase.direction.sign();
        if armed { speed - self.law.capture_speed() } else { speed }
    }

    fn exceeds_capture(&self, phase: &Phase<D>, state: State<D>) -> bool {
        let capture = self.law.capture_speed().value();
        capture > 0.0 && self.spare_speed(phase, state.velocity, false).value() > capture
    }

    /// The value at the end of `step` of the guard that `ending` stands for, positive before the event.
    fn guard(&self, phase: &Phase<D>, step: &Step<D>, ending: Ending, armed: bool) -> D {
        match ending {
            Ending::SteadySpeed => {
                let time = phase.time.value().max(phase.piece.start);
                step.last_acceleration() * Self::gain(phase) + self.noise(phase, time, step.end)
            }
            _ => self.spare_speed(phase, step.end.velocity, armed),
        }
    }

    /// Rounding of an acceleration (m/s²): what is less is zero, or a motion that tends to a constant speed would go from
    /// branch to branch for ever.
    fn noise(&self, phase: &Phase<D>, time: f64, state: State<D>) -> f64 {
        let load = load(self.oscillator, phase.piece, D::from(time), state);
        let friction = self.friction(phase, state.velocity).value().abs();
        (rounding(self.oscillator, &load, D::from(time), state) + ROUNDING * friction) * self.per_mass.value()
    }

    /// The rate of the guard at the end of a step that begins at `time`, if it is zero there.
    fn rate(&self, phase: &Phase<D>, time: f64, step: &Step<D>, ending: Ending) -> f64 {
        match ending {
            // At constant speed the law does not change, only the load does.
            Ending::SteadySpeed => {
                let load = load(self.oscillator, phase.piece, D::from(time + step.length), step.end);
                (load.derivative().at(D::from(0.0)) * self.per_mass).value() * Self::gain(phase)
            }
            _ => step.last_acceleration().value() * phase.direction.sign(),
        }
    }

    /// The sign of the acceleration on the branch of `phase`.
    fn gain(phase: &Phase<D>) -> f64 {
        if phase.branch == Branch::Losing { -phase.direction.sign() } else { phase.direction.sign() }
    }

    /// The guards of a phase.
    fn endings(phase: &Phase<D>) -> &'static [Ending] {
        match phase.branch {
            Branch::Only => &[Ending::RelativeRest],
            Branch::Gaining => &[Ending::SteadySpeed],
            Branch::Losing => &[Ending::RelativeRest, Ending::SteadySpeed],
        }
    }

    /// Whether the guard of `ending`, positive at both ends of `step`, may be zero in between.
    fn may_dip(&self, phase: &Phase<D>, at: &Progress<D>, step: &Step<D>, ending: Ending) -> bool {
        if ending == Ending::SteadySpeed {
            // Nothing that the step knows bounds the change of the acceleration.
            return true;
        }
        let sign = phase.direction.sign();
        let (least, most) = step.range_of_acceleration();
        let [begin, end] = [at.state.velocity, step.end.velocity].map(|v| self.spare_speed(phase, v, at.armed).value());
        // Down and up again by half of this at most.
        least < 0.0 && most > 0.0 && begin.min(end) <= step.length * (if sign > 0.0 { -least } else { most })
    }

    /// The guard that `step` reaches first, and the part of the step at which it does.
    fn reached(&self, phase: &Phase<D>, at: &Progress<D>, step: &mut Step<D>) -> Option<(Ending, f64)> {
        let sign = phase.direction.sign();
        let mut first: Option<(Ending, f64)> = None;
        for &ending in Self::endings(phase) {
            let crossed = self.guard(phase, step, ending, at.armed).value() <= 0.0;
            if !(crossed || self.may_dip(phase, at, step, ending)) {
                continue;
            }
            let velocity = self.within(phase, at.time, step).velocity().map(|coefficient| coefficient.value() * sign);
            let mut guard = velocity;
            if ending == Ending::SteadySpeed {
                let sign = Self::gain(phase) * sign;
                guard = [0.0; COEFFICIENTS];
                for power in 1..COEFFICIENTS {
                    guard[power - 1] = velocity[power] * power as f64 * sign;
                }
                if !crossed {
                    // A dip within the error of the step is none.
                    guard[0] += DIP * self.tolerance * self.scale(step.end, step.last_acceleration()).velocity;
                }
            } else {
                guard[0] = self.spare_speed(phase, at.state.velocity, at.armed).value();
            }
            if guard[0] <= 0.0 {
                // A stretch that begins on its guard leaves it; rounding may say otherwise.
                (guard[0], guard[1]) = (0.0, guard[1].max(0.0));
            }
            let theta = first_zero_within(guard).or(crossed.then_some(1.0));
            if let Some(theta) = theta.filter(|theta| first.is_none_or(|(_, other)| *theta < other)) {
                first = Some((ending, theta));
            }
        }
        first
    }

    #[inline]
    fn take(&self, phase: &Phase<D>, at: &Progress<D>, length: f64) -> Step<D> {
        Step::take(at.state, at.acceleration, length, |elapsed, state| {
            self.acceleration(phase, at.time + elapsed, state)
        })
    }

    fn within(&self, phase: &Phase<D>, time: f64, step: &mut Step<D>) -> Within<D> {
        step.within(|elapsed, state| self.acceleration(phase, time + elapsed, state))
    }

    /// How near to an event a step must end (s) for a straight line to reach it: what a parabola would add is below rounding.
    fn close(&self) -> f64 {
        1e-9 / self.angular
    }

    /// The step from `at` that ends near where the guard of `ending` is zero, about `length` long and shorter than `longest`.
    fn land(&self, phase: &Phase<D>, at: &Progress<D>, ending: Ending, mut length: f64, longest: f64) -> Step<D> {
        let mut step = self.take(phase, at, length);
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..LANDINGS {
            let value = self.guard(phase, &step, ending, at.armed).value();
            let mut rate = self.rate(phase, at.time, &step, ending);
            if let (Ending::SteadySpeed, Some((other, at_other))) = (ending, before) {
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

    /// A size of the rate of the guard of `ending`, as long as it does not turn there.
    fn rate_scale(&self, step: &Step<D>, ending: Ending) -> f64 {
        let acceleration = self.scale(step.end, step.last_acceleration()).velocity * self.angular;
        if ending == Ending::SteadySpeed { acceleration * self.angular } else { acceleration }
    }

    /// Whether the guard of `ending` is zero at the end of `step`, or so near that it is by rounding.
    fn has_landed(&self, phase: &Phase<D>, at: &Progress<D>, step: &Step<D>, ending: Ending) -> bool {
        let value = self.guard(phase, step, ending, at.armed).value().abs();
        let rate = self.rate(phase, at.time, step, ending).abs();
        value <= rate * self.close() || value <= 16.0 * f64::EPSILON * self.rate_scale(step, ending) / self.angular
    }

    /// The event at the end of `step`, which begins at `at`.
    fn ended(&self, phase: &Phase<D>, at: &Progress<D>, step: &Step<D>, ending: Ending) -> Ended<D> {
        let time = D::from(at.time + step.length);
        let value = self.guard(phase, step, ending, at.armed);
        let rate = self.rate(phase, at.time, step, ending);
        // What is rounding at a slope like this may as well be zero a period away.
        let flat = rate.abs() <= 4.0 * f64::EPSILON.sqrt() * self.rate_scale(step, ending);
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
        Ended { ending, time: time + late, state, grazing: flat && D::DIRECTIONS > 0 }
    }

    /// Writes the samples before `stop` and the work until `end` of `step`, which begins at `time`.
    fn record(
        &self,
        phase: &Phase<D>,
        time: f64,
        step: &mut Step<D>,
        (end, stop): (f64, f64),
        recorder: &mut Recorder<D>,
    ) -> Result<(), SimulationError> {
        let length = step.length;
        if !recorder.sampling.wants_work() && !recorder.has_samples_before(stop) {
            return Ok(());
        }
        let within = self.within(phase, time, step);
        recorder.polynomial(stop, time, length, &within)?;
        recorder.work(time, end, end - time, |time_within| {
            let state = within.at((time_within - time) / length);
            let friction = self.friction(phase, state.velocity);
            Power {
                friction: friction * (state.velocity - self.belt),
                viscous: self.oscillator.damping().force(state.velocity) * state.velocity,
                external: phase.piece.force(time_within) * state.velocity - friction * self.belt,
            }
        })
    }

    /// Proposes the next step after one of `length` that was good, at most `most` times as long.
    fn adapt(&mut self, length: f64, most: f64, error: f64) {
        let proposed = length * factor(error).min(most);
        self.length = if length < self.length { self.length.max(proposed) } else { proposed };
    }

    /// The longest step that resolves the machine and every wave (s).
    fn longest(&self, phase: &Phase<D>) -> f64 {
        1.0 / phase.piece.waves().iter().map(|wave| wave.angular.value()).fold(self.angular, f64::max)
    }
}

/// How much longer a step may be than one of this `error`, for which 1 is allowed: with the eighth power of the length the
/// error grows, and a tenth is left to chance.
fn factor(error: f64) -> f64 {
    0.9 / error.sqrt().sqrt().sqrt()
}

impl<D: Scalar, L: SlidingLaw<D>> Slide<D> for Integrator<'_, D, L> {
    fn slide(&mut self, phase: &Phase<D>, recorder: &mut Recorder<D>) -> Result<Ended<D>, SimulationError> {
        let time = phase.time.value();
        // From the time of the event, which has derivatives, to the number that is its value.
        let late = -phase.time + time;
        let acceleration = self.acceleration(phase, time, phase.state);
        let state = State {
            position: phase.state.position + phase.state.velocity * late,
            velocity: phase.state.velocity + acceleration * late,
        };
        let acceleration = self.acceleration(phase, time, state);
        let armed = self.exceeds_capture(phase, state);
        let mut at = Progress { time, state, acceleration, armed };
        let longest = self.longest(phase);
        while at.time < phase.limit {
            let rest = phase.limit - at.time;
            let mut length = self.length.min(longest);
            if length >= rest {
                length = rest;
            } else if 2.0 * length > rest {
                // Two halves instead of a step and a sliver that would cost as much.
                length = 0.5 * rest;
            }
            self.budget = self
                .budget
                .checked_sub(1)
                .ok_or(SimulationError::StepBudget { budget: STEP_BUDGET, end: recorder.sampling.end() })?;
            let mut step = self.take(phase, &at, length);
            let mut scale = self.scale(at.state, at.acceleration);
            if self.is_driven {
                // A motion may begin from nothing; then it is as large as the force makes it.
                let force = |time| phase.piece.force(time).value();
                let rise = (force(at.time + length) - force(at.time)).abs() * self.per_mass.value() / self.angular;
                scale.velocity += rise;
                scale.position += rise / self.angular;
            }
            let mut error = step.error(scale) / self.tolerance;
            let crossed =
                Self::endings(phase).iter().any(|&ending| !(self.guard(phase, &step, ending, at.armed).value() > 0.0));
            if (crossed || error <= 1.0)
                && let Some((ending, theta)) = self.reached(phase, &at, &mut step)
            {
                // What lies behind the event does not belong to the stretch; the step that ends there must be good.
                let mut step = self.land(phase, &at, ending, theta * length, length);
                error = step.error(scale) / self.tolerance;
                if error <= 1.0 && self.has_landed(phase, &at, &step, ending) {
                    self.adapt(length, 1.0, error);
                    let ended = self.ended(phase, &at, &step, ending);
                    let end = ended.time.value();
                    self.record(phase, at.time, &mut step, (end, end), recorder)?;
                    return Ok(ended);
                }
                // A step too long for the machine may see an event that is none.
                (length, error) = (step.length, error.max(NOT_LANDED));
            }
            if !(error <= 1.0) {
                self.length = length * if error.is_finite() { factor(error).clamp(0.1, 0.9) } else { 0.1 };
                if at.time + self.length <= at.time {
                    let finite = at.acceleration.value().is_finite() && at.state.position.value().is_finite();
                    return Err(if finite {
                        SimulationError::StepTooSmall { tolerance: self.tolerance, time: at.time }
                    } else {
                        SimulationError::NotFinite { time: at.time }
                    });
                }
                continue;
            }
            self.adapt(length, 5.0, error);
            let (next, whole) = (at.time + length, length == rest);
            let next = if whole { phase.limit } else { next };
            let stop = if whole { phase.samples_end() } else { next };
            self.record(phase, at.time, &mut step, (next, stop), recorder)?;
            at = Progress {
                time: next,
                state: step.end,
                acceleration: step.last_acceleration(),
                armed: at.armed || self.exceeds_capture(phase, step.end),
            };
        }
        recorder.samples(phase.samples_end(), |_| at.state)?;
        Ok(Ended { ending: Ending::Limit, time: D::from(phase.limit), state: at.state, grazing: false })
    }
}
