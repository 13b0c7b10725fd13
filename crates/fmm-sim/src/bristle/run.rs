//! A run from event to event: steps of a method, the last of them ending at the end of the smooth branch.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::Scalar;

use crate::bristle::collocation::Collocation;
use crate::bristle::explicit::Explicit;
use crate::bristle::field::{Branch, Field};
use crate::bristle::first_root::BEGINNING;
use crate::bristle::guards::{Approach, Guard, Landing};
use crate::bristle::pace::Pace;
use crate::bristle::polynomial::{Solved, Span, StepPolynomial};
use crate::bristle::taylor::Taylor;
use crate::error::SimulationError;
use crate::mechanics::{Forcing, Piece, WEAK_SPRING};
use crate::scenario::{Direction, EventKind, State};
use crate::trajectory::{Power, Recorder};

/// Greatest number of steps of one run, which take about a second; no record needs more.
const STEP_BUDGET: usize = 300_000;

/// Greatest number of attempts at one step.
const MOST_ATTEMPTS: usize = 100;

/// Place of a zero of a guard, in units of the step, from which on the step is corrected instead of shortened (1).
const NEAR: f64 = 0.99;

/// A simulation under way.
pub(super) struct Run<'a, D, L: ?Sized> {
    pub(super) field: Field<'a, D, L>,
    pub(super) step: StepPolynomial<D>,
    pub(super) collocation: Collocation<D>,
    explicit: Explicit<D>,
    pub(super) taylor: Taylor<D>,
    pub(super) pace: Pace,
    pub(super) recorder: Recorder<'a, D>,
    pub(super) branch: Branch,
    /// True if nothing drives the contact from relative rest.
    pub(super) resting: bool,
    /// Time of the state (s).
    pub(super) time: f64,
    pub(super) tolerance: f64,
    /// Stiffness of spring and bristles together, per mass (1/s²), at the beginning of the half cycle.
    pub(super) stiffness: f64,
    steps: usize,
    /// Room for two states or rates.
    pub(super) before: Vec<D>,
    pub(super) after: Vec<D>,
    /// Room for the rates (1/s) at which the states return.
    pub(super) relaxations: Vec<f64>,
}

impl<'a, D: Scalar, L: BristleLaw<D> + ?Sized> Run<'a, D, L> {
    /// A simulation that begins at `begin`: x, v and the states of the law.
    pub(super) fn new(field: Field<'a, D, L>, begin: Vec<D>, tolerance: f64, recorder: Recorder<'a, D>) -> Self {
        Self {
            step: StepPolynomial::new(begin.clone()),
            collocation: Collocation::new(begin.len()),
            explicit: Explicit::new(begin.len()),
            taylor: Taylor::new(),
            pace: Pace::new(),
            branch: Branch { direction: Direction::Positive, regime: Regime::ALL_HOLD },
            resting: false,
            time: 0.0,
            tolerance,
            stiffness: 0.0,
            steps: 0,
            relaxations: vec![0.0; begin.len() - 2],
            before: begin.clone(),
            after: begin,
            field,
            recorder,
        }
    }

    /// Runs from the initial state to the last sample; returns the number of steps, refused ones included.
    pub(super) fn run(mut self, drive: &Forcing<D>) -> Result<usize, SimulationError> {
        let end = self.recorder.sampling.end();
        let mut piece = drive.piece(0);
        let relative = self.step.begin[1].value() - self.field.belt.value();
        // What drives a contact at rest is the force of the spring where it is.
        self.field.spring.begin(self.step.begin[0], self.heading());
        self.stiffness = self.stiffness_here();
        let direction = if relative == 0.0 { self.departure(&piece) } else { Some(Direction::of(relative)) };
        let grazing = direction.is_none() && self.rest_has_derivatives(&piece);
        self.go(direction);
        self.push_here(EventKind::Start, &piece, grazing)?;
        self.jump(drive, 0);
        let mut index = 0;
        loop {
            let limit = piece.end.min(end);
            while self.time < limit {
                if self.resting {
                    self.hold(&piece, limit)?;
                } else {
                    self.advance(&piece, limit)?;
                    SimulationError::require_restoring(self.field.oscillator, self.time, self.step.begin[0])?;
                }
            }
            if piece.end > end {
                break;
            }
            index += 1;
            piece = drive.piece(index);
            self.collocation.forget();
            if self.resting
                && let Some(direction) = self.departure(&piece)
            {
                self.go(Some(direction));
                self.push_here(EventKind::Breakaway, &piece, false)?;
            }
            self.jump(drive, index);
        }
        // The samples at the end itself hold the state after an event there.
        let first = self.recorder.written;
        self.write(f64::INFINITY)?;
        if self.resting {
            self.recorder.at_constant_speed(first);
        } else {
            self.field.begin(self.branch, &self.step.begin);
            self.accelerate(first, &piece)?;
        }
        let rests = self.resting
            && (index + 1..drive.pieces()).all(|later| {
                let piece = drive.piece(later);
                self.time = piece.start;
                self.departure(&piece).is_none()
            });
        self.recorder.trajectory.rests = rests;
        Ok(self.steps)
    }

