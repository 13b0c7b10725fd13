//! One step of the Dormand-Prince method of order 8, and the polynomial that follows the motion within it.

use fmm_model::Scalar;

use crate::dormand_prince::{
    COEFFICIENTS, END, Rates, Within, bernstein, dense_stages, error, errors, halves, nested, step,
};
use crate::scenario::State;

/// Differences of a step from the embedded formulas of orders 5 and 3, for position and velocity.
pub(super) struct DerivativeErrors<D> {
    length: f64,
    position: (D, D),
    velocity: (D, D),
}

impl<D: Scalar> DerivativeErrors<D> {
    /// The local error of the derivative in `direction`, as one of the velocity (m/s) of a machine that vibrates with
    /// `angular` (rad/s).
    pub(super) fn of(&self, direction: usize, angular: f64) -> f64 {
        let norm = |x: D, v: D| (angular * x.partial(direction)).powi(2) + v.partial(direction).powi(2);
        error(self.length, norm(self.position.0, self.velocity.0), norm(self.position.1, self.velocity.1))
    }
}

/// A step taken from `begin` over `length` (s).
#[derive(Clone)]
pub(super) struct Step<D> {
    pub(super) begin: State<D>,
    pub(super) end: State<D>,
    pub(super) length: f64,
    /// Velocity and acceleration.
    rates: [Rates<D>; 2],
    /// Length times the decay rate of the velocity at the end (1).
    pub(super) stiffness: f64,
}

/// Length of a step times the decay rate of the velocity up to which the method damps a decay (1).
pub(super) const STABLE: f64 = 6.0;

/// Share of their terms below which differences are rounding (1).
const ROUNDED: f64 = 1e3 * f64::EPSILON;

impl<D: Scalar> Step<D> {
    /// Steps from `begin`, where the acceleration is `acceleration`, over `length`; `accelerate` gives the acceleration
    /// at a time counted from the beginning of the step.
    #[inline]
    pub(super) fn take(
        begin: State<D>,
        acceleration: D,
        length: f64,
        accelerate: impl FnMut(f64, State<D>) -> D,
    ) -> Self {
        let mut rates = [[begin.velocity; 16], [acceleration; 16]];
        let start = [begin.position, begin.velocity];
        let (mut state, mut end) = (start, start);
        step(&start, length, &mut rates, &mut state, &mut end, rate_of(accelerate));
        let stiffness = length * decay_rate([state[1], end[1]], [rates[1][END - 1], rates[1][END]]);
        Self { begin, end: State { position: end[0], velocity: end[1] }, length, rates, stiffness }
    }

    /// Acceleration at the end.
    pub(super) fn last_acceleration(&self) -> D {
        self.rates[1][END]
    }

    /// The least and the greatest acceleration at any stage.
    pub(super) fn range_of_acceleration(&self) -> (f64, f64) {
        let stages = self.rates[1][..=END].iter().map(|acceleration| acceleration.value());
        stages.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), a| (least.min(a), most.max(a)))
    }

    /// The local error relative to a motion of the amplitudes `scale`.
    pub(super) fn error(&self, scale: State<f64>) -> f64 {
        let [position, velocity] = [errors(&self.rates[0]), errors(&self.rates[1])];
        let norm = |x: D, v: D| {
            let (x, v) = (x.value() / scale.position, v.value() / scale.velocity);
            0.5 * (x * x + v * v)
        };
        error(self.length, norm(position.0, velocity.0), norm(position.1, velocity.1))
    }

    /// Terms of the local errors of the derivatives.
    pub(super) fn derivative_errors(&self) -> DerivativeErrors<D> {
        DerivativeErrors { length: self.length, position: errors(&self.rates[0]), velocity: errors(&self.rates[1]) }
    }

    /// Replaces the state and the acceleration at the end.
    pub(super) fn correct(&mut self, end: State<D>, acceleration: D) {
        self.end = end;
        (self.rates[0][END], self.rates[1][END]) = (end.velocity, acceleration);
    }

    /// The motion within the step, to order 7.
    #[inline]
    pub(super) fn within(&mut self, accelerate: impl FnMut(f64, State<D>) -> D) -> Within<D> {
        let start = [self.begin.position, self.begin.velocity];
        let mut state = start;
        dense_stages(&start, self.length, &mut self.rates, &mut state, rate_of(accelerate));
        let end = [self.end.position, self.end.velocity];
        let of = |i: usize| nested(&self.rates[i], end[i] - start[i], self.length);
        Within { begin: start, nested: [of(0), of(1)] }
    }
}

/// The rate at which neighbouring velocities approach each other (1/s), of two `velocities` at one time and their
/// `accelerations`; 0 if they part, or differ by rounding.
///
/// From the two last stages, as in section IV.2 of E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*,
/// Springer 1996.
fn decay_rate<D: Scalar>(velocities: [D; 2], accelerations: [D; 2]) -> f64 {
    let difference = |[a, b]: [D; 2]| {
        let (a, b) = (a.value(), b.value());
        Some(b - a).filter(|difference| difference.abs() > ROUNDED * b.abs())
    };
    match (difference(velocities), difference(accelerations)) {
        (Some(velocity), Some(acceleration)) => (-acceleration / velocity).max(0.0),
        _ => 0.0,
    }
}

