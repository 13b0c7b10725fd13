//! The equation of motion on one smooth piece of a law, its guards and the progress along it.

use fmm_friction::SlidingLaw;
use fmm_model::{Oscillator, Scalar};

use crate::automaton::{Branch, Phase};
use crate::mechanics::{Forcing, ROUNDING, Spring, load, normal_load, rounding};
use crate::scenario::{LoadOverPosition, Scenario, State};
use crate::trajectory::Power;

/// A side of the capture speed, at which the law may jump.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Below,
    /// The contact is caught once the speed is down at it again.
    Above,
}

/// A quantity that is positive before an end of a smooth part of sliding, and zero at the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Guard {
    /// The contact is caught, at relative rest unless the law has a dead zone.
    Rest,
    /// The acceleration reaches zero.
    Steady,
    /// The speed exceeds that at which the contact would be caught. This is no event, but the law may jump.
    Escape,
}

impl Guard {
    /// The guards of a phase on one side of the capture speed, if the law `captures`.
    pub(super) fn of<D>(phase: &Phase<D>, side: Side, captures: bool) -> impl Iterator<Item = Self> + use<D> {
        let (branch, escapes) = (phase.branch, captures && side == Side::Below);
        [Self::Rest, Self::Steady, Self::Escape].into_iter().filter(move |guard| match guard {
            Self::Rest => branch != Branch::Gaining,
            Self::Steady => branch != Branch::Only,
            Self::Escape => escapes,
        })
    }

    /// Sign with which velocity, or acceleration, makes the guard.
    pub(super) fn sign<D>(self, phase: &Phase<D>) -> f64 {
        let along = phase.direction.sign();
        match self {
            Self::Steady if phase.branch == Branch::Losing => -along,
            Self::Rest | Self::Steady => along,
            Self::Escape => -along,
        }
    }
}

/// The state at a time that is a plain number, with the side of the capture speed.
#[derive(Clone, Copy)]
pub(super) struct Progress<D> {
    pub(super) time: f64,
    pub(super) state: State<D>,
    pub(super) acceleration: D,
    pub(super) side: Side,
}

/// The right-hand side of the equation of motion.
pub(super) struct Field<'a, D, L: ?Sized> {
    pub(super) oscillator: &'a Oscillator<D>,
    /// The spring on the side of its corners on which the step is.
    pub(super) spring: Spring<'a, D>,
    law: &'a L,
    normal_load: D,
    /// True if the normal load varies in time.
    load_varies: bool,
    load_over_position: LoadOverPosition<D>,
    pub(super) belt: D,
    /// 1/m.
    pub(super) per_mass: D,
    /// The damping coefficient, if damping is linear.
    linear_damping: Option<D>,
    /// True if any force acts from outside.
    pub(super) is_driven: bool,
    /// The speed at which the contact is caught (m/s), if there is one.
    pub(super) capture: Option<D>,
}

/// External actions on the machine at one time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Outside<D> {
    /// Force (N), if there is any.
    force: Option<D>,
    /// Normal load in the force-free position (N).
    normal_load: D,
}

impl<'a, D: Scalar, L: SlidingLaw<D> + ?Sized> Field<'a, D, L> {
    pub(super) fn new(scenario: &'a Scenario<D, L>, drive: &Forcing<D>) -> Self {
        let oscillator = scenario.oscillator();
        let capture = scenario.law().capture_speed();
        Self {
            oscillator,
            spring: Spring::new(oscillator),
            law: scenario.law(),
            normal_load: scenario.normal_load(),
            load_varies: scenario.sampled_load().is_some(),
            load_over_position: scenario.load_over_position(),
            belt: drive.belt(),
            per_mass: D::from(1.0) / oscillator.mass(),
            linear_damping: oscillator.damping().is_linear().then(|| oscillator.damping().linear_coefficient()),
            is_driven: !scenario.excitations().is_empty(),
            capture: (capture.value() > 0.0).then_some(capture),
        }
    }

    /// The sliding speed of a contact with this `velocity` in the direction of `phase`.
    #[inline]
    pub(super) fn speed(&self, phase: &Phase<D>, velocity: D) -> D {
        (velocity - self.belt) * phase.direction.sign()
    }

    /// The speed above the capture speed; for an escape the speed below it.
    pub(super) fn spare_speed(&self, phase: &Phase<D>, side: Side, velocity: D, guard: Guard) -> D {
        let speed = self.speed(phase, velocity);
        match (self.capture, guard) {
            (Some(capture), Guard::Escape) => capture - speed,
            (Some(capture), _) if side == Side::Above => speed - capture,
            _ => speed,
        }
    }

