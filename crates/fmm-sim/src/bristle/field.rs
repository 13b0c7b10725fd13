//! The equations of motion of one swing: the oscillator, the bristles, and their Jacobian.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::{Oscillator, Scalar};

use crate::Direction;
use crate::spring::Spring;

/// On which smooth branch of the law the contact moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Branch {
    pub(super) direction: Direction,
    pub(super) regime: Regime,
}

/// Steps of the differences of the Jacobian, relative to the arguments; about √ε, as the Jacobian only has to make
/// Newton's method converge.
const DIFFERENCE: f64 = 1e-7;

/// The part of its bound within which a state is near zero.
const NEAR_ZERO: f64 = 1e-4;

/// Tolerances (1) from its bound at which a bristle is at it. Where its rate has an infinite slope there, steps that
/// are not implicit leave a value one or two short of it, and derivatives would grow from step to step.
const AT_BOUND: f64 = 8.0;

/// A speed (m/s) beyond all that a law may depend on.
const FAST: f64 = 1e6;

/// The right-hand side of (x, v, z)′.
///
/// Everything is evaluated as if the swing went in the positive direction, with u and z of the other direction
/// mirrored: the law is odd, so this changes nothing but which side of its kink u = 0 belongs to, and that is the side
/// of the swing. Behind the end of the swing, where a step may reach before its end is found, the law is that of its
/// end; and so it is behind the zero of a state, where the law may have a corner.
pub(super) struct Field<'a, D, L: ?Sized> {
    pub(super) oscillator: &'a Oscillator<D>,
    /// The spring on the side of its corners on which the step is.
    pub(super) spring: Spring<'a, D>,
    pub(super) normal_load: D,
    pub(super) belt: D,
    pub(super) law: &'a L,
    /// Whether something outside prescribes the acceleration, which then stands in the place of the force (N), whatever
    /// the forces of machine and contact are.
    pub(super) guided: bool,
    /// 1/m.
    pub(super) per_mass: D,
    /// The damping coefficient, if damping is linear.
    pub(super) linear_damping: Option<D>,
    mirrored: Vec<D>,
    rate: Vec<D>,
    /// Rates that the Jacobian compares with.
    centre: Vec<f64>,
    /// Which states have a corner of their rate at zero.
    bends: Vec<bool>,
    /// Which states have not yet come back through zero in this swing, and stay below it until that is found.
    below: Vec<bool>,
    /// Which states have reached their bound for the rest of this swing.
    saturated: Vec<bool>,
}

impl<'a, D: Scalar, L: BristleLaw<D> + ?Sized> Field<'a, D, L> {
    pub(super) fn new(oscillator: &'a Oscillator<D>, law: &'a L, normal_load: D, belt: D) -> Self {
        let zeros = vec![D::from(0.0); law.states()];
        Self {
            oscillator,
            spring: Spring::new(oscillator),
            normal_load,
            belt,
            law,
            guided: false,
            per_mass: D::from(1.0) / oscillator.mass(),
            linear_damping: oscillator.damping().is_linear().then(|| oscillator.damping().linear_coefficient()),
            bends: Self::corners(law, per_second(oscillator)),
            mirrored: zeros.clone(),
            below: vec![false; zeros.len()],
            saturated: vec![false; zeros.len()],
            centre: vec![0.0; zeros.len()],
            rate: zeros,
        }
    }

    /// Number of unknowns: x, v and the states of the law.
    pub(super) fn size(&self) -> usize {
        2 + self.rate.len()
    }

    /// Notes which states at the beginning of a step are to come back through zero.
    pub(super) fn begin(&mut self, branch: Branch, state: &[D]) {
        self.below.fill(false);
        for index in 0..self.below.len() {
            let is_below = self.bends[index] && state[2 + index].value() * branch.direction.sign() < 0.0;
            self.below[index] =
                is_below && self.reserve(index, branch, state).is_none() && !branch.regime.slides(index);
        }
    }

    /// Whether the state of this `index` is to come back through zero.
    pub(super) fn is_below(&self, index: usize) -> bool {
        self.below[index]
    }

    /// Which states have a corner of the rate or of the coefficient at zero, seen by the even part of their change near
    /// it: that of a smooth function is small beside the odd part. `per_second` (1/s) makes a speed of a deflection.
    fn corners(law: &L, per_second: f64) -> Vec<bool> {
        let size = law.states();
        let [mut state, mut rate] = [vec![D::from(0.0); size], vec![D::from(0.0); size]];
        let corner = |index: usize| {
            let bound = law.bound(index).value().abs();
            let speed = D::from(bound * per_second);
            let mut at = |part: f64| {
                state[index] = D::from(part * bound);
                law.rate(speed, &state, Regime::ALL_HOLD, &mut rate);
                [rate[index].value(), law.coefficient(speed, &state, &rate).value()]
            };
            let [below, middle, above] = [at(-NEAR_ZERO), at(0.0), at(NEAR_ZERO)];
            state[index] = D::from(0.0);
            (0..2).any(|i| {
                let (rise, fall) = (above[i] - middle[i], below[i] - middle[i]);
                !((rise + fall).abs() <= 1e-2 * (rise.abs() + fall.abs()))
            })
        };
        (0..size).map(corner).collect()
    }