    /// Adds the impulse of a force that jumps at the beginning of the piece of this `index`, at a time with
    /// derivatives.
    fn jump(&mut self, drive: &Forcing<D>, index: usize) {
        if !self.resting {
            let gained = drive.impulse_of_jumps(index) / self.field.oscillator.mass();
            self.step.begin[1] += gained;
        }
    }

    /// Sets the direction of the motion to come, or rest.
    pub(super) fn go(&mut self, direction: Option<Direction>) {
        self.resting = direction.is_none();
        self.branch = Branch { direction: direction.unwrap_or(self.branch.direction), regime: Regime::ALL_HOLD };
        self.step.turn(self.field.belt.value());
        self.collocation.forget();
        self.field.release();
        self.field.begin(self.branch, &self.step.begin);
        self.field.spring.begin(self.step.begin[0], self.heading());
        self.pace.turn();
    }

    /// The direction in which the mass moves, or leaves rest.
    pub(super) fn heading(&self) -> Direction {
        let velocity = self.step.begin[1].value();
        if velocity == 0.0 { self.branch.direction } else { Direction::of(velocity) }
    }

    /// Goes on by one step, to `limit` (s) at most, or to an event before it.
    pub(super) fn advance(&mut self, piece: &Piece<D>, limit: f64) -> Result<(), SimulationError> {
        for index in 0..self.field.size() - 2 {
            let reserve = self.field.reserve(index, self.branch, &self.step.begin);
            if reserve.is_some_and(|reserve| reserve.value() <= 0.0) {
                return self.arrive(Guard::Reserve(index), piece, false);
            }
        }
        self.field.begin(self.branch, &self.step.begin);
        if self.field.saturate(self.branch, &mut self.step.begin, self.tolerance.max(4.0 * f64::EPSILON)) {
            self.pace.relax(self.slow(piece));
        }
        if !self.pace.implicit && self.expand(piece, limit)? {
            return Ok(());
        }
        self.step.take_stages();
        self.advance_by_stages(piece, limit)
    }

