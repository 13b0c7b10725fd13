//! From event to event: steps of the method, landing on what ends a smooth branch, and what comes after.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::{Restoring, Scalar};

use super::collocation::{Collocation, Span};
use super::field::{Branch, Field};
use super::first_root::{end_slope, first_root, last_coefficient};
use super::radau::STAGES;
use crate::curve::Curve;
use crate::drive::{Drive, Piece};
use crate::recorder::Recorder;
use crate::work::Power;
use crate::{Direction, Event, EventKind, Mode, Scenario, SimulationError, State};

/// No record needs more steps.
const STEP_BUDGET: usize = 1_000_000;

/// Attempts at one step before it is given up.
const MOST_ATTEMPTS: usize = 100;

/// What is left of a step when an event has been landed on is covered by its tangent if it is no more than this.
const TANGENT: f64 = 1e-9;

/// How large the last Legendre coefficient of a guard on a step may be, relative to the guard.
const SMOOTH: f64 = 1e-4;

/// Where an event is sought: how the smooth branch can end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Guard {
    /// The relative velocity reaches zero.
    Speed,
    /// An element begins to slide.
    Reserve(usize),
    /// The velocity, or a state of the law, passes zero, where damping or law may have a corner. This is no event.
    Corner(usize),
}

/// How far the end of a step is from the zero of a guard, in units of its length.
#[derive(Debug, Clone, Copy)]
struct Landing {
    correction: f64,
    grazing: bool,
}

/// A simulation under way.
pub(super) struct Run<'a, D, L> {
    field: Field<'a, D, L>,
    step: Collocation<D>,
    recorder: Recorder<'a, D>,
    branch: Branch,
    resting: bool,
    time: f64,
    proposed: f64,
    angular: f64,
    tolerance: f64,
    steps: usize,
    dbg: [usize; 3],
    before: Vec<D>,
    after: Vec<D>,
}

impl<'a, D: Scalar, L: BristleLaw<D>> Run<'a, D, L> {
    pub(super) fn new(
        scenario: &'a Scenario<D, L>,
        drive: &Drive<D>,
        tolerance: f64,
        recorder: Recorder<'a, D>,
    ) -> Self {
        let field = Field::new(scenario, drive.belt());
        let State { position, velocity } = scenario.initial();
        let mut begin = vec![D::from(0.0); field.size()];
        begin[0] = position;
        begin[1] = velocity;
        Self {
            step: Collocation::new(begin.clone()),
            branch: Branch { direction: Direction::Positive, regime: Regime::ALL_HOLD },
            resting: false,
            time: 0.0,
            proposed: f64::INFINITY,
            angular: field.oscillator.natural_angular_frequency().value(),
            tolerance,
            steps: 0,
            dbg: [0; 3],
            before: begin.clone(),
            after: begin,
            field,
            recorder,
        }
    }

    pub(super) fn run(mut self, drive: &Drive<D>) -> Result<(), SimulationError> {
        let end = self.recorder.sampling.end();
        let mut piece = drive.piece(0);
        let relative = self.step.begin[1].value() - self.field.belt.value();
        let direction = if relative == 0.0 { self.departure(&piece) } else { Some(Direction::of(relative)) };
        let grazing = direction.is_none() && self.rest_has_derivatives(&piece);
        self.go(direction);
        self.push_here(EventKind::Start, &piece, grazing)?;
        for index in 1.. {
            let limit = piece.end.min(end);
            while self.time < limit {
                if self.resting {
                    self.hold(&piece, limit)?;
                } else {
                    self.advance(&piece, limit)?;
                }
            }
            if piece.end > end {
                break;
            }
            piece = drive.piece(index);
            self.step.forget();
            if self.resting
                && let Some(direction) = self.departure(&piece)
            {
                self.go(Some(direction));
                self.push_here(EventKind::Breakaway, &piece, false)?;
            }
        }
        if std::env::var("BDBG").is_ok() {
            eprintln!(
                "DBG steps {} iterations {} failed {} rejected {} guards {} landings {}",
                self.steps, self.step.iterations, self.step.failed, self.dbg[0], self.dbg[1], self.dbg[2]
            );
        }
        // The samples at the end itself hold the state after an event there.
        self.write(f64::INFINITY, None)
    }

