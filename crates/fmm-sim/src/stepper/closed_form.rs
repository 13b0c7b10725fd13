//! One step of a linear machine under friction that is a level plus a slope: closed form from event to event.

use fmm_friction::Affine;
use fmm_model::{Oscillator, Scalar};

use crate::error::SimulationError;
use crate::scenario::{Direction, Mode, State};
use crate::stepper::response::{Linear, Response};
use crate::stepper::{Force, Stepped};

/// Greatest number of stretches of one step: a step of a million radians is no step of a controller.
const STRETCH_BUDGET: usize = 1_000_000;

/// Longest stretch (ω₀ τ, 1). Within less than half a period, π/ω_d, the acceleration of a linear machine under a force
/// that is a line passes zero at most once.
const STRETCH: f64 = 2.0;

/// Steps of the search for a zero, which is bracketed and needs five or so.
const ATTEMPTS: usize = 200;

/// A linear machine and its friction.
#[derive(Debug, Clone, Copy)]
pub(super) struct ClosedForm<D> {
    mass: D,
    stiffness: D,
    linear: Linear<D>,
    /// Friction of sliding in the limit of zero speed, and the static level (N).
    sliding: D,
    held: D,
    /// Longest stretch (s).
    longest: f64,
}

/// A stretch of the motion.
///
/// ```text
/// x = x₀ + v₀ τ + a₀ g₂ + j g₃,   v = v₀ + a₀ g₁ + j g₂,   x″ = a₀ g₁′ + j g₁,   j = f′/m − ω₀² v₀
/// ```
#[derive(Debug, Clone, Copy)]
struct Stretch<D> {
    begin: State<D>,
    /// a₀ (m/s²).
    acceleration: D,
    /// j (m/s³).
    jerk: D,
}

impl<D: Scalar> Stretch<D> {
    fn position(&self, elapsed: D, response: &Response<D>) -> D {
        let change = self.begin.velocity * elapsed + self.acceleration * response.step + self.jerk * response.ramp;
        self.begin.position + change
    }

    fn velocity(&self, response: &Response<D>) -> D {
        self.begin.velocity + (self.acceleration * response.impulse + self.jerk * response.step)
    }

    fn acceleration(&self, response: &Response<D>) -> D {
        self.acceleration * response.impulse_slope + self.jerk * response.impulse
    }

    /// The stretch without derivatives, mirrored for a motion in the negative `direction`.
    fn plain(&self, direction: Direction) -> Stretch<f64> {
        let along = |number: D| number.value() * direction.sign();
        let begin = State { position: along(self.begin.position), velocity: along(self.begin.velocity) };
        Stretch { begin, acceleration: along(self.acceleration), jerk: along(self.jerk) }
    }
}

impl Stretch<f64> {
    /// Time within `span` (s), shorter than half a period, at which a velocity that is positive, or begins to be, comes
    /// down to zero.
    fn rest(&self, machine: &Linear<f64>, span: f64) -> Option<f64> {
        let at = |elapsed: f64| {
            let response = machine.respond(elapsed);
            (self.velocity(&response), self.acceleration(&response))
        };
        let (velocity, acceleration) = at(span);
        let rises = self.acceleration > 0.0 || self.acceleration == 0.0 && self.jerk > 0.0;
        // The derivative of the acceleration is −2a x″ − ω₀² v + f′/m, and j = f′/m − ω₀² v₀.
        let turn = |from: f64, to: f64, sign: f64| {
            zero(from, to, |elapsed| {
                let (velocity, acceleration) = at(elapsed);
                let change = self.jerk - machine.square * (velocity - self.begin.velocity);
                (acceleration * sign, (change - machine.damping * acceleration) * sign)
            })
        };
        let is_still = self.begin.velocity == 0.0 && self.acceleration == 0.0 && self.jerk == 0.0;
        if is_still {
            return None;
        }
        if velocity <= 0.0 {
            let from = if rises { turn(0.0, span, 1.0) } else { 0.0 };
            return Some(zero(from, span, at));
        }
        if rises || acceleration <= 0.0 {
            return None;
        }
        // It slows down and gains speed again: what counts is the least velocity.
        let slowest = turn(0.0, span, -1.0);
        (at(slowest).0 <= 0.0).then(|| zero(0.0, slowest, at))
    }
}

/// The zero of a function that falls from a positive value at `from` to one that is not positive at `to`, passing zero
/// once; `at` gives value and slope. Newton's method within a bracket, which is halved where a step leaves it.
fn zero(mut from: f64, mut to: f64, at: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut here = to;
    for _ in 0..ATTEMPTS {
        let (value, slope) = at(here);
        if value > 0.0 {
            from = here;
        } else {
            to = here;
        }
        let newton = here - value / slope;
        let next = if newton > from && newton < to { newton } else { from + 0.5 * (to - from) };
        let is_there = (next - here).abs() <= 4.0 * f64::EPSILON * here || value == 0.0;
        if is_there || !(next > from && next < to) {
            break;
        }
        here = next;
    }
    to.min(here.max(from))
}

