//! The stick-slip automaton of all engines of sliding laws: modes, guards and transitions.

use fmm_model::{Oscillator, Restoring, Scalar};

use crate::error::SimulationError;
use crate::mechanics::{
    Curve, Forcing, Levels, Piece, SEARCH_BUDGET, SteadyReserve, crossing, first_zero, holds_for_good, load,
    normal_load, rounding,
};
use crate::scenario::{Direction, Event, EventKind, LoadOverPosition, Mode, Scenario, State};
use crate::trajectory::{Power, Recorder};

/// Tolerance of the load at which the acceleration vanishes, relative to the friction force.
const ON_BOUND: f64 = 1e-9;

/// Branch of the law of a sliding contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Branch {
    Only,
    Gaining,
    Losing,
}

/// A stretch of sliding in one direction on one branch, under one piece of the force.
pub(crate) struct Phase<'p, D> {
    /// Start (s), with derivatives if an event began the phase.
    pub(crate) time: D,
    pub(crate) state: State<D>,
    pub(crate) direction: Direction,
    pub(crate) branch: Branch,
    pub(crate) piece: &'p Piece<D>,
    /// Latest end (s).
    pub(crate) limit: f64,
    /// True if the limit is the end of the simulation; samples at the limit then belong to the phase.
    pub(crate) last: bool,
}

impl<D: Scalar> Phase<'_, D> {
    /// The end of the samples that belong to the phase if nothing ends it before its limit.
    pub(crate) fn samples_end(&self) -> f64 {
        if self.last { f64::INFINITY } else { self.limit }
    }
}

/// Reason why a phase of sliding ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Its limit was reached.
    Limit,
    /// The velocity of the counterface was reached.
    RelativeRest,
    /// The acceleration reached zero; only on a branch of a law that depends on it.
    SteadySpeed,
}

/// End of a phase of sliding.
pub(crate) struct Ended<D> {
    pub(crate) ending: Ending,
    pub(crate) time: D,
    pub(crate) state: State<D>,
    pub(crate) grazing: bool,
}

/// Task of an engine in the automaton: follow one phase of sliding, and write its samples and its work.
pub(crate) trait Slide<D> {
    fn slide(&mut self, phase: &Phase<D>, recorder: &mut Recorder<D>) -> Result<Ended<D>, SimulationError>;
}

/// Machine and contact as the automaton sees them.
pub(crate) struct Contact<'a, D, V> {
    pub(crate) oscillator: &'a Oscillator<D>,
    pub(crate) levels: V,
    pub(crate) belt: D,
    load_over_position: LoadOverPosition<D>,
    budget: usize,
}

impl<'a, D: Scalar, V: Levels<D>> Contact<'a, D, V> {
    pub(crate) fn new<L: ?Sized>(
        scenario: &'a Scenario<D, L>,
        levels: V,
        drive: &Forcing<D>,
    ) -> Result<Self, SimulationError> {
        let most = scenario.largest_load() * levels.breakaway();
        if !most.value().is_finite() {
            return Err(SimulationError::NotFinite { time: 0.0 });
        }
        let load_over_position = scenario.load_over_position();
        if !load_over_position.is_constant() && (levels.has_branches() || drive.has_belt()) {
            let what = "a normal load over the position beside a moving counterface or a law of two branches";
            return Err(SimulationError::NotSupported { engine: "runge_kutta", what });
        }
        let oscillator = scenario.oscillator();
        Ok(Self { oscillator, levels, belt: drive.belt(), load_over_position, budget: SEARCH_BUDGET })
    }