    /// Sets the direction of the motion to come, or rest.
    fn go(&mut self, direction: Option<Direction>) {
        self.resting = direction.is_none();
        self.branch = Branch { direction: direction.unwrap_or(self.branch.direction), regime: Regime::ALL_HOLD };
        self.step.turn(self.field.belt.value());
        self.field.release();
        self.field.begin(self.branch, &self.step.begin);
        self.proposed = f64::INFINITY;
    }

    /// Goes on by one step, to `limit` (s) at most, or to an event before it.
    fn advance(&mut self, piece: &Piece<D>, limit: f64) -> Result<(), SimulationError> {
        for index in 0..self.field.size() - 2 {
            let reserve = self.field.reserve(index, self.branch, &self.step.begin);
            if reserve.is_some_and(|reserve| reserve.value() <= 0.0) {
                return self.arrive(Guard::Reserve(index), piece, false);
            }
        }
        self.field.begin(self.branch, &self.step.begin);
        let at_zero = self.step.begin[1].value() == self.field.belt.value();
        let room = limit - self.time;
        let mut length = self.first_length().min(room);
        if length < room && room < 2.0 * length {
            length = 0.5 * room;
        }
        let (mut target, mut turned, mut nearest) = (None, false, f64::INFINITY);
        for _ in 0..MOST_ATTEMPTS {
            if self.time + 0.125 * length == self.time && length < room {
                break;
            }
            self.count_step()?;
            let span = Span {
                begin: self.time,
                length,
                tolerance: self.tolerance,
            };
            let Some(solved) = self.step.solve(&mut self.field, self.branch, piece, span)? else {
                self.step.forget();
                let saturates = self.field.saturate(self.branch, &mut self.step.begin, self.tolerance);
                length *= if saturates { 1.0 } else { 0.25 };
                continue;
            };
            if !self.guards_are_smooth() {
                self.step.retry(length);
                length *= 0.5;
                continue;
            }
            if let Some((tau, guard)) = self.first_guard() {
                if tau * length <= 2.0 * f64::EPSILON * (self.time + length) {
                    if !(at_zero && guard == Guard::Speed) {
                        return self.arrive(guard, piece, false);
                    }
                    // At the start of a swing the rounding of the load may have hidden its direction.
                    length *= if turned { 0.1 } else { 1.0 };
                    turned = !turned;
                    self.branch.direction = Direction::of(-self.branch.direction.sign());
                    self.field.begin(self.branch, &self.step.begin);
                    self.step.forget();
                    continue;
                }
                if target != Some(guard) {
                    (target, nearest) = (Some(guard), f64::INFINITY);
                }
                if tau < 0.99 {
                    self.dbg[1] += 1;
                    self.step.retry(length);
                    length *= tau;
                    continue;
                }
            }
            if solved.error > 1.0 {
                self.step.retry(length);
                length *= change(solved.error);
                self.dbg[0] += 1;
                continue;
            }
            if let Some(guard) = target {
                let landing = self.landing(guard, length);
                let distance = landing.correction.abs();
                // Corrections that no longer shrink are rounding.
                if landing.grazing || distance <= TANGENT || (distance < 0.1 && distance > 0.5 * nearest) {
                    self.finish(length, landing.correction, f64::INFINITY, piece)?;
                    return self.arrive(guard, piece, landing.grazing);
                }
                let correction = 1.0 + landing.correction;
                if distance < 0.1 && correction * length <= room {
                    nearest = distance;
                    self.step.retry(length);
                    length *= correction;
                    self.dbg[2] += 1;
                    continue;
                }
            }
            let growth = change(solved.error);
            self.proposed = length * if solved.quick { growth } else { growth.min(1.0) };
            return self.finish(length, 0.0, limit, piece);
        }
        Err(SimulationError::StepTooSmall { tolerance: self.tolerance, time: self.time })
    }

    fn count_step(&mut self) -> Result<(), SimulationError> {
        self.steps += 1;
        let end = self.recorder.sampling.end();
        if self.steps > STEP_BUDGET { Err(SimulationError::StepBudget { budget: STEP_BUDGET, end }) } else { Ok(()) }
    }

