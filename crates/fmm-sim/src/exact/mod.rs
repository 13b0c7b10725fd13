//! The exact engine: closed form between events, events in closed form, derivatives through both.

mod decay;
mod powers;

use fmm_friction::{Affine, AffineLaw};
use fmm_model::Scalar;

use crate::{Direction, Engine, Event, EventKind, Mode, Sampling, Scenario, SimulationError, State, Trajectory};
use decay::Decay;
use powers::Powers;

/// Simulates laws that are a level plus a slope without any integration error.
///
/// While the contact slips in one direction, friction only shifts the centre of a damped harmonic motion:
///
/// ```text
/// m x″ + (c₁ + N β) x′ + k (x − p) = 0,   p = −s N μ/k,   s = sgn(x′)
/// ```
///
/// so that position, velocity and the time of the next zero velocity have closed forms, and every further half
/// swing lasts π/ω_d. At zero velocity the contact sticks if |k x| ≤ N μ_s, the comparison being made on the
/// numbers as they are; otherwise it slips towards the centre. The direction comes from the load, never from a
/// velocity that has just vanished. Under-, over- and critically damped machines are all covered; without
/// oscillation the motion creeps towards the edge of the stick zone and has no stop.
///
/// Guaranteed: no event is missed, events are in order, and their number is at most one million (a typed error
/// otherwise). Samples within a swing come from a table of powers of exp((−a + iω_d)Δt), anew from the closed
/// form every 256 samples, so that rounding does not grow along the record.
///
/// At dual numbers the derivatives are exact, including those of the event times; a derivative does not see
/// that the *number* of half swings may change, which [`Event::margin`] tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Exact;

/// No record resolves more half swings than this.
const EVENT_BUDGET: usize = 1_000_000;

impl<D: Scalar, L: AffineLaw<D>> Engine<D, L> for Exact {
    fn run_into(
        &self,
        scenario: &Scenario<D, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError> {
        let contact = Contact::of(scenario)?;
        let mut writer = Writer::new(&contact.decay, sampling, trajectory);
        let start = scenario.initial();
        let mut event = contact.event(D::from(0.0), start.position, start.velocity, EventKind::Start);
        writer.push(event)?;
        let mut first_zero = None;
        while let Mode::Slip(direction) = event.next {
            let centre = contact.centre(direction);
            let phase = State { position: event.position - centre, velocity: event.velocity };
            let Some(duration) = contact.decay.time_to_zero_velocity(phase) else {
                return writer.slip(&event, centre, phase, f64::INFINITY);
            };
            // Counting half periods from the first zero keeps the rounding of the sum out of later event times.
            let (zero, swings) = match first_zero {
                None => (event.time + duration, 0),
                Some((zero, swings)) => (zero, swings + 1),
            };
            first_zero = Some((zero, swings));
            let time = if swings == 0 { zero } else { zero + duration * f64::from(swings) };
            writer.slip(&event, centre, phase, time.value())?;
            if time.value() > sampling.end() {
                return Ok(());
            }
            let position = centre + contact.decay.position_at_zero_velocity(phase, duration);
            event = contact.event(time, position, D::from(0.0), EventKind::Reversal);
            writer.push(event)?;
        }
        writer.stick(&event);
        Ok(())
    }
}

/// Machine and contact, reduced to the numbers that the automaton needs.
struct Contact<D> {
    decay: Decay<D>,
    stiffness: D,
    sliding_force: D,
    static_force: f64,
}

impl<D: Scalar> Contact<D> {
    fn of<L: AffineLaw<D>>(scenario: &Scenario<D, L>) -> Result<Self, SimulationError> {
        let (oscillator, load) = (scenario.oscillator(), scenario.normal_load());
        let quadratic = oscillator.damping().quadratic_coefficient().value();
        if quadratic != 0.0 {
            return Err(SimulationError::QuadraticDamping { quadratic });
        }
        let Affine { level, slope, breakaway } = scenario.law().affine();
        let (mass, stiffness) = (oscillator.mass(), oscillator.stiffness());
        let damping = oscillator.damping().linear_coefficient() + load * slope;
        let contact = Self {
            decay: Decay::new(damping / (mass * 2.0), stiffness / mass),
            stiffness,
            sliding_force: load * level,
            static_force: (load * breakaway).value(),
        };
        let edge = contact.centre(Direction::Positive).value();
        if edge.is_finite() && contact.static_force.is_finite() {
            Ok(contact)
        } else {
            Err(SimulationError::NotFinite { time: 0.0 })
        }
    }