/// Velocity and acceleration as rates of position and velocity.
#[inline]
fn rate_of<D: Scalar>(mut accelerate: impl FnMut(f64, State<D>) -> D) -> impl FnMut(f64, &[D], usize, &mut [Rates<D>]) {
    move |elapsed, state, stage, rates| {
        let state = State { position: state[0], velocity: state[1] };
        rates[0][stage] = state.velocity;
        rates[1][stage] = accelerate(elapsed, state);
    }
}

/// The first θ in (0, 1] at which the polynomial, positive before it, reaches zero; `None` if it stays positive.
///
/// The coefficients in the Bernstein basis enclose the polynomial. Unless all are positive the interval is halved, so
/// that no pair of zeros is missed.
pub(super) fn first_zero_within(coefficients: [f64; COEFFICIENTS]) -> Option<f64> {
    search(bernstein(coefficients), 0.0, 1.0, 0)
}

/// Number of halvings after which a landing can begin from the interval.
const DEPTH: u32 = 20;

fn search(bernstein: [f64; COEFFICIENTS], from: f64, to: f64, depth: u32) -> Option<f64> {
    // The near end is no zero, except for the one at the start, from which the polynomial may rise slowly.
    if bernstein[1..].iter().all(|value| *value >= 0.0) && bernstein[COEFFICIENTS - 1] > 0.0 {
        return None;
    }
    if depth == DEPTH {
        return Some(to);
    }
    let (left, right) = halves(bernstein);
    let middle = 0.5 * (from + to);
    search(left, from, middle, depth + 1)
        .or_else(|| if left[COEFFICIENTS - 1] <= 0.0 { Some(middle) } else { search(right, middle, to, depth + 1) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x″ = −x from (0.6, 0.8): the error of a step of length h falls as h⁹, that of the polynomial as h⁸.
    #[test]
    fn orders_are_8_and_7() {
        let errors = |length: f64| {
            let accelerate = |_, state: State| -state.position;
            let exact = |time: f64| 0.6 * time.cos() + 0.8 * time.sin();
            let mut step = Step::take(State { position: 0.6, velocity: 0.8 }, -0.6, length, accelerate);
            let within = step.within(accelerate);
            let polynomial = (0..=100)
                .map(|i| f64::from(i) / 100.0)
                .map(|theta| (within.at(theta).position - exact(theta * length)).abs())
                .fold(0.0, f64::max);
            ((step.end.position - exact(length)).abs(), polynomial, step.error(State { position: 1.0, velocity: 1.0 }))
        };
        let (coarse, fine) = (errors(0.5), errors(0.35));
        for (name, order, got) in [
            ("step", 9.0, coarse.0 / fine.0),
            ("polynomial", 8.0, coarse.1 / fine.1),
            ("estimate", 8.0, coarse.2 / fine.2),
        ] {
            let observed = got.ln() / (0.5f64 / 0.35).ln();
            assert!((observed - order).abs() < 0.6, "{name}: order {observed} per step");
        }
        assert!(coarse.2 > coarse.0, "the estimate is no bound: {coarse:?}");
    }

    /// v′ = −λ v.
    #[test]
    fn what_decays_is_damped_by_steps_that_are_called_stable() {
        for tenths in 1..=60 {
            let stiffness = f64::from(tenths) / 10.0;
            let step = Step::take(State { position: 0.0, velocity: 1.0 }, -stiffness, 1.0, |_, state| {
                -stiffness * state.velocity
            });
            assert!(step.end.velocity.abs() < 1.0, "{stiffness}: {}", step.end.velocity);
            assert!(
                stiffness < 0.5 || (step.stiffness / stiffness - 1.0).abs() < 1e-9,
                "{stiffness}: {}",
                step.stiffness
            );
        }
        let growing = Step::take(State { position: 0.0, velocity: 1.0 }, 5.0, 1.0, |_, state| 5.0 * state.velocity);
        assert_eq!(growing.stiffness, 0.0);
    }

    #[test]
    fn the_first_zero_of_a_polynomial_is_found() {
        // (θ − ¼)(θ − ½)(θ + 1) and one with a narrow dip below zero at 0.7.
        let product = [0.125, -0.625, 0.25, 1.0, 0.0, 0.0, 0.0, 0.0];
        assert!((first_zero_within(product).unwrap() - 0.25).abs() < 1e-6);
        for gap in [1e-6, 1e-12] {
            let dip = [0.49 - gap, -1.4, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            assert!((first_zero_within(dip).unwrap() - (0.7 - gap.sqrt())).abs() < 1e-6, "dip of {gap}");
            let miss = [0.49 + gap, -1.4, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            assert_eq!(first_zero_within(miss), None, "miss by {gap}");
        }
        // A zero at the start is left behind, however slowly.
        assert_eq!(first_zero_within([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]), None);
        assert_eq!(first_zero_within([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), None);
        assert!((first_zero_within([0.0, 1.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap() - 0.5).abs() < 1e-6);
    }
}
