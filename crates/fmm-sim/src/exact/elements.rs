//! Elastic elements that yield, in closed form: a linear machine whose stiffness grows by that of the elements that
//! hold.

use fmm_friction::{Element, PiecewiseLinearLaw, Regime};
use fmm_model::Scalar;

use crate::error::SimulationError;
use crate::exact::closed_form::{Cancellation, respond};
use crate::mechanics::{Curve, Decay, Forcing, Piece, ROUNDING, SEARCH_BUDGET, Wave, first_crossing};
use crate::scenario::{Direction, Event, EventKind, Mode, Scenario, State};
use crate::trajectory::{Power, Recorder};

/// A run of a machine with a contact of elements in parallel.
pub(super) struct Yielding<'a, D> {
    scenario: &'a Scenario<D, dyn PiecewiseLinearLaw<D> + 'a>,
    drive: &'a Forcing<'a, D>,
    elements: &'a [Element<D>],
    belt: D,
    /// zᵢ at `time` (m).
    deflections: Vec<D>,
    regime: Regime,
    direction: Direction,
    /// True if nothing moves under the present piece of force.
    at_rest: bool,
    /// Rounding (m/s²) of the acceleration with which the motion begins, if it begins at zero relative velocity.
    noise: Option<f64>,
    time: D,
    state: State<D>,
    budget: usize,
    digits: Cancellation,
}

/// End of a stretch of motion in one regime.
#[derive(Clone, Copy)]
enum Guard {
    RelativeRest,
    Yield(usize),
}

impl<'a, D: Scalar> Yielding<'a, D> {
    pub(super) fn new(scenario: &'a Scenario<D, dyn PiecewiseLinearLaw<D> + 'a>, drive: &'a Forcing<'a, D>) -> Self {
        let elements = scenario.law().elements();
        Self {
            scenario,
            drive,
            elements,
            belt: drive.belt(),
            deflections: (0..elements.len()).map(|index| scenario.deflection(index)).collect(),
            regime: Regime::ALL_HOLD,
            direction: Direction::Positive,
            at_rest: false,
            noise: None,
            time: D::from(0.0),
            state: scenario.initial(),
            budget: SEARCH_BUDGET,
            digits: Cancellation::default(),
        }
    }

    /// Runs from the initial state to the last sample.
    pub(super) fn run(mut self, recorder: &mut Recorder<D>) -> Result<(), SimulationError> {
        let (mut index, mut piece) = (0, self.drive.piece(0));
        self.turn(&piece);
        self.push(EventKind::Start, false, recorder)?;
        self.jump(index);
        let end = recorder.sampling.end();
        loop {
            let (limit, last) = (piece.end.min(end), piece.end > end);
            match self.follow(&piece, limit, last, recorder)? {
                Some((Guard::RelativeRest, grazing)) => {
                    self.state.velocity = self.belt;
                    self.turn(&piece);
                    let kind = if self.at_rest { EventKind::Stop } else { EventKind::Reversal };
                    self.push(kind, grazing, recorder)?;
                }
                Some((Guard::Yield(element), grazing)) => {
                    self.regime = self.regime.sliding(element);
                    let Element { stiffness, level } = self.elements[element];
                    self.deflections[element] = level / stiffness * self.direction.sign();
                    self.push(EventKind::Yield(element), grazing, recorder)?;
                }
                None if last => {
                    let rests = self.at_rest && self.holds_for_good(index);
                    recorder.trajectory.rests = rests;
                    let level = self.elements.iter().fold(D::from(0.0), |sum, element| sum + element.level);
                    return self.digits.check(self.scenario.oscillator(), level * self.scenario.normal_load(), end);
                }
                None => {
                    index += 1;
                    piece = self.drive.piece(index);
                    if self.at_rest {
                        self.turn(&piece);
                        if !self.at_rest {
                            self.push(EventKind::Breakaway, false, recorder)?;
                        }
                    }
                    self.jump(index);
                }
            }
        }
    }

