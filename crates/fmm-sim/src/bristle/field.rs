//! The equations of motion of one half cycle: the oscillator, the bristles, and their Jacobian.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::{Oscillator, Restoring, Scalar};

use crate::bristle::hidden::depends_on_speed;
use crate::error::SimulationError;
use crate::mechanics::{ForceWave, Piece, Spring};
use crate::scenario::Direction;

/// Smooth branch of the law on which the contact moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Branch {
    pub(super) direction: Direction,
    pub(super) regime: Regime,
}

/// Steps of the differences of the Jacobian, relative to the arguments; about √ε, as the Jacobian only has to make
/// Newton's method converge.
const DIFFERENCE: f64 = 1e-7;

/// Deflection over its bound (1) at which corners at zero are looked for.
const NEAR_ZERO: f64 = 1e-4;

/// Distance from its bound, in tolerances (1), at which a bristle counts as at the bound. Explicit steps end one or two
/// tolerances short of a bound with an infinite slope, and derivatives would grow from step to step.
const AT_BOUND: f64 = 8.0;

/// A speed beyond all speeds that a law may depend on (m/s).
const FAST: f64 = 1e6;

/// The right-hand side of (x, v, z)′.
///
/// Everything is evaluated as if the half cycle went in the positive direction, with u and z of the other direction
/// mirrored. The law is odd, so that this only decides to which side of its kink u = 0 belongs: to that of the half
/// cycle. A step may reach beyond the end of the half cycle before the end is found; the law there is that of the end.
/// Beyond the zero of a state with a corner it is that of the zero.
pub(super) struct Field<'a, D, L: ?Sized> {
    pub(super) oscillator: &'a Oscillator<D>,
    /// The spring on the side of its corners on which the step is.
    pub(super) spring: Spring<'a, D>,
    pub(super) normal_load: D,
    pub(super) belt: D,
    pub(super) law: &'a L,
    /// True if the acceleration is prescribed. It then takes the place of the force (N), and machine and contact do not
    /// change it.
    pub(super) guided: bool,
    /// 1/m.
    pub(super) per_mass: D,
    /// The damping coefficient, if damping is linear.
    pub(super) linear_damping: Option<D>,
    mirrored: Vec<D>,
    rate: Vec<D>,
    /// Rates at the point from which the differences of the Jacobian are taken.
    centre: Vec<f64>,
    /// True for each state whose rate has a corner at zero.
    bends: Vec<bool>,
    /// True if the law is not one of the path alone.
    pub(super) depends_on_speed: bool,
    /// True for each state that has not yet come back through zero in this half cycle; it stays below zero until then.
    pub(super) below: Vec<bool>,
    /// True for each state that has reached its bound for the rest of this half cycle.
    pub(super) saturated: Vec<bool>,
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
            depends_on_speed: depends_on_speed(law),
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

    /// Angular frequency (rad/s) of small vibrations about `position` on a spring that is not linear; 0 if it is, or
    /// pushes away.
    pub(super) fn local_angular(&self, position: D) -> f64 {
        match self.oscillator.restoring() {
            Restoring::Linear => 0.0,
            _ => (self.spring.slope(position) * self.per_mass.value()).max(0.0).sqrt(),
        }
    }

    /// Notes the states that are to come back through zero after the beginning of a step.
    pub(super) fn begin(&mut self, branch: Branch, state: &[D]) {
        self.below.fill(false);
        for index in 0..self.below.len() {
            let is_below = self.bends[index] && state[2 + index].value() * branch.direction.sign() < 0.0;
            self.below[index] =
                is_below && self.reserve(index, branch, state).is_none() && !branch.regime.slides(index);
        }
    }

    /// Finds the states with a corner of the rate or of the coefficient at zero by the even part of their change near
    /// zero, which is small beside the odd part for a smooth function. `per_second` (1/s) converts a deflection to a
    /// speed.
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

    /// Releases all saturated states, at the beginning of a half cycle.
    pub(super) fn release(&mut self) {
        self.saturated.fill(false);
    }

    /// Puts states that are within `tolerance` of a bound that attracts them onto it, where they stay until the half
    /// cycle ends. False if there are none.
    ///
    /// A law such as Dahl's with an exponent below 1 reaches its bound in finite time, with an infinite slope there. No
    /// step of any length could be solved beyond it.
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

    /// Friction force (N) along the direction of the half cycle; the mirrored rates of the bristles are left in
    /// `self.rate`.
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
            None => self.oscillator.damping_force(v),
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

    /// Writes the rates (1/s) at which the states return to their equilibrium, from differences with the rates at
    /// `state` that [`rates`](Self::rates) has just left. All states are moved at once, which is exact for states that
    /// do not act upon each other.
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

    /// Reserve of element `index` before it slides, if it holds and can slide.
    pub(super) fn reserve(&mut self, index: usize, branch: Branch, state: &[D]) -> Option<D> {
        if branch.regime.slides(index) {
            return None;
        }
        let speed = self.mirror(branch, state);
        self.law.reserve(index, speed, &self.mirrored)
    }

    /// Size of the terms whose difference is the reserve of element `index`, if it holds and can slide: the reserve and
    /// the reserve without any deflection.
    pub(super) fn reserve_size(&mut self, index: usize, branch: Branch, state: &[D]) -> Option<f64> {
        let left = self.reserve(index, branch, state)?.value().abs();
        let speed = self.mirror(branch, state);
        self.mirrored.fill(D::from(0.0));
        let whole = self.law.reserve(index, speed, &self.mirrored)?.value().abs();
        Some(left + whole)
    }

    /// Sum of the magnitudes of the forces (N) that `rates` adds up at `time`, whose rounding the acceleration carries.
    pub(super) fn force_size(&mut self, piece: &Piece<D>, time: f64, branch: Branch, state: &[D]) -> f64 {
        let friction = self.friction(branch, state).value().abs();
        let damping = self.oscillator.damping_force(state[1]).value().abs();
        // Next to a zero of a wave, or to a corner, the force is a small difference of large terms.
        // An angle is rounded as well, to as many ulp as it has turns.
        let of_wave = |wave: &ForceWave<D>| wave.amplitude.value().abs() * (1.0 + wave.angular.value() * time);
        let force = piece.force(time).value().abs() + piece.waves.iter().map(of_wave).sum::<f64>();
        let spring =
            self.spring.force(state[0]).value().abs().max(self.spring.slope(state[0]) * state[0].value().abs());
        force + damping + spring + friction
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
        let damping = |v: f64| self.oscillator.damping_force(D::from(v)).value();
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

/// Displacement of a state `z` of this `bound` for a difference: towards the origin, as the motion comes from there.
fn reach_of(z: f64, bound: f64) -> f64 {
    let reach = DIFFERENCE * z.abs().max(1e-2 * bound.abs().min(f64::MAX)).max(f64::MIN_POSITIVE / DIFFERENCE);
    if z > 0.0 { -reach } else { reach }
}

/// Rate that converts a deflection to a speed (1/s): the machine's frequency, or 1 without a spring.
fn per_second<D: Scalar>(oscillator: &Oscillator<D>) -> f64 {
    let natural = oscillator.natural_angular_frequency().value();
    if natural > 0.0 { natural } else { 1.0 }
}

/// A difference quotient.
fn slope(difference: f64, change: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / change }
}

