//! One stretch of sliding under a piecewise linear law, in closed form.

use fmm_friction::Affine;
use fmm_model::{Oscillator, Scalar};

use crate::automaton::{Branch, Ended, Ending, Phase, Slide};
use crate::error::SimulationError;
use crate::exact::closed_form::{Cancellation, respond};
use crate::exact::powers::Powers;
use crate::mechanics::{Branches, Curve, Decay, Forcing, SEARCH_BUDGET, crossing, first_crossing, load, rounding};
use crate::scenario::{Sampling, Scenario, State};
use crate::trajectory::{Power, Recorder};

/// Places within the last phase, in units of its duration, at which the extent of the motion is noted.
const INSIDE: [f64; 3] = [0.23, 0.51, 0.83];

/// Follows phases of sliding for the exact engine.
pub(super) struct Swing<'a, D> {
    oscillator: &'a Oscillator<D>,
    normal_load: D,
    belt: D,
    has_belt: bool,
    flows: &'a Flows<D>,
    /// First zero velocity of the last uninterrupted free decay, and half cycles since. Counting half cycles from there
    /// keeps the rounding of a sum out of later event times.
    rhythm: Option<(D, u32)>,
    budget: usize,
    digits: Cancellation,
    /// True if there is no belt and neither accelerations, work nor lost digits are asked for.
    is_plain: bool,
}

/// The linear machine on each branch of the law.
pub(super) struct Flows<D> {
    gaining: Flow<D>,
    losing: Option<Flow<D>>,
}

impl<D: Scalar> Flows<D> {
    pub(super) fn new<L>(
        scenario: &Scenario<D, L>,
        branches: Branches<D>,
        sampling: &Sampling,
    ) -> Result<Self, SimulationError> {
        let flow = |friction| Flow::new(scenario.oscillator(), scenario.normal_load(), friction, sampling);
        let losing = if branches.differ { Some(flow(branches.losing)?) } else { None };
        Ok(Self { gaining: flow(branches.gaining)?, losing })
    }

    fn on(&self, branch: Branch) -> &Flow<D> {
        match (branch, &self.losing) {
            (Branch::Losing, Some(losing)) => losing,
            _ => &self.gaining,
        }
    }
}

/// The linear machine on one branch of the law.
struct Flow<D> {
    friction: Affine<D>,
    decay: Decay<D>,
    plain: Decay<f64>,
    powers: Option<Powers>,
}

impl<D: Scalar> Flow<D> {
    fn new(
        oscillator: &Oscillator<D>,
        normal_load: D,
        friction: Affine<D>,
        sampling: &Sampling,
    ) -> Result<Self, SimulationError> {
        let damping = oscillator.damping().linear_coefficient() + normal_load * friction.slope;
        let decay = Decay::new(damping / (oscillator.mass() * 2.0), oscillator.stiffness() / oscillator.mass());
        let edge = (normal_load * friction.level / oscillator.stiffness()).value();
        if !(edge.is_finite() && damping.value().is_finite()) {
            return Err(SimulationError::NotFinite { time: 0.0 });
        }
        let powers = Powers::for_swings(&decay, sampling);
        Ok(Self { friction, plain: decay.plain(), decay, powers })
    }
}

impl<'a, D: Scalar> Swing<'a, D> {
    pub(super) fn new<L>(
        scenario: &'a Scenario<D, L>,
        flows: &'a Flows<D>,
        drive: &Forcing<D>,
        sampling: &Sampling,
    ) -> Self {
        let keeps_digits = Cancellation::cannot_matter(scenario.oscillator(), sampling.end());
        let is_plain =
            keeps_digits && !drive.has_belt() && !sampling.channels().acceleration() && !sampling.wants_work();
        Self {
            is_plain,
            oscillator: scenario.oscillator(),
            normal_load: scenario.normal_load(),
            belt: drive.belt(),
            has_belt: drive.has_belt(),
            flows,
            rhythm: None,
            budget: SEARCH_BUDGET,
            digits: Cancellation::default(),
        }
    }