    /// Where the spring balances friction while the contact slips in `direction`.
    fn centre(&self, direction: Direction) -> D {
        self.sliding_force / self.stiffness * -direction.sign()
    }

    /// The event at which the state is (`position`, `velocity`): the automaton's only decision.
    fn event(&self, time: D, position: D, velocity: D, kind: EventKind) -> Event<D> {
        let load = -(self.stiffness * position).value();
        let next = if velocity.value() == 0.0 {
            let direction = Direction::of(load);
            // Beyond the static level the centre lies ahead, as the sliding level is not higher; where rounding says
            // otherwise, nothing moves.
            let ahead = (self.centre(direction) - position).value() * direction.sign() > 0.0;
            if load.abs() > self.static_force && ahead { Mode::Slip(direction) } else { Mode::Stick }
        } else {
            Mode::Slip(Direction::of(velocity.value()))
        };
        let kind = if kind == EventKind::Reversal && next == Mode::Stick { EventKind::Stop } else { kind };
        Event { kind, time, position, velocity, next, load: load.abs(), static_level: self.static_force }
    }
}

/// Fills a trajectory swing by swing.
struct Writer<'a, D> {
    decay: &'a Decay<D>,
    sampling: &'a Sampling,
    trajectory: &'a mut Trajectory<D>,
    powers: Option<Powers>,
    written: usize,
}

impl<'a, D: Scalar> Writer<'a, D> {
    fn new(decay: &'a Decay<D>, sampling: &'a Sampling, trajectory: &'a mut Trajectory<D>) -> Self {
        trajectory.reset(sampling);
        let powers = decay.half_swing().map(|half_swing| {
            let longest = (half_swing.duration.value() / sampling.interval()).min(sampling.count() as f64) as usize + 1;
            Powers::new(decay.rate().value(), half_swing.angular.value(), sampling.interval(), longest)
        });
        Self { decay, sampling, trajectory, powers, written: 0 }
    }

    fn push(&mut self, event: Event<D>) -> Result<(), SimulationError> {
        let finite = event.time.value().is_finite() && event.position.value().is_finite() && event.load.is_finite();
        if !finite {
            return Err(SimulationError::NotFinite { time: event.time.value() });
        }
        if self.trajectory.events().len() >= EVENT_BUDGET {
            return Err(SimulationError::EventBudget { budget: EVENT_BUDGET, end: self.sampling.end() });
        }
        self.trajectory.push(event);
        Ok(())
    }

    /// Writes the samples from `event` to before `end`, while the motion about `centre` starts from `phase`.
    fn slip(&mut self, event: &Event<D>, centre: D, phase: State<D>, end: f64) -> Result<(), SimulationError> {
        let stop = self.sampling.index_at_or_after(end);
        while self.written < stop {
            let anchor = self.sampling.time(self.written);
            let at_anchor = self.decay.advance(phase, -event.time + anchor);
            if !(centre.value().abs() + self.decay.reach(at_anchor)).is_finite() {
                return Err(SimulationError::NotFinite { time: anchor });
            }
            self.written += if let Some(powers) = &self.powers {
                let count = powers.len().min(stop - self.written);
                powers.write(self.trajectory, self.sampling, self.written, count, self.decay, centre, at_anchor);
                count
            } else {
                let position = centre + at_anchor.position;
                self.trajectory.set(self.written, self.sampling.channels(), position, at_anchor.velocity);
                1
            };
        }
        Ok(())
    }

    /// Writes the remaining samples: the contact holds for good.
    fn stick(&mut self, event: &Event<D>) {
        let range = self.written..self.sampling.count();
        if self.sampling.channels().position() {
            self.trajectory.position_mut().fill(range.clone(), event.position);
        }
        if self.sampling.channels().velocity() {
            self.trajectory.velocity_mut().fill(range, D::from(0.0));
        }
    }
}

#[cfg(test)]
mod tests;