    /// The side of the capture speed on which a phase begins.
    pub(super) fn first_side(&self, phase: &Phase<D>) -> Side {
        let speed = self.speed(phase, phase.state.velocity).value();
        match self.capture {
            Some(capture) if speed > capture.value() => Side::Above,
            Some(capture) if speed == capture.value() => {
                let below = self.acceleration(phase, Side::Below, phase.time.value(), phase.state);
                if below.value() * phase.direction.sign() > 0.0 { Side::Above } else { Side::Below }
            }
            _ => Side::Below,
        }
    }

    /// External actions at `time`.
    #[inline]
    pub(super) fn outside(&self, phase: &Phase<D>, time: D) -> Outside<D> {
        let force = self.is_driven.then(|| phase.piece.force_at(time));
        let normal_load = if self.load_varies { phase.piece.normal_load(time).0 } else { self.normal_load };
        Outside { force, normal_load }
    }

    /// Growth of friction in time (N/s) at constant velocity from `state` on, along the positive direction.
    pub(super) fn friction_slope(&self, phase: &Phase<D>, side: Side, state: State<D>) -> D {
        let slope = normal_load(phase.piece, self.load_over_position, phase.time, state).1;
        self.coefficient(phase, side, self.speed(phase, state.velocity)) * slope * phase.direction.sign()
    }

    /// Friction (N) in `state` at a sliding `speed`, along the positive direction.
    #[inline]
    fn friction(&self, phase: &Phase<D>, side: Side, outside: Outside<D>, state: State<D>, speed: D) -> D {
        let friction = outside.normal_load * self.coefficient(phase, side, speed) * phase.direction.sign();
        if self.load_over_position.is_constant() {
            friction
        } else {
            friction * self.load_over_position.factor(state.position)
        }
    }

    /// Friction coefficient at a sliding `speed`, along the direction of `phase`.
    ///
    /// Stages may look past the end of a piece of the law: its curve is turned about its end, which keeps the slope.
    #[inline]
    fn coefficient(&self, phase: &Phase<D>, side: Side, speed: D) -> D {
        let at = |speed| match phase.branch {
            Branch::Losing => self.law.coefficient_losing_speed(speed),
            Branch::Only | Branch::Gaining => self.law.coefficient(speed),
        };
        let beyond = |end: D| at(end) * 2.0 - at(end * 2.0 - speed);
        match (self.capture, side) {
            (Some(capture), Side::Below) if speed.value() > capture.value() => beyond(capture),
            (Some(capture), Side::Above) if speed.value() <= capture.value() => {
                beyond(capture + (capture.value().next_up() - capture.value()))
            }
            // A law knows no negative speed.
            _ if speed.value() < 0.0 => at(D::from(0.0)) * 2.0 - at(-speed),
            _ => at(speed),
        }
    }

    /// The acceleration at `speed`, which is that of `state`.
    #[inline]
    pub(super) fn balance(&self, phase: &Phase<D>, side: Side, outside: Outside<D>, state: State<D>, speed: D) -> D {
        // The other forms cost as much as everything else here together.
        let damping = match self.linear_damping {
            Some(coefficient) => state.velocity * coefficient,
            None => self.oscillator.damping_force(state.velocity),
        };
        let friction = self.friction(phase, side, outside, state, speed);
        let mut sum = -friction - damping - self.spring.force(state.position);
        if let Some(force) = outside.force {
            sum += force;
        }
        sum * self.per_mass
    }

    #[inline]
    pub(super) fn acceleration(&self, phase: &Phase<D>, side: Side, time: f64, state: State<D>) -> D {
        let outside = self.outside(phase, D::from(time));
        self.balance(phase, side, outside, state, self.speed(phase, state.velocity))
    }

    /// Rounding of an acceleration (m/s²). A smaller one counts as zero; otherwise a motion that tends to a constant
    /// speed would change its branch for ever.
    pub(super) fn noise(&self, phase: &Phase<D>, side: Side, state: State<D>) -> f64 {
        let load = load(self.oscillator, phase.piece, phase.time, state);
        let speed = self.speed(phase, state.velocity);
        let friction = self.friction(phase, side, self.outside(phase, phase.time), state, speed).value().abs();
        (rounding(self.oscillator, &load, phase.time, state) + ROUNDING * friction) * self.per_mass.value()
    }

    /// Power of friction, damping and the external forces at `time` (W).
    pub(super) fn power(&self, phase: &Phase<D>, side: Side, time: f64, state: State<D>) -> Power<D> {
        let speed = self.speed(phase, state.velocity);
        let friction = self.friction(phase, side, self.outside(phase, D::from(time)), state, speed);
        let damping = self.oscillator.damping_force(state.velocity);
        Power::of(friction, damping, phase.piece.force(time), state.velocity, self.belt)
    }
}