    /// Digits that the motion has lost.
    pub(super) const fn digits(&self) -> &Cancellation {
        &self.digits
    }

    /// The position from the beginning of `phase` on.
    fn position<'f>(&self, flow: &'f Flow<D>, phase: &Phase<D>) -> Result<Curve<'f, D>, SimulationError> {
        let (mass, stiffness) = (self.oscillator.mass(), self.oscillator.stiffness());
        let mut forced = Curve::force(phase.piece, phase.time);
        let sliding = self.normal_load * flow.friction.level;
        forced.constant -= sliding * phase.direction.sign();
        if self.has_belt {
            forced.constant += self.normal_load * flow.friction.slope * self.belt;
        }
        let damping = flow.decay.rate * mass * 2.0;
        respond(forced, mass, damping, stiffness, &flow.decay, phase.state)
    }

    /// The time of the next zero velocity of a free decay about `centre`, and the position there.
    fn next_rest(&mut self, phase: &Phase<D>, centre: D, decay: &Decay<D>, free: State<D>) -> Option<(D, D)> {
        let duration = decay.time_to_zero_velocity(free)?;
        let rest = |(zero, swings): (D, u32)| if swings == 0 { zero } else { zero + duration * f64::from(swings) };
        let rhythm = match self.rhythm {
            Some((zero, swings)) if rest((zero, swings)).value() == phase.time.value() => (zero, swings + 1),
            // A motion that was stopped, pushed or cut short since then begins anew.
            _ => (phase.time + duration, 0),
        };
        self.rhythm = Some(rhythm);
        let time = rest(rhythm);
        Some((time, centre + decay.position_at_zero_velocity(free, duration)))
    }

    /// End of a free phase at `rest`, a time and a position whose derivatives do not include forces that exist in
    /// derivatives only.
    fn rest_under_derivatives(
        &self,
        phase: &Phase<D>,
        path: &Curve<D>,
        (time, position): (D, D),
    ) -> (Ending, D, State<D>, bool) {
        if path.is_free() {
            return (Ending::RelativeRest, time, State { position, velocity: self.belt }, false);
        }
        let guard = path.derivative().scaled(D::from(phase.direction.sign()), D::from(0.0));
        let (time, grazing) = crossing(&guard, phase.time, time.value());
        let there = path.state(time - phase.time).position;
        let state = State { position: there - there.value() + position.value(), velocity: self.belt };
        (Ending::RelativeRest, time, state, grazing)
    }

    /// A phase under a constant force that ends at rest, the only kind of phase in a ring-down: equal to the general
    /// way to the last bit, at a third of its cost. `None` if another quantity is asked for, or another end comes
    /// first.
    #[inline]
    fn swing_freely(
        &mut self,
        flow: &Flow<D>,
        phase: &Phase<D>,
        recorder: &mut Recorder<D>,
    ) -> Result<Option<Ended<D>>, SimulationError> {
        let Some(powers) = flow.powers.as_ref().filter(|_| self.is_plain && phase.branch == Branch::Only) else {
            return Ok(None);
        };
        let Some(force) = phase.piece.constant_force(phase.time) else { return Ok(None) };
        let sliding = self.normal_load * flow.friction.level;
        let centre = (force - sliding * phase.direction.sign()) / self.oscillator.stiffness();
        let free = State { position: phase.state.position - centre, velocity: phase.state.velocity };
        let rhythm = self.rhythm;
        let Some((time, position)) = self.next_rest(phase, centre, &flow.decay, free) else { return Ok(None) };
        if !(time.value() <= phase.limit) {
            self.rhythm = rhythm;
            return Ok(None);
        }
        powers.write(recorder, time.value(), &flow.decay, (centre, free), phase.time)?;
        Ok(Some(Ended {
            ending: Ending::RelativeRest,
            time,
            state: State { position, velocity: self.belt },
            grazing: false,
        }))
    }

    /// The first guard that the motion along `position` reaches before the limit of `phase`, with its time.
    fn first_guard(
        &mut self,
        phase: &Phase<D>,
        position: &Curve<D>,
        plain: &Decay<f64>,
    ) -> Result<Option<(Ending, D, bool)>, SimulationError> {
        let sign = phase.direction.sign();
        let velocity = position.derivative();
        // A motion from rest relative to the counterface, or on a branch that begins at the end of another, starts from
        // zero exactly; the automaton has decided its direction.
        let from_rest = phase.state.velocity.value() == self.belt.value();
        let load = load(self.oscillator, phase.piece, phase.time, phase.state);
        let noise = rounding(self.oscillator, &load, phase.time, phase.state) / self.oscillator.mass().value();
        let speed = || (Ending::RelativeRest, velocity.clone().scaled(D::from(sign), self.belt * -sign));
        let gain = |sign: f64| (Ending::SteadySpeed, velocity.derivative().scaled(D::from(sign), D::from(0.0)));
        let guards = match phase.branch {
            Branch::Only => vec![speed()],
            Branch::Gaining => vec![gain(sign)],
            Branch::Losing => vec![gain(-sign), speed()],
        };
        let guards = guards.into_iter().map(|(ending, guard)| {
            let mut plain_guard = guard.plain(plain);
            if ending == Ending::RelativeRest && from_rest {
                plain_guard = plain_guard.risen_from_zero(noise);
            } else if ending == Ending::SteadySpeed && plain_guard.now().abs() <= noise {
                plain_guard = plain_guard.risen_from_zero(noise * plain.fastest());
            }
            (ending, guard, plain_guard)
        });
        first_crossing(guards, phase.time, phase.limit, &mut self.budget)
    }
}