    /// Force on the machine apart from inertia: the load less damping, spring and elements.
    fn force(&self, piece: &Piece<D>) -> Curve<'static, D> {
        let oscillator = self.scenario.oscillator();
        let mut force = Curve::force(piece, self.time);
        force.constant = force.constant
            - oscillator.damping().linear_coefficient() * self.state.velocity
            - oscillator.stiffness() * self.state.position
            - self.friction();
        force
    }

    fn friction(&self) -> D {
        self.friction_at(&self.deflections)
    }

    /// Decides the direction of the motion from here; at zero relative velocity all elements hold again.
    fn turn(&mut self, piece: &Piece<D>) {
        (self.at_rest, self.noise) = (false, None);
        let relative = self.state.velocity.value() - self.belt.value();
        if relative != 0.0 {
            self.direction = Direction::of(relative);
            return;
        }
        self.regime = Regime::ALL_HOLD;
        let (now, zero) = (self.force(piece), D::from(0.0));
        let grows = now.derivative();
        // The first derivative of the relative velocity that is not zero decides; moving with the counterface loads the
        // spring but no element.
        let spring = self.scenario.oscillator().stiffness() * self.belt;
        let candidates = [now.at(zero).value(), (grows.at(zero) - spring).value(), grows.derivative().at(zero).value()];
        // Values within the rounding of the terms count as zero.
        let at_rest = self.scenario.oscillator().stiffness() * self.state.position;
        let parts = [at_rest, self.friction(), spring].map(|part| part.value().abs());
        let waves = |power: i32| {
            let size = |wave: &Wave<D>| wave.cosine.value().hypot(wave.sine.value()) * wave.angular.value().powi(power);
            now.waves.iter().map(size).sum::<f64>()
        };
        let sizes = [
            now.constant.value().abs() + 2.0 * parts[0] + parts[1] + waves(0),
            now.slope.value().abs() + parts[2] + waves(1),
            waves(2),
        ];
        self.noise = Some(ROUNDING * sizes[0] / self.scenario.oscillator().mass().value());
        let decides = |(value, size): &(f64, f64)| value.abs() > ROUNDING * size;
        match candidates.into_iter().zip(sizes).find(decides) {
            Some((value, _)) => self.direction = Direction::of(value),
            None => self.at_rest = true,
        }
    }

    /// Adds the impulse of a force that jumps at the beginning of the piece of this `index`, at a time with
    /// derivatives.
    fn jump(&mut self, index: usize) {
        if !self.at_rest {
            let gained = self.drive.impulse_of_jumps(index) / self.scenario.oscillator().mass();
            self.state.velocity += gained;
        }
    }

    /// True if nothing moves under any force after the piece of this `index` either.
    fn holds_for_good(&mut self, index: usize) -> bool {
        (index + 1..self.drive.pieces()).all(|later| {
            let piece = self.drive.piece(later);
            self.time = D::from(piece.start);
            self.turn(&piece);
            self.at_rest
        })
    }

    fn push(&self, kind: EventKind, grazing: bool, recorder: &mut Recorder<D>) -> Result<(), SimulationError> {
        let level = self.elements.iter().fold(0.0, |sum, element| sum + element.level.value());
        recorder.push(Event {
            kind,
            time: self.time,
            position: self.state.position,
            velocity: self.state.velocity,
            next: if self.at_rest { Mode::Stick } else { Mode::Slip(self.direction) },
            load: self.friction().value().abs(),
            static_level: level * self.scenario.normal_load().value(),
            grazing,
        })
    }

    /// Moves on to the next event or to `limit`, writing samples; the event's guard, and whether it was grazed.
    fn follow(
        &mut self,
        piece: &Piece<D>,
        limit: f64,
        last: bool,
        recorder: &mut Recorder<D>,
    ) -> Result<Option<(Guard, bool)>, SimulationError> {
        let oscillator = self.scenario.oscillator();
        let (load, sign) = (self.scenario.normal_load(), self.direction.sign());
        let (mass, damping) = (oscillator.mass(), oscillator.damping().linear_coefficient());
        // An element that holds is a spring about its relaxed position; one that slides is a force.
        let (mut stiffness, mut forced) = (oscillator.stiffness(), Curve::force(piece, self.time));
        for (index, (element, deflection)) in self.elements.iter().zip(&self.deflections).enumerate() {
            if self.regime.slides(index) {
                forced.constant -= load * element.level * sign;
            } else {
                let spring = load * element.stiffness;
                stiffness += spring;
                forced.constant -= spring * (*deflection - self.state.position);
                forced.slope += spring * self.belt;
            }
        }
        let decay = Decay::new(damping / (mass * 2.0), stiffness / mass);
        let plain = decay.plain();
        let path = respond(forced, mass, damping, stiffness, &decay, self.state)?;
        let velocity = path.derivative();

        let begin = self.time.value();
        let mut found = None;
        if !self.at_rest {
            let mut guards = vec![(Guard::RelativeRest, velocity.scaled(D::from(sign), self.belt * -sign))];
            for (index, (element, deflection)) in self.elements.iter().zip(&self.deflections).enumerate() {
                if !self.regime.slides(index) {
                    // Its reserve, level − s κ (z + x − x₀ − v_b τ).
                    let slope = element.stiffness * -sign;
                    let mut reserve =
                        path.clone().scaled(slope, element.level + slope * (*deflection - self.state.position));
                    reserve.slope -= slope * self.belt;
                    guards.push((Guard::Yield(index), reserve));
                }
            }
            let noise = self.noise;
            let guards = guards.into_iter().map(|(guard, curve)| {
                let plain_curve = curve.plain(&plain);
                let plain_curve = match (guard, noise) {
                    (Guard::RelativeRest, Some(noise)) => plain_curve.risen_from_zero(noise),
                    _ => plain_curve,
                };
                (guard, curve, plain_curve)
            });
            found = first_crossing(guards, self.time, limit, &mut self.budget)?;
        }
        let (time, event) = match found {
            Some((guard, time, grazing)) => (time, Some((guard, grazing))),
            None => (D::from(limit), None),
        };
        let stop = if event.is_none() && last { f64::INFINITY } else { time.value() };
        self.record(&path, piece, &plain, stop, limit.min(time.value()), recorder)?;
        let next = path.state(time - self.time);
        self.digits.note(&path, time.value() - begin, self.state, next);
        let moved = self.moved(next.position, time);
        self.deflections = moved;
        (self.time, self.state, self.noise) = (time, next, None);
        Ok(event)
    }

    /// Friction (N) of elements with these `deflections` (m).
    fn friction_at(&self, deflections: &[D]) -> D {
        let sum = |sum, (element, deflection): (&Element<D>, &D)| sum + element.stiffness * *deflection;
        self.elements.iter().zip(deflections).fold(D::from(0.0), sum) * self.scenario.normal_load()
    }

    /// The deflections at `position` and `time` within the present regime.
    fn moved(&self, position: D, time: D) -> Vec<D> {
        let shift = position - self.state.position - self.belt * (time - self.time);
        let deflection = |(index, z): (usize, &D)| if self.regime.slides(index) { *z } else { *z + shift };
        self.deflections.iter().enumerate().map(deflection).collect()
    }

    fn record(
        &self,
        path: &Curve<D>,
        piece: &Piece<D>,
        plain: &Decay<f64>,
        stop: f64,
        end: f64,
        recorder: &mut Recorder<D>,
    ) -> Result<(), SimulationError> {
        let first = recorder.written;
        for index in first..recorder.sampling.index_at_or_after(stop) {
            let time = D::from(recorder.sampling.time(index));
            let deflections = self.moved(path.at(time - self.time), time);
            for (element, deflection) in deflections.into_iter().enumerate() {
                recorder.trajectory.states[element].set(index, deflection);
            }
        }
        recorder.samples(stop, |time| path.state(-self.time + time))?;
        let velocity = path.derivative();
        recorder.accelerations(first, |time, _| {
            let acceleration = velocity.state(-self.time + time).velocity;
            if self.at_rest { acceleration - acceleration.value() } else { acceleration }
        })?;
        let frequency = path.frequencies().fold(plain.natural() + 2.0 * plain.rate, f64::max);
        let oscillator = self.scenario.oscillator();
        recorder.work(self.time.value(), end, 1.0 / frequency, |time| {
            let State { position, velocity } = path.state(-self.time + time);
            let friction = self.friction_at(&self.moved(position, D::from(time)));
            Power::of(friction, oscillator.damping_force(velocity), piece.force(time), velocity, self.belt)
        })
    }
}