    /// Length (s) of the step to try first: as the last one says, or a part of the period in which the machine swings on
    /// its bristles.
    fn first_length(&mut self) -> f64 {
        if self.proposed.is_finite() {
            return self.proposed;
        }
        let size = self.field.size();
        let mut jacobian = vec![0.0; size * size];
        let begin = &self.step.begin;
        let bristles = self.field.law.bound(0).value().abs() * self.angular;
        let speed = begin[1].value().abs().max(self.angular * begin[0].value().abs()).max(bristles);
        self.field.jacobian(self.branch, begin, speed, &mut jacobian);
        let bristles = (2..size).map(|state| (jacobian[size + state] * jacobian[state * size + 1]).abs());
        let stiffness = jacobian[size].abs() + bristles.sum::<f64>();
        if stiffness > 0.0 { 0.3 / stiffness.sqrt() } else { f64::MAX }
    }

    /// The first guard that is reached within the step, and where.
    fn first_guard(&mut self) -> Option<(f64, Guard)> {
        let mut first: Option<(f64, Guard)> = None;
        let mut look = |coefficients, guard| {
            if let Some(tau) = first_root(coefficients)
                && first.is_none_or(|(earliest, _)| tau < earliest)
            {
                first = Some((tau, guard));
            }
        };
        look(self.guard_polynomial(Guard::Speed), Guard::Speed);
        for index in 0..self.field.size() - 2 {
            if self.field.reserve(index, self.branch, &self.step.begin).is_some() {
                look(self.guard_polynomial(Guard::Reserve(index)), Guard::Reserve(index));
            }
        }
        let drag = !self.field.oscillator.damping().is_linear() && self.field.belt.value() != 0.0;
        for component in 1..self.field.size() {
            let may_bend = if component == 1 { drag } else { self.field.is_below(component - 2) };
            if may_bend && self.step.begin[component].value() != 0.0 {
                look(self.guard_polynomial(Guard::Corner(component)), Guard::Corner(component));
            }
        }
        first
    }

    /// Whether the reserves of all elements are polynomials on the step as good as those of the motion, so that their
    /// zeros can be sought on these: a reserve may depend on the velocity in a way that the motion does not.
    fn guards_are_smooth(&mut self) -> bool {
        (0..self.field.size() - 2).all(|index| {
            self.field.reserve(index, self.branch, &self.step.begin).is_none()
                || last_coefficient(self.guard_polynomial(Guard::Reserve(index))) <= SMOOTH
        })
    }

    /// Bernstein coefficients of a guard, positive before it is reached.
    fn guard_polynomial(&mut self, guard: Guard) -> [f64; STAGES + 1] {
        let Self { step, field, branch, .. } = self;
        match guard {
            Guard::Speed => {
                let (belt, sign) = (field.belt.value(), branch.direction.sign());
                step.bernstein(|state| (state[1].value() - belt) * sign)
            }
            Guard::Reserve(index) => step.bernstein(|state| {
                field.reserve(index, *branch, state).map_or(f64::INFINITY, |reserve| reserve.value())
            }),
            Guard::Corner(component) => {
                let sign = step.begin[component].value().signum();
                step.bernstein(|state| state[component].value() * sign)
            }
        }
    }

    /// How far, in units of the step, its end is from the zero of `guard`.
    fn landing(&mut self, guard: Guard, length: f64) -> Landing {
        let coefficients = self.guard_polynomial(guard);
        let slope = match guard {
            Guard::Speed => self.step.end_acceleration().value() * self.branch.direction.sign() * length,
            Guard::Reserve(_) | Guard::Corner(_) => end_slope(coefficients),
        };
        let [.., before, last, end] = coefficients;
        let curvature = (STAGES * (STAGES - 1)) as f64 * (end - 2.0 * last + before);
        let size = coefficients.iter().fold(0.0f64, |size, coefficient| size.max(coefficient.abs()));
        // Where the slope is that small, rounding moves the zero further than it is from the turning point.
        let grazing = !(slope < 0.0) || slope * slope <= 4.0 * f64::EPSILON * size * curvature.abs();
        let correction = if grazing { 0.0 } else { -end / slope };
        Landing { correction, grazing }
    }

    /// Writes what the step of `length` passes and goes to its end, or a part `correction` of it further.
    fn finish(&mut self, length: f64, correction: f64, limit: f64, piece: &Piece<D>) -> Result<(), SimulationError> {
        let room = limit - self.time;
        let end = if length == room { limit } else { self.time + length * (1.0 + correction) };
        self.write(end, Some(length))?;
        let Self { step, field, recorder, branch, time, before, .. } = self;
        recorder.work(*time, end, length, |at| {
            step.at((at - *time) / length, before);
            let friction = field.friction(*branch, before);
            let velocity = before[1];
            Power {
                friction: friction * (velocity - field.belt),
                viscous: field.oscillator.damping().force(velocity) * velocity,
                external: piece.force(at) * velocity - friction * field.belt,
            }
        })?;
        self.step.advance(length);
        if correction != 0.0 {
            self.step.nudge(correction * length);
        }
        self.time = end;
        Ok(())
    }