impl<D: Scalar> Slide<D> for Swing<'_, D> {
    #[inline]
    fn slide(&mut self, phase: &Phase<D>, recorder: &mut Recorder<D>) -> Result<Ended<D>, SimulationError> {
        let flow = self.flows.on(phase.branch);
        match self.swing_freely(flow, phase, recorder)? {
            Some(ended) => Ok(ended),
            None => self.swing(flow, phase, recorder),
        }
    }
}

impl<D: Scalar> Swing<'_, D> {
    /// A phase in the general way.
    fn swing(
        &mut self,
        flow: &Flow<D>,
        phase: &Phase<D>,
        recorder: &mut Recorder<D>,
    ) -> Result<Ended<D>, SimulationError> {
        let path = self.position(flow, phase)?;
        let undisturbed = path.is_plainly_free() && !self.has_belt && phase.branch == Branch::Only;
        let found = match path.decay {
            Some((decay, free)) if undisturbed => self
                .next_rest(phase, path.constant, decay, free)
                .filter(|(time, _)| time.value() <= phase.limit)
                .map(|rest| self.rest_under_derivatives(phase, &path, rest)),
            _ => self
                .first_guard(phase, &path, &flow.plain)?
                .map(|(ending, time, grazing)| (ending, time, path.state(time - phase.time), grazing)),
        };
        let end = found.as_ref().map_or(phase.samples_end(), |(_, time, _, _)| time.value());
        let first = recorder.written;
        write(&path, flow.powers.as_ref(), phase.time, end, recorder)?;
        self.write_accelerations(first, &path, flow, phase, recorder)?;
        self.write_work(&path, flow, phase, end.min(phase.limit), recorder)?;
        if let Some((ending, time, state, grazing)) = found {
            self.digits.note(&path, time.value() - phase.time.value(), phase.state, state);
            return Ok(Ended { ending, time, state, grazing });
        }
        let time = D::from(phase.limit);
        let state = path.state(time - phase.time);
        let elapsed = phase.limit - phase.time.value();
        self.digits.note(&path, elapsed, phase.state, state);
        if phase.last {
            // A motion without an event may be far away in between.
            for part in INSIDE {
                self.digits.reaches(path.state(D::from(part * elapsed)));
            }
        }
        Ok(Ended { ending: Ending::Limit, time, state, grazing: false })
    }
}

