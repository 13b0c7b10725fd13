//! One step of the Dormand-Prince method of order 8, and the polynomial that follows the motion within it.

use fmm_model::Scalar;

use super::tableau::{
    DENSE_0, DENSE_1, DENSE_2, DENSE_3, ERROR_3, ERROR_5, NODES, STAGE_1, STAGE_2, STAGE_3, STAGE_4, STAGE_5, STAGE_6,
    STAGE_7, STAGE_8, STAGE_9, STAGE_10, STAGE_11, STAGE_13, STAGE_14, STAGE_15, STEP, Weights,
};
use crate::State;
use crate::within::{COEFFICIENTS, Within};

/// The derivative of a state: velocity and acceleration.
type Rate<D> = State<D>;

/// A step taken from `begin` over `length` (s).
pub(super) struct Step<D> {
    pub(super) begin: State<D>,
    pub(super) end: State<D>,
    pub(super) length: f64,
    rates: [Rate<D>; 16],
}

#[inline]
fn sum<D: Scalar, const N: usize>(weights: &Weights<N>, rates: &[Rate<D>; 16]) -> Rate<D> {
    let (first, weight) = weights[0];
    let mut sum = State { position: rates[first].position * weight, velocity: rates[first].velocity * weight };
    for (stage, weight) in &weights[1..] {
        sum.position = sum.position + rates[*stage].position * *weight;
        sum.velocity = sum.velocity + rates[*stage].velocity * *weight;
    }
    sum
}

fn ahead<D: Scalar>(state: State<D>, rate: Rate<D>, length: f64) -> State<D> {
    State { position: state.position + rate.position * length, velocity: state.velocity + rate.velocity * length }
}

impl<D: Scalar> Step<D> {
    /// Steps from `begin`, where the acceleration is `acceleration`, over `length`; `accelerate` gives the acceleration
    /// at a time counted from the beginning of the step.
    #[inline]
    pub(super) fn take(
        begin: State<D>,
        acceleration: D,
        length: f64,
        mut accelerate: impl FnMut(f64, State<D>) -> D,
    ) -> Self {
        let first = State { position: begin.velocity, velocity: acceleration };
        let mut step = Self { begin, end: begin, length, rates: [first; 16] };
        macro_rules! stages {
            ($($stage:literal: $weights:ident),+) => {$(
                let state = ahead(begin, sum(&$weights, &step.rates), length);
                let acceleration = accelerate(NODES[$stage] * length, state);
                step.rates[$stage] = State { position: state.velocity, velocity: acceleration };
            )+};
        }
        stages!(1: STAGE_1, 2: STAGE_2, 3: STAGE_3, 4: STAGE_4, 5: STAGE_5, 6: STAGE_6);
        stages!(7: STAGE_7, 8: STAGE_8, 9: STAGE_9, 10: STAGE_10, 11: STAGE_11);
        step.end = ahead(begin, sum(&STEP, &step.rates), length);
        step.rates[12] = State { position: step.end.velocity, velocity: accelerate(length, step.end) };
        step
    }

    /// Acceleration at the beginning.
    pub(super) fn first_acceleration(&self) -> D {
        self.rates[0].velocity
    }

    /// Acceleration at the end.
    pub(super) fn last_acceleration(&self) -> D {
        self.rates[12].velocity
    }

    /// The local error relative to a motion of the amplitudes `scale`.
    ///
    /// ```text
    /// err = h |e₅|² / √(|e₅|² + 0.01 |e₃|²)                    (Hairer, Nørsett, Wanner, eq. II.10.17)
    /// ```
    pub(super) fn error(&self, scale: State<f64>) -> f64 {
        let norm = |error: Rate<D>| {
            let (x, v) = (error.position.value() / scale.position, error.velocity.value() / scale.velocity);
            0.5 * (x * x + v * v)
        };
        let (fifth, third) = (norm(sum(&ERROR_5, &self.rates)), norm(sum(&ERROR_3, &self.rates)));
        if fifth == 0.0 { 0.0 } else { self.length * fifth / (fifth + 0.01 * third).sqrt() }
    }

    /// The motion within the step, to order 7.
    #[inline]
    pub(super) fn within(&mut self, mut accelerate: impl FnMut(f64, State<D>) -> D) -> Within<D> {
        macro_rules! stages {
            ($($stage:literal: $weights:ident),+) => {$(
                let state = ahead(self.begin, sum(&$weights, &self.rates), self.length);
                let acceleration = accelerate(NODES[$stage] * self.length, state);
                self.rates[$stage] = State { position: state.velocity, velocity: acceleration };
            )+};
        }
        stages!(13: STAGE_13, 14: STAGE_14, 15: STAGE_15);
        let length = self.length;
        let (begin, end) = (self.begin, self.end);
        let (first, last) = (self.rates[0], self.rates[12]);
        let scaled = |rate: Rate<D>| State { position: rate.position * length, velocity: rate.velocity * length };
        let lower = |of: fn(State<D>) -> D| {
            let (rise, first, last) = (of(end) - of(begin), of(first) * length, of(last) * length);
            [rise, first - rise, rise * 2.0 - (last + first)]
        };
        let (position, velocity) = (lower(|state| state.position), lower(|state| state.velocity));
        let nested = [
            State { position: position[0], velocity: velocity[0] },
            State { position: position[1], velocity: velocity[1] },
            State { position: position[2], velocity: velocity[2] },
            scaled(sum(&DENSE_0, &self.rates)),
            scaled(sum(&DENSE_1, &self.rates)),
            scaled(sum(&DENSE_2, &self.rates)),
            scaled(sum(&DENSE_3, &self.rates)),
        ];
        Within::new(begin, nested)
    }
}

/// The first θ in (0, 1] at which the polynomial, positive before it, reaches zero; none if it stays positive.
///
/// The coefficients in the Bernstein basis enclose the polynomial. Where they are not all positive the interval is halved,
/// so that no pair of zeros hides between two samples.
pub(super) fn first_zero_within(coefficients: [f64; COEFFICIENTS]) -> Option<f64> {
    let mut bernstein = coefficients;
    // b_j = Σ_{i ≤ j} (j choose i)/(7 choose i) c_i, by repeated sums of scaled coefficients.
    let binomials = [1.0, 7.0, 21.0, 35.0, 35.0, 21.0, 7.0, 1.0];
    for (coefficient, binomial) in bernstein.iter_mut().zip(binomials) {
        *coefficient /= binomial;
    }
    for order in 1..COEFFICIENTS {
        for i in (order..COEFFICIENTS).rev() {
            bernstein[i] += bernstein[i - 1];
        }
    }
    search(bernstein, 0.0, 1.0, 0)
}

/// Halvings after which an interval is short enough to begin a landing from.
const DEPTH: u32 = 20;

fn search(bernstein: [f64; COEFFICIENTS], from: f64, to: f64, depth: u32) -> Option<f64> {
    // The near end is known to be no zero but the one at the start; from there it may rise as slowly as it likes.
    if bernstein[1..].iter().all(|value| *value >= 0.0) && bernstein[COEFFICIENTS - 1] > 0.0 {
        return None;
    }
    if depth == DEPTH {
        return Some(to);
    }
    let (mut left, mut right, mut row) = (bernstein, bernstein, bernstein);
    for i in 1..COEFFICIENTS {
        for j in 0..COEFFICIENTS - i {
            row[j] = 0.5 * (row[j] + row[j + 1]);
        }
        left[i] = row[0];
        right[COEFFICIENTS - 1 - i] = row[COEFFICIENTS - 1 - i];
    }
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