    /// Writes the samples before `end`, on the step of `length`; without one, the state stays what it is.
    fn write(&mut self, end: f64, length: Option<f64>) -> Result<(), SimulationError> {
        let Self { step, recorder, time, before: state, .. } = self;
        let at = |sample: f64, state: &mut [D]| match length {
            Some(length) => step.at((sample - *time) / length, state),
            None => state.copy_from_slice(&step.begin),
        };
        recorder.samples_with_states(end, state, |sample, state| {
            at(sample, state);
            State { position: state[0], velocity: state[1] }
        })
    }

    /// Rests until `limit` (s).
    fn hold(&mut self, piece: &Piece<D>, limit: f64) -> Result<(), SimulationError> {
        self.write(limit, None)?;
        let velocity = self.step.begin[1];
        let belt = self.field.belt;
        let friction = self.field.friction(self.branch, &self.step.begin);
        self.recorder.work(self.time, limit, limit - self.time, |at| Power {
            friction: friction * (velocity - belt),
            viscous: D::from(0.0),
            external: piece.force(at) * velocity - friction * belt,
        })?;
        self.time = limit;
        Ok(())
    }

    /// Passes what `guard` has led to.
    fn arrive(&mut self, guard: Guard, piece: &Piece<D>, grazing: bool) -> Result<(), SimulationError> {
        self.field.rates(piece.force(self.time), self.branch, &self.step.begin, &mut self.before);
        match guard {
            Guard::Speed => {
                let velocity = self.step.begin[1];
                let speed = velocity - self.field.belt;
                let shift = -(speed - speed.value()) / self.before[1].value();
                self.step.begin[1] = velocity - velocity.value() + self.field.belt.value();
                let direction = self.departure(piece);
                self.go(direction);
                let kind = if direction.is_none() { EventKind::Stop } else { EventKind::Reversal };
                self.pass(kind, piece, shift, grazing)
            }
            Guard::Reserve(index) => {
                let shift = self.reserve_shift(index);
                self.branch.regime = self.branch.regime.sliding(index);
                self.field.begin(self.branch, &self.step.begin);
                self.step.forget();
                self.pass(EventKind::Yield(index), piece, shift, grazing)
            }
            Guard::Corner(component) => {
                let y = &mut self.step.begin[component];
                *y = *y - y.value();
                Ok(())
            }
        }
    }

    /// Goes over from the rates `self.before` an event to those after it: the event shifts by `shift`, whose value is 0,
    /// and with it the time from which on the new rates hold, y_θ⁺ = y_θ⁻ + (f⁻ − f⁺) t_θ.
    fn pass(&mut self, kind: EventKind, piece: &Piece<D>, shift: D, grazing: bool) -> Result<(), SimulationError> {
        let shift = if grazing || D::DIRECTIONS == 0 { D::from(0.0) } else { shift };
        let [x, v] = [0, 1].map(|component| self.step.begin[component] + self.before[component] * shift);
        let velocity = if matches!(kind, EventKind::Yield(_)) { v } else { self.field.belt };
        if D::DIRECTIONS > 0 {
            self.after.fill(D::from(0.0));
            if !self.resting {
                self.field.rates(piece.force(self.time), self.branch, &self.step.begin, &mut self.after);
            }
            for ((y, before), after) in self.step.begin.iter_mut().zip(&self.before).zip(&self.after) {
                *y = *y + (*before - *after) * shift;
            }
        }
        self.push(kind, piece, State { position: x, velocity }, shift, grazing)
    }