/// Greatest relative difference of the two sides by rounding (1).
const ROUNDING: f64 = 1e-9;

/// Looks at `law` over ten decades of speed and some states within its bounds, each with its mirror image.
///
/// # Errors
/// [`SimulationError::OutOfRange`] if rate or coefficient are not opposite.
pub(super) fn require_odd<D: Scalar, L: BristleLaw<D> + ?Sized>(law: &L) -> Result<(), SimulationError> {
    let size = law.states();
    let mut buffers = [(); 2].map(|()| (vec![D::from(0.0); size], vec![D::from(0.0); size]));
    for part in [0.0, 0.3, 0.7] {
        for decade in -8..=2 {
            let speed = 10f64.powi(decade);
            let [ahead, back] = &mut buffers;
            let mut coefficients = [0.0; 2];
            for ((sign, (state, rate)), coefficient) in [(1.0, ahead), (-1.0, back)].into_iter().zip(&mut coefficients)
            {
                for (index, z) in state.iter_mut().enumerate() {
                    // Neighbouring elements lean to opposite sides.
                    let side = if index % 2 == 0 { sign } else { -sign };
                    *z = D::from(law.bound(index).value() * part * side);
                }
                law.rate(D::from(sign * speed), state, Regime::ALL_HOLD, rate);
                *coefficient = law.coefficient(D::from(sign * speed), state, rate).value();
            }
            let [(_, ahead), (_, back)] = &buffers;
            let rates = ahead.iter().zip(back).map(|(a, b)| (a.value(), b.value()));
            let differs = |(a, b): (f64, f64)| (a + b).abs() > ROUNDING * (a.abs() + b.abs());
            if rates.chain([(coefficients[0], coefficients[1])]).any(differs) {
                return Err(SimulationError::not_odd(speed));
            }
        }
    }
    Ok(())
}