    /// Goes on by one step of order 8 or an implicit one, to `limit` (s) at most, or to an event before it.
    fn advance_by_stages(&mut self, piece: &Piece<D>, limit: f64) -> Result<(), SimulationError> {
        self.step.local = self.field.local_angular(self.step.begin[0]);
        let at_zero = self.step.begin[1].value() == self.field.belt.value();
        let room = limit - self.time;
        let mut length = self.first_length().min(room);
        if length < room && room < 2.0 * length {
            length = 0.5 * room;
        }
        let whole = length;
        let mut turned = false;
        let mut approach = None;
        for _ in 0..MOST_ATTEMPTS {
            if length <= self.least(length) && length < room {
                break;
            }
            self.count_step()?;
            let span = Span { begin: self.time, length, tolerance: self.tolerance };
            let Some(solved) = self.take(piece, span)? else {
                self.collocation.forget();
                let saturates = self.field.saturate(self.branch, &mut self.step.begin, self.tolerance);
                length *= if saturates { 1.0 } else { 0.25 };
                approach = None;
                continue;
            };
            let found = if solved.followed { self.first_guard(at_zero) } else { Ok(None) };
            let Ok(found) = found else {
                self.retry(length);
                length *= 0.5;
                continue;
            };
            // An inaccurate step does not show an event at its beginning.
            let at_once = |tau: f64| tau * length <= self.least(length);
            let found = found.filter(|(tau, _)| solved.error <= 1.0 || !at_once(*tau));
            if let Some((tau, guard)) = found {
                if at_once(tau) {
                    if !(at_zero && guard == Guard::Speed) {
                        return self.arrive(guard, piece, false);
                    }
                    // The half cycle may be over before the velocity counts as risen.
                    length *= BEGINNING;
                    if length <= self.least(whole) {
                        if turned {
                            break;
                        }
                        // The rounding of the load has hidden the direction of the half cycle.
                        (length, turned) = (whole, true);
                        self.turn_at_once();
                    }
                    self.collocation.forget();
                    continue;
                }
                approach = Some(Approach::of(guard, approach));
                if tau < NEAR {
                    self.retry(length);
                    length *= tau;
                    continue;
                }
            }
            if solved.error > 1.0 {
                // A zero that a step too long has seen may be none.
                approach = None;
                self.retry(length);
                length = self.pace.refuse(solved, length);
                continue;
            }
            if let Some(Approach { guard, nearest }) = approach {
                match self.landing(guard, nearest) {
                    Landing::There { correction, grazing } => {
                        if let Some(shorter) = self.before_hidden(piece, length) {
                            (length, approach) = (shorter, None);
                            continue;
                        }
                        self.finish(length, correction, limit, piece)?;
                        return self.arrive(guard, piece, grazing);
                    }
                    Landing::Near { correction } if (1.0 + correction) * length <= room => {
                        approach = Some(Approach { guard, nearest: correction.abs() });
                        self.retry(length);
                        length *= 1.0 + correction;
                        continue;
                    }
                    Landing::Near { .. } | Landing::Far => {
                        if let Some((tau, _)) = found {
                            self.retry(length);
                            length *= tau.min(NEAR);
                            continue;
                        }
                    }
                }
            }
            if let Some(shorter) = self.before_hidden(piece, length) {
                length = shorter;
                continue;
            }
            let was_implicit = self.pace.implicit;
            let to_turn = length * self.step.to_turn(self.field.belt.value());
            self.pace.accept(solved, length, at_zero, self.slow(piece), [room - length, to_turn]);
            if self.pace.implicit != was_implicit {
                self.collocation.forget();
            }
            return self.finish(length, 0.0, limit, piece);
        }
        Err(SimulationError::step_too_small(self.tolerance, self.time))
    }

    /// Rounding (s) of the end of a step of this `length` (s): no step is shorter, and an event within it is at its
    /// beginning.
    pub(super) fn least(&self, length: f64) -> f64 {
        4.0 * f64::EPSILON * (self.time + length)
    }

    /// Takes a step by the present method.
    fn take(&mut self, piece: &Piece<D>, span: Span) -> Result<Option<Solved>, SimulationError> {
        let Self { step, collocation, explicit, field, branch, .. } = self;
        if self.pace.implicit {
            collocation.solve(step, field, *branch, piece, span)
        } else {
            Ok(explicit.take(step, field, *branch, piece, span))
        }
    }

    /// The next step begins where this one of `length` has begun.
    fn retry(&mut self, length: f64) {
        if self.pace.implicit {
            self.collocation.predict_from(&self.step, length, 0.0);
        }
    }

    /// The length with which to try this step of `length` again, if it has passed a part of the law.
    fn before_hidden(&mut self, piece: &Piece<D>, length: f64) -> Option<f64> {
        let part = self.hidden(piece, length)?;
        self.retry(length);
        Some(length * part)
    }

    /// Angular frequency (rad/s) of the machine, or of the fastest wave.
    pub(super) fn slow(&self, piece: &Piece<D>) -> f64 {
        piece.frequencies().fold(self.angular(), f64::max)
    }

    /// Angular frequency (rad/s) of the machine, or one of little rotation within the sampled time if that is greater.
    fn angular(&self) -> f64 {
        self.field.oscillator.natural_angular_frequency().value().max(WEAK_SPRING / self.recorder.sampling.end())
    }

