//! Passage of an event: the state after it, its shift with the inputs, and the direction that a contact at rest takes.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::Scalar;

use crate::bristle::field::Branch;
use crate::bristle::guards::Guard;
use crate::bristle::run::Run;
use crate::error::SimulationError;
use crate::mechanics::{Curve, Piece};
use crate::scenario::{Direction, Event, EventKind, Mode, State};

impl<D: Scalar, L: BristleLaw<D> + ?Sized> Run<'_, D, L> {
    /// Passes the end of the branch that `guard` has found.
    pub(super) fn arrive(&mut self, guard: Guard, piece: &Piece<D>, grazing: bool) -> Result<(), SimulationError> {
        self.field.rates(piece.force(self.time), self.branch, &self.step.begin, &mut self.before);
        match guard {
            Guard::Speed => {
                let velocity = self.step.begin[1];
                let speed = velocity - self.field.belt;
                let acceleration = self.before[1].value();
                let shift = -(speed - speed.value()) / acceleration;
                self.step.begin[1] = velocity - velocity.value() + self.field.belt.value();
                let before = self.branch.direction;
                let direction = self.departure(piece);
                self.go(direction);
                // A velocity that keeps its sign has only touched zero, and one that decays on the bristles never
                // reaches it.
                let grazing = grazing || direction == Some(before) || acceleration == 0.0;
                let kind = if direction.is_none() { EventKind::Stop } else { EventKind::Reversal };
                self.pass(kind, piece, shift, grazing)
            }
            Guard::Reserve(index) => {
                let shift = self.reserve_shift(index);
                self.branch.regime = self.branch.regime.sliding(index);
                self.field.begin(self.branch, &self.step.begin);
                self.collocation.forget();
                self.pass(EventKind::Yield(index), piece, shift, grazing)
            }
            Guard::Corner(component) => {
                let y = &mut self.step.begin[component];
                *y -= y.value();
                Ok(())
            }
            Guard::SpringCorner(range) => {
                if let Some(corner) = self.field.spring.end_towards(range) {
                    let position = &mut self.step.begin[0];
                    // The value is the corner to the last digit, whatever rounding makes of a sum.
                    *position = *position - position.value() + corner.position;
                }
                self.field.spring.range = range;
                self.collocation.forget();
                Ok(())
            }
        }
    }

    /// Goes over from the rates `self.before` an event to those after it: the event shifts by `shift`, whose value is
    /// 0, and with it the time from which on the new rates hold, y_θ⁺ = y_θ⁻ + (f⁻ − f⁺) t_θ.
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
                *y += (*before - *after) * shift;
            }
        }
        self.push(kind, piece, State { position: x, velocity }, shift, grazing)
    }

    /// Begins the present half cycle anew in the other direction, and corrects its event.
    pub(super) fn turn_at_once(&mut self) {
        let direction = Direction::of(-self.branch.direction.sign());
        self.branch = Branch { direction, regime: Regime::ALL_HOLD };
        self.field.release();
        self.field.begin(self.branch, &self.step.begin);
        self.field.spring.begin(self.step.begin[0], self.heading());
        self.recorder.trajectory.redirect(self.time, direction);
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
            self.field.reserve(index, self.branch, &self.after).map_or(0.0, Scalar::value)
        };
        let near = reserve(time) - reserve(-time);
        let far = reserve(2.0 * time) - reserve(-2.0 * time);
        let slope = (8.0 * near - far) / (12.0 * time);
        let Some(reserve) = self.field.reserve(index, self.branch, begin) else { return D::from(0.0) };
        if slope == 0.0 { D::from(0.0) } else { -(reserve - reserve.value()) / slope }
    }

    /// The direction in which the contact leaves relative rest; `None` if nothing drives it.
    ///
    /// It is the sign of the acceleration, or of the first derivative of the acceleration that is not zero within
    /// rounding. At u = 0 the bristles stand still, so that only the force and a moving counterface change the load.
    pub(super) fn departure(&mut self, piece: &Piece<D>) -> Option<Direction> {
        let begin = &self.step.begin;
        let force = piece.force(self.time);
        let branch = Branch { regime: Regime::ALL_HOLD, ..self.branch };
        self.field.rates(force, branch, begin, &mut self.after);
        let mass = self.field.oscillator.mass().value();
        let size = self.field.force_size(piece, self.time, branch, begin);
        let load = self.after[1].value() * mass;
        let rounding = 4.0 * f64::EPSILON * size;
        // A motion on the bristles below the digits of the position does not count, unless the pull exceeds what they
        // can hold.
        let unseen = 4.0 * f64::EPSILON * begin[0].value().abs() * self.stiffness * mass;
        if load.abs() > rounding {
            let mut is_beyond_bristles = || {
                let mut held = begin.clone();
                for (i, state) in held[2..].iter_mut().enumerate() {
                    *state = self.field.law.bound(i) * load.signum();
                }
                self.field.rates(force, branch, &held, &mut self.after);
                self.after[1].value() * load.signum() * mass > rounding
            };
            if load.abs() > rounding + unseen || is_beyond_bristles() {
                return Some(Direction::of(load));
            }
        }
        let oscillator = self.field.oscillator;
        let (slope, bend) = oscillator.restoring().slope(oscillator.stiffness(), begin[0]);
        let (slope, bend) = (slope.value(), bend.value());
        let belt = self.field.belt.value();
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

    /// True if the inputs with derivatives would set the resting contact in motion.
    pub(super) fn rest_has_derivatives(&mut self, piece: &Piece<D>) -> bool {
        let force = piece.force(self.time);
        self.field.rates(force, self.branch, &self.step.begin, &mut self.after);
        let [velocity, acceleration] = [self.after[0], self.after[1]];
        (0..D::DIRECTIONS).any(|i| velocity.partial(i) != 0.0 || acceleration.partial(i) != 0.0)
    }

    /// An event whose time has no derivatives.
    pub(super) fn push_here(
        &mut self,
        kind: EventKind,
        piece: &Piece<D>,
        grazing: bool,
    ) -> Result<(), SimulationError> {
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
        let machine = self.field.oscillator.damping_force(self.field.belt)
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