    fn load(&self, piece: &Piece<D>, time: D, position: D, velocity: D) -> Curve<'static, D> {
        load(self.oscillator, piece, time, State { position, velocity })
    }

    /// True for a spring whose force at constant speed is neither a line nor a wave in time.
    fn has_bent_spring(&self) -> bool {
        !matches!(self.oscillator.restoring(), Restoring::Linear | Restoring::Sine { .. })
    }

    /// The load on a contact that has gone on at the velocity of `phase` for `elapsed` (s), counted from then.
    fn load_after(&self, phase: &Phase<D>, elapsed: f64) -> Curve<'static, D> {
        let time = D::from(phase.time.value() + elapsed);
        let State { position, velocity } = phase.state;
        self.load(phase.piece, time, position + velocity * (time - phase.time), velocity)
    }

    /// Normal load (N) at `time` in `state`, and its slope at constant velocity (N/s).
    fn normal_load(&self, piece: &Piece<D>, time: D, state: State<D>) -> (D, D) {
        normal_load(piece, self.load_over_position, time, state)
    }

    /// Static friction force (N) at `time` in `state`, and its slope (N/s).
    fn static_force(&self, piece: &Piece<D>, time: D, state: State<D>) -> (D, D) {
        let (load, slope) = self.normal_load(piece, time, state);
        (load * self.levels.breakaway(), slope * self.levels.breakaway())
    }

    /// Load on a contact at zero relative velocity (N), its rate of change (N/s), and the rounding that it carries (N).
    fn resting_load(&self, piece: &Piece<D>, time: D, state: State<D>) -> (f64, f64, f64) {
        // Under a constant force, the usual case, neither damping nor time enters.
        let is_steady = piece.is_constant() && self.belt.value() == 0.0;
        if is_steady && matches!(self.oscillator.restoring(), Restoring::Linear) {
            let spring = self.oscillator.stiffness().value() * state.position.value();
            return (piece.line(time).0.value() - spring, 0.0, 0.0);
        }
        let load = self.load(piece, time, state.position, self.belt);
        let rounding = if load.is_plainly_free() { 0.0 } else { rounding(self.oscillator, &load, time, state) };
        (load.now().value(), load.slope_now().value(), rounding)
    }

    /// The mode in which a contact goes on from `state`, the automaton's only decision; and the load at zero relative
    /// velocity.
    fn mode(&self, piece: &Piece<D>, time: D, state: State<D>) -> (Mode, f64) {
        let (load, rate, rounding) = self.resting_load(piece, time, state);
        let relative = state.velocity.value() - self.belt.value();
        if relative != 0.0 {
            let direction = Direction::of(relative);
            if !self.levels.has_branches() {
                return (Mode::Slip(direction), load);
            }
            let moving = self.load(piece, time, state.position, state.velocity);
            let drive = moving.now().value() * direction.sign();
            let (gaining, losing) = self.branch_forces(self.normal_load(piece, time, state).0, D::from(relative.abs()));
            let mode = if drive > gaining.value() {
                Mode::Gaining(direction)
            } else if drive < losing.value() {
                Mode::Losing(direction)
            } else {
                Mode::Steady(direction)
            };
            return (mode, load);
        }
        let (held, held_slope) = self.static_force(piece, time, state);
        let (held, held_slope) = (held.value(), held_slope.value());
        // Within rounding of the level, the rate of change of the load decides.
        let direction = Direction::of(if load.abs() <= rounding { rate } else { load });
        let growing = rate * direction.sign() > held_slope;
        let slips = if (load.abs() - held).abs() <= rounding {
            growing
        } else {
            growing && load.abs() >= held
                || load.abs() > held && self.is_ahead(load, self.normal_load(piece, time, state).0, state, direction)
        };
        (if slips { self.sliding(direction) } else { Mode::Stick }, load)
    }

    /// True if the position in which friction balances the `load` (N) lies ahead. Beyond the static level it does, as
    /// the sliding level is not higher; if rounding contradicts, nothing moves.
    fn is_ahead(&self, load: f64, normal_load: D, state: State<D>, direction: Direction) -> bool {
        let sliding = (self.levels.gaining(D::from(0.0)) * normal_load).value();
        match self.oscillator.restoring() {
            Restoring::Linear if self.oscillator.stiffness().value() > 0.0 => {
                let (stiffness, position) = (self.oscillator.stiffness().value(), state.position.value());
                let outside = load + stiffness * position;
                ((outside - sliding * direction.sign()) / stiffness - position) * direction.sign() > 0.0
            }
            _ => load.abs() > sliding,
        }
    }

    /// The mode of a contact that begins to slide.
    fn sliding(&self, direction: Direction) -> Mode {
        if self.levels.has_branches() { Mode::Gaining(direction) } else { Mode::Slip(direction) }
    }

    /// Friction forces at `speed` while it grows and while it falls.
    fn branch_forces(&self, normal_load: D, speed: D) -> (D, D) {
        (self.levels.gaining(speed) * normal_load, self.levels.losing(speed) * normal_load)
    }

    /// The event at `time`, with the `balance` of load and static level (N) there.
    fn event(kind: EventKind, time: D, state: State<D>, next: Mode, balance: (f64, D), grazing: bool) -> Event<D> {
        Event {
            kind,
            time,
            position: state.position,
            velocity: state.velocity,
            next,
            load: balance.0.abs(),
            static_level: balance.1.value(),
            grazing,
        }
    }

    /// Runs the automaton from the scenario's initial state to the last sample.
    pub(crate) fn run<S: Slide<D>>(
        mut self,
        initial: State<D>,
        drive: &Forcing<D>,
        slide: &mut S,
        recorder: &mut Recorder<D>,
    ) -> Result<(), SimulationError> {
        let (mut index, mut piece) = (0, drive.piece(0));
        let (mut time, mut state) = (D::from(0.0), initial);
        let (mut mode, load) = self.mode(&piece, time, state);
        let balance = (load, self.static_force(&piece, time, state).0);
        recorder.push(Self::event(EventKind::Start, time, state, mode, balance, false))?;
        self.push(mode, drive, index, &mut state);
        let end = recorder.sampling.end();
        loop {
            let (limit, last) = (piece.end.min(end), piece.end > end);
            let branch = match mode {
                Mode::Gaining(_) => Branch::Gaining,
                Mode::Losing(_) => Branch::Losing,
                _ => Branch::Only,
            };
            let direction = mode.direction().unwrap_or(Direction::Positive);
            let phase = Phase { time, state, direction, branch, piece: &piece, limit, last };
            // One call for all sliding, which is inlined: it takes most of the time of a ring-down.
            let (ended, next) = match mode {
                Mode::Stick => self.hold(&phase, None, recorder)?,
                Mode::Steady(direction) => self.hold(&phase, Some(direction), recorder)?,
                _ => (slide.slide(&phase, recorder)?, mode),
            };
            (time, state) = (ended.time, ended.state);
            let (kind, next, load) = match ended.ending {
                Ending::Limit if last => {
                    let over_position = self.load_over_position.factor(state.position).value();
                    let breakaway = self.levels.breakaway().value() * over_position;
                    let rests =
                        mode == Mode::Stick && holds_for_good(self.oscillator, drive, index, time, state, breakaway);
                    recorder.trajectory.rests = rests;
                    return Ok(());
                }
                Ending::Limit => {
                    index += 1;
                    let before = std::mem::replace(&mut piece, drive.piece(index));
                    self.push(mode, drive, index, &mut state);
                    let Some((next, load)) = self.after_jump(mode, &before, &piece, time, state) else { continue };
                    if let Some(late) = drive.time_of_jump(index).filter(|_| mode == Mode::Stick) {
                        // A jump breaks the contact away at the time of the jump, at any level.
                        time = late + piece.start;
                        state.position += state.velocity * late;
                    }
                    let kind = match (mode, next) {
                        (Mode::Stick, _) => EventKind::Breakaway,
                        (_, Mode::Stick) => EventKind::Stop,
                        _ => EventKind::BranchChange,
                    };
                    (kind, next, load)
                }
                Ending::RelativeRest if mode == Mode::Stick => {
                    let load = self.load(&piece, time, state.position, state.velocity).now().value();
                    (EventKind::Breakaway, next, load)
                }
                // A speed of zero is not constant: such a branch ends like one that reaches rest.
                ending @ (Ending::RelativeRest | Ending::SteadySpeed)
                    if ending == Ending::RelativeRest || self.has_no_speed(mode, state) =>
                {
                    recorder.catch(self.oscillator.mass(), state.velocity - self.belt, self.belt);
                    state.velocity = self.belt;
                    let (next, load) = self.mode(&piece, time, state);
                    (if next == Mode::Stick { EventKind::Stop } else { EventKind::Reversal }, next, load)
                }
                Ending::RelativeRest | Ending::SteadySpeed => {
                    let next = if matches!(mode, Mode::Steady(_)) {
                        next
                    } else {
                        self.after_branch(mode, &piece, time, state)
                    };
                    let load = self.load(&piece, time, state.position, state.velocity).now().value();
                    (EventKind::BranchChange, next, load)
                }
            };
            mode = next;
            let balance = (load, self.static_force(&piece, time, state).0);
            recorder.push(Self::event(kind, time, state, mode, balance, ended.grazing))?;
        }
    }

    /// Adds the impulse of a force that jumps at the beginning of the piece of this `index`, at a time with
    /// derivatives, to a body that slides.
    fn push(&self, mode: Mode, drive: &Forcing<D>, index: usize, state: &mut State<D>) {
        if matches!(mode, Mode::Slip(_) | Mode::Gaining(_) | Mode::Losing(_)) {
            state.velocity += drive.impulse_of_jumps(index) / self.oscillator.mass();
        }
    }

    /// Next mode of a contact when the force jumps from one piece to the next: a contact that holds
    /// may slide at once, and the branch of one that slides may no longer agree with its acceleration.
    ///
    /// The time of the jump alone decides the time of the change; no level enters it.
    fn after_jump(
        &self,
        mode: Mode,
        before: &Piece<D>,
        piece: &Piece<D>,
        time: D,
        state: State<D>,
    ) -> Option<(Mode, f64)> {
        if mode != Mode::Stick && !self.levels.has_branches() {
            return None;
        }
        let load = self.load(piece, time, state.position, state.velocity);
        let jump = piece.force(time.value()).value() - before.force(time.value()).value();
        if jump.abs() <= rounding(self.oscillator, &load, time, state) {
            return None;
        }
        let Some(direction) = mode.direction() else {
            return Some(self.mode(piece, time, state)).filter(|(next, _)| *next != Mode::Stick);
        };
        let drive = load.now().value() * direction.sign();
        let (gaining, losing) =
            self.branch_forces(self.normal_load(piece, time, state).0, (state.velocity - self.belt).abs());
        let agrees = match mode {
            Mode::Gaining(_) => drive >= gaining.value(),
            Mode::Losing(_) => drive <= losing.value(),
            _ => (losing.value()..=gaining.value()).contains(&drive),
        };
        (!agrees).then(|| self.mode(piece, time, state))
    }

    /// True if a contact that slides in `mode` has lost its speed, or has passed zero by rounding.
    fn has_no_speed(&self, mode: Mode, state: State<D>) -> bool {
        let relative = (state.velocity - self.belt).value();
        mode.direction().is_some_and(|direction| relative * direction.sign() <= 0.0)
    }

    /// Next mode of a contact whose acceleration has become zero on a branch.
    fn after_branch(&self, mode: Mode, piece: &Piece<D>, time: D, state: State<D>) -> Mode {
        let (gaining, losing) =
            self.branch_forces(self.normal_load(piece, time, state).0, (state.velocity - self.belt).abs());
        match mode {
            // Between the levels nothing but a constant speed is consistent.
            Mode::Gaining(direction) | Mode::Losing(direction) if gaining.value() >= losing.value() => {
                Mode::Steady(direction)
            }
            Mode::Gaining(direction) => Mode::Losing(direction),
            Mode::Losing(direction) => Mode::Gaining(direction),
            other => other,
        }
    }

    /// A phase of constant velocity: the contact sticks, or it slides steadily in direction `steady`. Friction balances
    /// the load until the load leaves the range of the levels.
    fn hold(
        &mut self,
        phase: &Phase<D>,
        steady: Option<Direction>,
        recorder: &mut Recorder<D>,
    ) -> Result<(Ended<D>, Mode), SimulationError> {
        let State { position, velocity } = phase.state;
        let load = self.load(phase.piece, phase.time, position, velocity);
        let is_bent = steady.is_some() && self.has_bent_spring();
        // Friction over the normal load lies between −below and above along the positive direction.
        let (above, below) = match steady {
            None => (self.levels.breakaway(), self.levels.breakaway()),
            Some(direction) => {
                let speed = (velocity - self.belt).abs();
                let (gaining, losing) = (self.levels.gaining(speed), self.levels.losing(speed));
                match direction {
                    Direction::Positive => (gaining, -losing),
                    Direction::Negative => (-losing, gaining),
                }
            }
        };
        let (normal_load, load_slope) = self.normal_load(phase.piece, phase.time, phase.state);
        let begin = phase.time.value();
        let mut leaving: Option<(f64, (D, D), f64)> = None;
        let span = phase.limit - begin;
        let plain = load.plain_without_decay();
        let reach = plain.slope.abs() * span + plain.waves.iter().map(|w| w.cosine.hypot(w.sine)).sum::<f64>();
        let now = plain.at(0.0);
        for (level, sign) in [(above, 1.0), (below, -1.0)] {
            let (bound, bound_slope) = (normal_load * level, load_slope * level);
            let excess = sign * now - bound.value();
            // A contact that has been found to hold does so although rounding may put the load beyond the level; a
            // steady phase begins on a bound, as exactly as the engine has found it.
            let slack = excess > 0.0 && (steady.is_none() || excess <= ON_BOUND * bound.value().abs());
            let bound = if slack { bound + excess } else { bound };
            if is_bent {
                let last = leaving.map_or(span, |(elapsed, ..)| elapsed);
                let reserve = SteadyReserve {
                    oscillator: self.oscillator,
                    piece: phase.piece,
                    time: begin,
                    state: State { position: position.value(), velocity: velocity.value() },
                    level: (bound.value(), bound_slope.value()),
                    sign,
                };
                if let Some(elapsed) = reserve.first_zero(last, &mut self.budget)? {
                    leaving = Some((elapsed, (bound, bound_slope), sign));
                }
                continue;
            }
            // A level out of reach need not be searched for.
            let reach = reach + bound_slope.value().abs() * span;
            if bound.value() - sign * plain.constant > reach && span.is_finite() {
                continue;
            }
            let mut reserve = plain.clone().scaled(-sign, bound.value());
            reserve.slope += bound_slope.value();
            let span = leaving.map_or(span, |(elapsed, ..)| elapsed);
            if let Some(elapsed) = first_zero(&reserve, span, &mut self.budget)? {
                leaving = Some((elapsed, (bound, bound_slope), sign));
            }
        }
        let stop = leaving.map_or(phase.samples_end(), |(elapsed, ..)| begin + elapsed);
        let at = |time: D| position + velocity * (time - phase.time);
        let still = velocity.value() == 0.0 && (0..D::DIRECTIONS).all(|direction| velocity.partial(direction) == 0.0);
        if still {
            recorder.hold(stop, position);
        } else {
            recorder.constant_velocity(stop, velocity, |time| at(D::from(time)))?;
        }
        let damping = self.oscillator.damping_force(velocity);
        let end = stop.min(phase.limit);
        let power = |time: f64| {
            let friction =
                if is_bent { self.load_after(phase, time - begin).now() } else { load.at(-phase.time + time) };
            Power::of(friction, damping, phase.piece.force(time), velocity, self.belt)
        };
        // Power is smooth between corners of the spring.
        let mut from = begin;
        for side in [-1.0, 1.0] {
            let Some(corner) = self.oscillator.restoring().corner().filter(|_| is_bent) else { break };
            let corner = corner.value() * side * velocity.value().signum();
            let to = (begin + (corner - position.value()) / velocity.value()).clamp(from, end.max(from));
            recorder.work(from, to, scale(&load), power)?;
            from = to;
        }
        recorder.work(from, end, scale(&load), power)?;
        let Some((elapsed, (bound, bound_slope), sign)) = leaving else {
            let time = D::from(phase.limit);
            let state = State { position: at(time), velocity };
            return Ok((Ended { ending: Ending::Limit, time, state, grazing: false }, Mode::Stick));
        };
        let (load, start) =
            if is_bent { (self.load_after(phase, elapsed), D::from(begin + elapsed)) } else { (load, phase.time) };
        let mut reserve = load.scaled(D::from(-sign), bound + bound_slope * (start - phase.time));
        reserve.slope += bound_slope;
        let (time, grazing) = crossing(&reserve, start, begin + elapsed);
        let state = State { position: at(time), velocity };
        let direction = if sign > 0.0 { Direction::Positive } else { Direction::Negative };
        let (ending, next) = match steady {
            None => (Ending::RelativeRest, self.sliding(direction)),
            Some(along) if along == direction => (Ending::SteadySpeed, Mode::Gaining(along)),
            Some(along) => (Ending::SteadySpeed, Mode::Losing(along)),
        };
        Ok((Ended { ending, time, state, grazing }, next))
    }
}

/// A time (s) within which a curve with these waves varies little.
fn scale<D: Scalar>(curve: &Curve<D>) -> f64 {
    curve.frequencies().map(f64::recip).fold(f64::MAX, f64::min)
}