    pub(super) fn count_step(&mut self) -> Result<(), SimulationError> {
        self.steps += 1;
        self.recorder.sampling.require_steps(self.steps, STEP_BUDGET)
    }

    /// Length (s) of the step to try first: the proposal of the last one, or a part of the period of the machine on its
    /// bristles.
    pub(super) fn first_length(&mut self) -> f64 {
        if let Some(proposed) = self.pace.proposed() {
            return proposed;
        }
        self.stiffness = self.stiffness_here();
        self.pace.first(self.stiffness)
    }

    /// Stiffness of spring and bristles together, per mass (1/s²).
    fn stiffness_here(&mut self) -> f64 {
        let size = self.field.size();
        let mut jacobian = vec![0.0; size * size];
        let begin = &self.step.begin;
        let angular = self.angular();
        let bristles = self.field.law.bound(0).value().abs() * angular;
        let speed = begin[1].value().abs().max(angular * begin[0].value().abs()).max(bristles);
        self.field.jacobian(self.branch, begin, speed, &mut jacobian);
        let bristles = (2..size).map(|state| (jacobian[size + state] * jacobian[state * size + 1]).abs());
        jacobian[size].abs() + bristles.sum::<f64>()
    }

    /// Writes the samples within the step of `length` and goes to its end, or a part `correction` of it further.
    pub(super) fn finish(
        &mut self,
        length: f64,
        correction: f64,
        limit: f64,
        piece: &Piece<D>,
    ) -> Result<(), SimulationError> {
        let whole = correction == 0.0 && length == limit - self.time;
        let end = if whole { limit } else { (self.time + length * (1.0 + correction)).min(limit) };
        if self.recorder.has_samples_before(end) {
            let (half, step, first) = (0.5 * length, &self.step, self.recorder.written);
            if step.is_series() {
                self.recorder.polynomials(end, self.time, length, |component| step.series[component])?;
            } else {
                self.recorder.polynomials(end, self.time + half, half, |component| step.centred(component))?;
            }
            self.accelerate(first, piece)?;
        }
        let Self { step, field, recorder, branch, time, before, .. } = self;
        // A series reaches further than its powers vary little.
        let smooth = if step.is_series() { 0.25 * length } else { length };
        recorder.work(*time, end, smooth, |at| {
            step.at((at - *time) / length, before);
            let friction = field.friction(*branch, before);
            let (velocity, damping) = (before[1], field.oscillator.damping_force(before[1]));
            Power::of(friction, damping, piece.force(at), velocity, field.belt)
        })?;
        if self.pace.implicit {
            self.collocation.predict_from(&self.step, length, 1.0);
        }
        self.step.advance(correction);
        self.time = end;
        Ok(())
    }

    /// Writes the accelerations of the samples from `first` on, which lie on the present branch.
    fn accelerate(&mut self, first: usize, piece: &Piece<D>) -> Result<(), SimulationError> {
        let Self { field, recorder, branch, before: state, .. } = self;
        recorder.accelerations_with_states(first, state, |time, state| {
            field.acceleration(piece.force(time), *branch, state)
        })
    }

    /// Writes the present state into the samples before `end`.
    fn write(&mut self, end: f64) -> Result<(), SimulationError> {
        let Self { step, recorder, before: state, .. } = self;
        recorder.samples_with_states(end, state, |_, state| {
            state.copy_from_slice(&step.begin);
            State { position: state[0], velocity: state[1] }
        })
    }

    /// Rests until `limit` (s).
    fn hold(&mut self, piece: &Piece<D>, limit: f64) -> Result<(), SimulationError> {
        let first = self.recorder.written;
        self.write(limit)?;
        self.recorder.at_constant_speed(first);
        let velocity = self.step.begin[1];
        let belt = self.field.belt;
        let friction = self.field.friction(self.branch, &self.step.begin);
        let power =
            |at| Power { viscous: D::from(0.0), ..Power::of(friction, velocity, piece.force(at), velocity, belt) };
        self.recorder.work(self.time, limit, limit - self.time, power)?;
        self.time = limit;
        Ok(())
    }
}