impl<D: Scalar> ClosedForm<D> {
    pub(super) fn new(oscillator: &Oscillator<D>, friction: Affine<D>, normal_load: D) -> Self {
        let (mass, stiffness) = (oscillator.mass(), oscillator.stiffness());
        let damping = (oscillator.damping().linear_coefficient() + normal_load * friction.slope) / mass;
        let square = stiffness / mass;
        Self {
            mass,
            stiffness,
            linear: Linear { damping, square },
            sliding: normal_load * friction.level,
            held: normal_load * friction.breakaway,
            longest: STRETCH / square.value().sqrt(),
        }
    }

    /// The mode in which a contact goes on from `state` under a `force` (N) of this `slope` (N/s): like that of the
    /// engines, without a dead zone, with a closed set of loads that stick.
    fn mode(&self, state: State<D>, force: D, slope: D) -> Mode {
        if state.velocity.value() != 0.0 {
            return Mode::Slip(Direction::of(state.velocity.value()));
        }
        let (load, held) = (self.load(state, force).value(), self.held.value());
        let direction = Direction::of(if load == 0.0 { slope.value() } else { load });
        let grows = slope.value() * direction.sign() > 0.0;
        // Nothing holds a contact without friction, in its derivatives neither.
        let slips = load.abs() > held || load.abs() == held && grows || held == 0.0;
        if slips { Mode::Slip(direction) } else { Mode::Stick }
    }

    /// Load on a contact at rest (N).
    fn load(&self, state: State<D>, force: D) -> D {
        force - self.stiffness * state.position
    }

    /// The state after one step of `duration` (s) from `state`.
    pub(super) fn step(&self, state: State<D>, force: Force<D>, duration: f64) -> Result<Stepped<D>, SimulationError> {
        let slope = force.slope(duration);
        let (mut state, mut time, mut events) = (state, D::from(0.0), 0);
        let mut mode = self.mode(state, force.begin, slope);
        let mut broken_away = false;
        for _ in 0..STRETCH_BUDGET {
            let left = -time + duration;
            let now = force.begin + slope * time;
            let (after, next, elapsed) = match mode.direction() {
                Some(direction) => {
                    // What is left of the load at a breakaway is exactly what the static level is above the other:
                    // rounding must not stop the motion again.
                    let excess = (self.held - self.sliding) * direction.sign();
                    let drive =
                        if broken_away { excess } else { self.load(state, now) - self.sliding * direction.sign() };
                    self.slide(direction, state, drive, (now, slope), left)
                }
                None => self.hold(state, (now, slope), left),
            };
            (state, time) = (after, time + elapsed);
            if !(state.position.value().is_finite() && state.velocity.value().is_finite()) {
                return Err(SimulationError::NotFinite { time: time.value() });
            }
            events += usize::from(next.is_some());
            broken_away = mode == Mode::Stick && next.is_some();
            mode = next.unwrap_or_else(|| self.mode(state, force.begin + slope * time, slope));
            if time.value() >= duration {
                return Ok(Stepped { state, mode, events });
            }
        }
        Err(SimulationError::step_budget(STRETCH_BUDGET, duration))
    }

    /// A contact that holds until it breaks away or `left` (s) is over.
    fn hold(&self, state: State<D>, (force, slope): (D, D), left: D) -> (State<D>, Option<Mode>, D) {
        let state = State { velocity: D::from(0.0), ..state };
        let direction = Direction::of(slope.value());
        let reserve = self.held * direction.sign() - self.load(state, force);
        if slope.value() == 0.0 || !(reserve.value() / slope.value() < left.value()) {
            return (state, None, left);
        }
        (state, Some(Mode::Slip(direction)), reserve / slope)
    }

    /// A contact that slides in `direction`, begun under a `drive` (N), until it comes to rest or `left` (s) is over, but not longer than a stretch.
    fn slide(
        &self,
        direction: Direction,
        state: State<D>,
        drive: D,
        (force, slope): (D, D),
        left: D,
    ) -> (State<D>, Option<Mode>, D) {
        let stretch = Stretch {
            begin: state,
            acceleration: drive / self.mass - self.linear.damping * state.velocity,
            jerk: slope / self.mass - self.linear.square * state.velocity,
        };
        let span = if left.value() > self.longest { D::from(self.longest) } else { left };
        let Some(rest) = stretch.plain(direction).rest(&self.linear.plain(), span.value()) else {
            let response = self.linear.respond(span);
            let state = State { position: stretch.position(span, &response), velocity: stretch.velocity(&response) };
            return (state, None, span);
        };
        let response = self.linear.respond(D::from(rest));
        let mut elapsed = D::from(rest);
        if D::DIRECTIONS > 0 {
            let velocity = stretch.velocity(&response);
            let rate = stretch.acceleration(&response).value();
            // Where it is that small, rounding moves the zero further than it is from the turning point.
            let size = stretch.begin.velocity.value().abs() + stretch.acceleration.value().abs() * rest;
            let bend = stretch.jerk.value().abs() + self.linear.damping.value().abs() * rate.abs();
            if rate * rate > 4.0 * f64::EPSILON * size * bend {
                elapsed = -(velocity - velocity.value()) / rate + rest;
            }
        }
        // Its own rate of change there is zero, so that the derivatives of the time do not move the place.
        let position = stretch.position(D::from(rest), &response);
        let state = State { position, velocity: D::from(0.0) };
        (state, Some(self.mode(state, force + slope * elapsed, slope)), elapsed)
    }
}