    /// −g_θ/ġ for the reserve g of element `index`, with ġ from differences along the motion `self.before`.
    fn reserve_shift(&mut self, index: usize) -> D {
        let begin = &self.step.begin;
        // Over a time in which the states move by a thousandth of their bounds; the formula is of order 4.
        let rate = (2..begin.len()).map(|i| (self.before[i] / self.field.law.bound(i - 2)).value().abs());
        let time = 1e-3 / rate.fold(f64::MIN_POSITIVE, f64::max);
        let mut reserve = |time: f64| {
            for ((after, y), rate) in self.after.iter_mut().zip(begin).zip(&self.before) {
                *after = D::from(y.value() + rate.value() * time);
            }
            self.field.reserve(index, self.branch, &self.after).map_or(0.0, |reserve| reserve.value())
        };
        let near = reserve(time) - reserve(-time);
        let far = reserve(2.0 * time) - reserve(-2.0 * time);
        let slope = (8.0 * near - far) / (12.0 * time);
        let Some(reserve) = self.field.reserve(index, self.branch, begin) else { return D::from(0.0) };
        if slope == 0.0 { D::from(0.0) } else { -(reserve - reserve.value()) / slope }
    }

    /// The direction in which the contact leaves relative rest; none if nothing drives it.
    ///
    /// That is the sign of the acceleration, or of its first derivative that is not zero within rounding: at u = 0 the
    /// bristles stand still, so only the force and a moving counterface change the load.
    fn departure(&mut self, piece: &Piece<D>) -> Option<Direction> {
        let begin = &self.step.begin;
        let force = piece.force(self.time);
        let branch = Branch { regime: Regime::ALL_HOLD, ..self.branch };
        self.field.rates(force, branch, begin, &mut self.after);
        let mass = self.field.oscillator.mass().value();
        let amplitude = |wave: &crate::drive::Harmonic<D>| wave.amplitude.value().abs();
        let size = self.field.force_size(force, branch, begin) + piece.waves().iter().map(amplitude).sum::<f64>();
        let load = self.after[1].value() * mass;
        if load.abs() > 4.0 * f64::EPSILON * size {
            return Some(Direction::of(load));
        }
        let (stiffness, x) = (self.field.oscillator.stiffness().value(), begin[0].value());
        let belt = self.field.belt.value();
        let (slope, bend) = match self.field.oscillator.restoring() {
            Restoring::Sine { length } => {
                let (sin, cos) = (x / length.value()).sin_cos();
                (stiffness * cos, -stiffness / length.value() * sin)
            }
            _ => (stiffness, 0.0),
        };
        let rising = Curve::force(piece, D::from(self.time)).derivative();
        let first = rising.plain_jet(0.0);
        for (change, size) in [
            (first.value - slope * belt, first.size + (slope * belt).abs()),
            (first.slope - bend * belt * belt, first.most_curvature),
        ] {
            if change.abs() > 4.0 * f64::EPSILON * size {
                return Some(Direction::of(change));
            }
        }
        // A counterface that moves takes the contact along.
        (belt != 0.0).then_some(self.branch.direction)
    }

    /// Whether the inputs with derivatives would set the contact in motion from the rest in which it is.
    fn rest_has_derivatives(&mut self, piece: &Piece<D>) -> bool {
        let force = piece.force(self.time);
        self.field.rates(force, self.branch, &self.step.begin, &mut self.after);
        let [velocity, acceleration] = [self.after[0], self.after[1]];
        (0..D::DIRECTIONS).any(|i| velocity.partial(i) != 0.0 || acceleration.partial(i) != 0.0)
    }

    /// An event whose time has no derivatives.
    fn push_here(&mut self, kind: EventKind, piece: &Piece<D>, grazing: bool) -> Result<(), SimulationError> {
        let state = State { position: self.step.begin[0], velocity: self.step.begin[1] };
        self.push(kind, piece, state, D::from(0.0), grazing)
    }

    fn push(
        &mut self,
        kind: EventKind,
        piece: &Piece<D>,
        state: State<D>,
        shift: D,
        grazing: bool,
    ) -> Result<(), SimulationError> {
        self.before.copy_from_slice(&self.step.begin);
        self.before[1] = self.field.belt;
        let held = self.field.friction(self.branch, &self.before).value();
        let machine = self.field.oscillator.damping().force(self.field.belt)
            + self.field.oscillator.restoring_force(state.position);
        self.recorder.push(Event {
            kind,
            time: shift + self.time,
            position: state.position,
            velocity: state.velocity,
            next: if self.resting { Mode::Stick } else { Mode::Slip(self.branch.direction) },
            load: (piece.force(self.time) - machine).value().abs(),
            static_level: held.abs(),
            grazing,
        })
    }
}

/// By which factor to change the length of a step with this error, in units of the tolerance.
fn change(error: f64) -> f64 {
    (0.9 * error.powf(-1.0 / (STAGES + 1) as f64)).clamp(0.1, 3.0)
}