    /// Whether the state of this `index` has reached its bound for the rest of this swing.
    pub(super) fn is_saturated(&self, index: usize) -> bool {
        self.saturated[index]
    }

    /// Lets no state be saturated, as at the beginning of a swing.
    pub(super) fn release(&mut self) {
        self.saturated.fill(false);
    }

    /// Puts states that are within `tolerance` of a bound that attracts them onto it, where they stay until the swing
    /// ends. False if there are none.
    ///
    /// A law such as Dahl's with an exponent below 1 reaches its bound in finite time, with an infinite slope there: no
    /// step of any length could be solved beyond.
    pub(super) fn saturate(&mut self, branch: Branch, state: &mut [D], tolerance: f64) -> bool {
        let mut found = false;
        for index in 0..self.rate.len() {
            let bound = self.law.bound(index);
            let speed = self.mirror(branch, state);
            let near = (self.mirrored[index] - bound).value().abs() <= AT_BOUND * tolerance * bound.value();
            if self.saturated[index] || !near {
                continue;
            }
            let mut rate = |factor: f64, speed: D| {
                self.mirrored[index] = bound * factor;
                self.law.rate(speed, &self.mirrored, branch.regime, &mut self.rate);
                self.rate[index].value()
            };
            // A bound that attracts at one speed only is left when the speed changes.
            let mut attracts = |speed: D| rate(1.0 - tolerance, speed) >= 0.0 && rate(1.0 + tolerance, speed) <= 0.0;
            if attracts(speed) && attracts(D::from(FAST)) {
                self.saturated[index] = true;
                state[2 + index] = bound * branch.direction.sign();
                found = true;
            }
        }
        found
    }

    /// Relative speed along `branch`, and the mirrored states in `self.mirrored`.
    #[inline]
    fn mirror(&mut self, branch: Branch, state: &[D]) -> D {
        let sign = branch.direction.sign();
        for ((mirrored, z), below) in self.mirrored.iter_mut().zip(&state[2..]).zip(&self.below) {
            let z = *z * sign;
            *mirrored = if *below && z.value() >= 0.0 { z - z.value() - f64::MIN_POSITIVE } else { z };
        }
        let speed = (state[1] - self.belt) * sign;
        if speed.value() < 0.0 { speed - speed.value() } else { speed }
    }

    /// Friction force (N) along the direction of the swing; the mirrored rates of the bristles are left in `self.rate`.
    #[inline]
    fn mirrored_friction(&mut self, branch: Branch, speed: D) -> D {
        self.law.rate(speed, &self.mirrored, branch.regime, &mut self.rate);
        for (rate, saturated) in self.rate.iter_mut().zip(&self.saturated) {
            *rate = if *saturated { D::from(0.0) } else { *rate };
        }
        self.normal_load * self.law.coefficient(speed, &self.mirrored, &self.rate)
    }

    /// Friction force (N), with its sign.
    #[inline]
    pub(super) fn friction(&mut self, branch: Branch, state: &[D]) -> D {
        let speed = self.mirror(branch, state);
        self.mirrored_friction(branch, speed) * branch.direction.sign()
    }

    /// v′ at `state` under `force` (N); the mirrored rates of the bristles are left in `self.rate`.
    #[inline]
    pub(super) fn acceleration(&mut self, force: D, branch: Branch, state: &[D]) -> D {
        let friction = self.friction(branch, state);
        let (x, v) = (state[0], state[1]);
        // The other forms of damping cost as much as everything else here together.
        let damping = match self.linear_damping {
            Some(coefficient) => v * coefficient,
            None => self.oscillator.damping().force(v),
        };
        let balance = (force - damping - self.spring.force(x) - friction) * self.per_mass;
        if self.guided { force } else { balance }
    }

    /// Writes (x, v, z)′ at `state` under `force` (N) into `rates`.
    #[inline]
    pub(super) fn rates(&mut self, force: D, branch: Branch, state: &[D], rates: &mut [D]) {
        rates[0] = state[1];
        rates[1] = self.acceleration(force, branch, state);
        for (rate, z) in rates[2..].iter_mut().zip(&self.rate) {
            *rate = *z * branch.direction.sign();
        }
    }

    /// Writes at which rates (1/s) the states return to where they tend to, from differences with the rates at `state`
    /// that [`rates`](Self::rates) has just left, all states moved at once: exact for states that do not act upon each
    /// other.
    pub(super) fn relaxations(&mut self, branch: Branch, state: &[D], relaxations: &mut [f64]) {
        for (centre, rate) in self.centre.iter_mut().zip(&self.rate) {
            *centre = rate.value();
        }
        let speed = self.mirror(branch, state);
        for (index, (mirrored, relaxation)) in self.mirrored.iter_mut().zip(&mut *relaxations).enumerate() {
            let z = mirrored.value();
            *mirrored += reach_of(z, self.law.bound(index).value());
            *relaxation = mirrored.value() - z;
        }
        self.law.rate(speed, &self.mirrored, branch.regime, &mut self.rate);
        for (index, relaxation) in relaxations.iter_mut().enumerate() {
            let change = self.centre[index] - self.rate[index].value();
            *relaxation = if self.saturated[index] { 0.0 } else { slope(change, *relaxation) };
        }
    }