impl<D: Scalar> Swing<'_, D> {
    /// Writes the accelerations of the samples from `first` on, which lie on `path`: they are linear in position and
    /// velocity.
    fn write_accelerations(
        &self,
        first: usize,
        path: &Curve<D>,
        flow: &Flow<D>,
        phase: &Phase<D>,
        recorder: &mut Recorder<D>,
    ) -> Result<(), SimulationError> {
        if !recorder.sampling.channels().acceleration() || first == recorder.written {
            return Ok(());
        }
        let (load, Affine { level, slope, .. }) = (self.normal_load, flow.friction);
        let mass = self.oscillator.mass();
        let friction = load * (level * phase.direction.sign() - slope * self.belt);
        let damping = self.oscillator.damping().linear_coefficient() + load * slope;
        let steady = if path.is_free() { phase.piece.force(phase.piece.start) } else { D::from(0.0) };
        let [constant, per_position, per_velocity] =
            [steady - friction, -self.oscillator.stiffness(), -damping].map(|factor| factor / mass);
        let range = first..recorder.written;
        recorder.trajectory.accelerate(range.clone(), constant, per_position, per_velocity);
        if !path.is_free() {
            for index in range.clone() {
                let force = phase.piece.force(recorder.sampling.time(index));
                recorder.trajectory.acceleration.add(index, force / mass);
            }
        }
        let written = &recorder.trajectory.acceleration().values()[range];
        if let Some(index) = written.iter().position(|acceleration| !acceleration.is_finite()) {
            return Err(SimulationError::NotFinite { time: recorder.sampling.time(first + index) });
        }
        Ok(())
    }

    fn write_work(
        &self,
        path: &Curve<D>,
        flow: &Flow<D>,
        phase: &Phase<D>,
        end: f64,
        recorder: &mut Recorder<D>,
    ) -> Result<(), SimulationError> {
        if !recorder.sampling.wants_work() {
            return Ok(());
        }
        let frequency = path.frequencies().fold(flow.plain.natural() + 2.0 * flow.plain.rate, f64::max);
        recorder.work(phase.time.value(), end, 1.0 / frequency, |time| {
            let velocity = path.state(-phase.time + time).velocity;
            let relative = velocity - self.belt;
            let friction =
                self.normal_load * (flow.friction.level * phase.direction.sign() + flow.friction.slope * relative);
            let damping = self.oscillator.damping_force(velocity);
            Power::of(friction, damping, phase.piece.force(time), velocity, self.belt)
        })
    }
}

/// Writes the samples of the motion along `path`, counted from `start`, that come before `end`.
fn write<D: Scalar>(
    path: &Curve<D>,
    powers: Option<&Powers>,
    start: D,
    end: f64,
    recorder: &mut Recorder<D>,
) -> Result<(), SimulationError> {
    let (Some(powers), Some((decay, free))) = (powers, path.decay) else {
        return recorder.samples(end, |time| path.state(-start + time));
    };
    let first = recorder.written;
    powers.write(recorder, end, decay, (path.constant, free), start)?;
    if !path.is_free() {
        add_forced(path, start, first, recorder)?;
    }
    Ok(())
}

/// Adds the contribution of a force beyond a constant to the samples from `first` on.
fn add_forced<D: Scalar>(
    path: &Curve<D>,
    start: D,
    first: usize,
    recorder: &mut Recorder<D>,
) -> Result<(), SimulationError> {
    let channels = recorder.sampling.channels();
    for index in first..recorder.written {
        let time = recorder.sampling.time(index);
        let forced = path.forced_state(-start + time);
        if !(forced.position.value().abs() + forced.velocity.value().abs()).is_finite() {
            return Err(SimulationError::NotFinite { time });
        }
        if channels.position() {
            recorder.trajectory.position.add(index, forced.position - path.constant);
        }
        if channels.velocity() {
            recorder.trajectory.velocity.add(index, forced.velocity);
        }
    }
    Ok(())
}