    /// How far element `index` is from sliding, if it holds and can.
    pub(super) fn reserve(&mut self, index: usize, branch: Branch, state: &[D]) -> Option<D> {
        if branch.regime.slides(index) {
            return None;
        }
        let speed = self.mirror(branch, state);
        self.law.reserve(index, speed, &self.mirrored)
    }

    /// Size of the terms whose difference is the reserve of element `index`, if it holds and can slide: the reserve as
    /// it is and that without any deflection.
    pub(super) fn reserve_size(&mut self, index: usize, branch: Branch, state: &[D]) -> Option<f64> {
        let left = self.reserve(index, branch, state)?.value().abs();
        let speed = self.mirror(branch, state);
        self.mirrored.fill(D::from(0.0));
        let whole = self.law.reserve(index, speed, &self.mirrored)?.value().abs();
        Some(left + whole)
    }

    /// Sum of the magnitudes of the forces (N) that `rates` adds up, whose rounding the acceleration carries.
    pub(super) fn force_size(&mut self, force: D, branch: Branch, state: &[D]) -> f64 {
        let friction = self.friction(branch, state).value().abs();
        let damping = self.oscillator.damping().force(state[1]).value().abs();
        force.value().abs() + damping + self.spring.force(state[0]).value().abs() + friction
    }

    /// Writes the Jacobian of `rates` in the values at `state`, row by row, into `jacobian`. `speed` (m/s) is a typical
    /// velocity; differences are taken away from u = 0.
    pub(super) fn jacobian(&mut self, branch: Branch, state: &[D], speed: f64, jacobian: &mut [f64]) {
        let size = self.size();
        let sign = branch.direction.sign();
        let mass = self.oscillator.mass().value();
        jacobian.fill(0.0);
        jacobian[1] = 1.0;

        let x = state[0].value();
        let reach = (DIFFERENCE * x.abs().max(f64::MIN_POSITIVE / DIFFERENCE)).copysign(x);
        let restoring = |x: f64| self.spring.force(D::from(x)).value();
        jacobian[size] = -slope(restoring(x + reach) - restoring(x), x + reach - x) / mass;

        let u = D::from(self.mirror(branch, state).value());
        for mirrored in &mut self.mirrored {
            *mirrored = D::from(mirrored.value());
        }
        let before = self.mirrored_friction(branch, u).value();
        for (centre, rate) in self.centre.iter_mut().zip(&self.rate) {
            *centre = rate.value();
        }

        let reach = DIFFERENCE * u.value().max(1e-2 * speed).max(f64::MIN_POSITIVE / DIFFERENCE);
        let change = (u + reach - u).value();
        let after = self.mirrored_friction(branch, u + reach).value();
        let v = state[1].value();
        let damping = |v: f64| self.oscillator.damping().force(D::from(v)).value();
        let drag = slope(damping(v + sign * reach) - damping(v), (v + sign * reach) - v);
        jacobian[size + 1] = -(drag + slope(after - before, change)) / mass;
        for (row, rate) in self.centre.iter().enumerate() {
            jacobian[(2 + row) * size + 1] = slope(self.rate[row].value() - rate, change);
        }

        for column in 0..self.rate.len() {
            let z = self.mirrored[column];
            let reach = reach_of(z.value(), self.law.bound(column).value());
            self.mirrored[column] = z + reach;
            let change = (z + reach - z).value();
            let after = self.mirrored_friction(branch, u).value();
            jacobian[size + 2 + column] = -slope(after - before, change) / mass;
            for (row, rate) in self.centre.iter().enumerate() {
                jacobian[(2 + row) * size + 2 + column] = slope(self.rate[row].value() - rate, change);
            }
            self.mirrored[column] = z;
        }
        if self.guided {
            jacobian[size..2 * size].fill(0.0);
        }
    }
}

/// By how much to move a state `z` of this `bound` for a difference: towards the origin, where the states of the motion
/// come from.
fn reach_of(z: f64, bound: f64) -> f64 {
    let reach = DIFFERENCE * z.abs().max(1e-2 * bound.abs().min(f64::MAX)).max(f64::MIN_POSITIVE / DIFFERENCE);
    if z > 0.0 { -reach } else { reach }
}

/// What makes a speed of a deflection (1/s): the machine's frequency; any without a spring.
fn per_second<D: Scalar>(oscillator: &Oscillator<D>) -> f64 {
    let natural = oscillator.natural_angular_frequency().value();
    if natural > 0.0 { natural } else { 1.0 }
}

/// A difference quotient.
fn slope(difference: f64, change: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / change }
}
