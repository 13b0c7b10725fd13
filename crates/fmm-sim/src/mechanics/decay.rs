//! The free motion of a linear oscillator about its centre, in closed form for any damping.

use fmm_model::Scalar;

use crate::scenario::State;

/// x″ + 2a x′ + ω₀² x = 0, with x counted from the centre.
///
/// ```text
/// x(τ) = e^(−aτ) [x₀ C(τ) + (v₀ + a x₀) S(τ)]
/// v(τ) = e^(−aτ) [v₀ C(τ) − (a v₀ + ω₀² x₀) S(τ)]
/// C(τ) = cosh √(δτ²),  S(τ) = τ sinh √(δτ²)/√(δτ²),  δ = a² − ω₀²
/// ```
///
/// C and S are entire functions of δτ²: cosine and sine below critical damping, hyperbolic above, and smooth, with
/// all derivatives, in between.
#[derive(Debug)]
pub(crate) struct Decay<D> {
    /// a (1/s).
    pub(crate) rate: D,
    square: D,
    spread: D,
    /// The half period, if the motion oscillates.
    pub(crate) half_cycle: Option<HalfCycle<D>>,
}

/// One half period of an oscillating decay, from zero velocity to zero velocity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfCycle<D> {
    /// ω_d (rad/s).
    pub(crate) angular: D,
    /// π/ω_d (s).
    pub(crate) duration: D,
    /// q = exp(−π a/ω_d), ratio of successive amplitudes (1).
    ratio: D,
}

/// Closer to critical damping than this (as −δ/ω₀²), division by ω_d would cost digits of the derivatives, and
/// a fast sampling is not needed: a half cycle lasts a thousand times longer than the decay.
const OSCILLATING: f64 = 1e-6;

/// Below this |δτ²| the power series in δτ² is taken; twelve terms then reach 0.5¹²/24! < 1e-27.
const SERIES: f64 = 0.5;
const SERIES_TERMS: i32 = 12;

impl<D: Scalar> Decay<D> {
    /// `rate` a (1/s) and `square` ω₀² (1/s²).
    pub(crate) fn new(rate: D, square: D) -> Self {
        let spread = rate * rate - square;
        let half_cycle = (-spread.value() > OSCILLATING * square.value()).then(|| {
            let angular = (-spread).sqrt();
            let duration = D::from(std::f64::consts::PI) / angular;
            HalfCycle { angular, duration, ratio: (-rate * duration).exp() }
        });
        Self { rate, square, spread, half_cycle }
    }

    /// ω₀ (rad/s).
    pub(crate) fn natural(&self) -> f64 {
        self.square.value().sqrt()
    }

    /// a v + ω₀² x, the negative slope of the sine part of the velocity.
    pub(crate) fn pull(&self, state: State<D>) -> D {
        self.rate * state.velocity + self.square * state.position
    }

    /// e^(−aτ) cos ωτ and e^(−aτ) sin ωτ.
    pub(crate) fn turn(&self, angular: D, elapsed: D) -> (D, D) {
        let (sin, cos) = (angular * elapsed).sin_cos();
        let envelope = (-self.rate * elapsed).exp();
        (envelope * cos, envelope * sin)
    }

    /// e^(−aτ) C(τ) and e^(−aτ) S(τ).
    fn basis(&self, elapsed: D) -> (D, D) {
        if let Some(HalfCycle { angular, .. }) = self.half_cycle {
            let (cosine, sine) = self.turn(angular, elapsed);
            return (cosine, sine / angular);
        }
        let argument = self.spread * elapsed * elapsed;
        if argument.value().abs() < SERIES {
            // Horner on Σ uⁿ/(2n)! and Σ uⁿ/(2n+1)!.
            let (mut even, mut odd) = (D::from(1.0), D::from(1.0));
            for n in (1..=SERIES_TERMS).rev() {
                let double = f64::from(2 * n);
                even = even * argument / (double * (double - 1.0)) + 1.0;
                odd = odd * argument / (double * (double + 1.0)) + 1.0;
            }
            let envelope = (-self.rate * elapsed).exp();
            (envelope * even, envelope * odd * elapsed)
        } else if argument.value() < 0.0 {
            let angular = (-self.spread).sqrt();
            let (cosine, sine) = self.turn(angular, elapsed);
            (cosine, sine / angular)
        } else {
            // The slow rate a − σ as ω₀²/(a + σ): no cancellation, and neither exponential can overflow.
            let sigma = self.spread.sqrt();
            let fast = (-(self.rate + sigma) * elapsed).exp();
            let slow = (-(self.square / (self.rate + sigma)) * elapsed).exp();
            ((slow + fast) * 0.5, (slow - fast) * 0.5 / sigma)
        }
    }

    /// The state a time `elapsed` (s) after `state`.
    pub(crate) fn advance(&self, state: State<D>, elapsed: D) -> State<D> {
        let (cosine, sine) = self.basis(elapsed);
        State {
            position: state.position * cosine + (state.velocity + self.rate * state.position) * sine,
            velocity: state.velocity * cosine - self.pull(state) * sine,
        }
    }

    /// The decay without derivatives.
    pub(crate) fn plain(&self) -> Decay<f64> {
        let half_cycle = self.half_cycle.map(|HalfCycle { angular, duration, ratio }| HalfCycle {
            angular: angular.value(),
            duration: duration.value(),
            ratio: ratio.value(),
        });
        let [rate, square, spread] = [self.rate, self.square, self.spread].map(D::value);
        Decay { rate, square, spread, half_cycle }
    }

    /// Velocity and acceleration at `state`: the derivative of a free decay is a free decay.
    pub(crate) fn derivative(&self, state: State<D>) -> State<D> {
        State { position: state.velocity, velocity: -(state.velocity * self.rate * 2.0 + state.position * self.square) }
    }

    /// Bound of |position| from `state` on (m).
    pub(crate) fn most(&self, state: State<D>) -> f64 {
        let (position, push) = (state.position.value(), (state.velocity + self.rate * state.position).value());
        if let Some(HalfCycle { angular, .. }) = self.half_cycle {
            return position.hypot(push / angular.value());
        }
        // e^(−aτ) C ≤ 1 and e^(−aτ) S ≤ τ e^(−(a−σ)τ) ≤ 1/(e (a−σ)), with 1/(a−σ) as (a+σ)/ω₀².
        let sigma = self.spread.value().max(0.0).sqrt();
        position.abs() + push.abs() * (self.rate.value() + sigma) / (self.square.value() * std::f64::consts::E)
    }

    /// Time (s) until the velocity is zero again, not counting a zero at `state`; `None` if it never is.
    pub(crate) fn time_to_zero_velocity(&self, state: State<D>) -> Option<D> {
        let velocity = state.velocity;
        if velocity.value() == 0.0 {
            // A velocity of zero may still have a derivative: a push in the direction of the motion to come starts
            // that motion earlier.
            let is_pushed = (0..D::DIRECTIONS).any(|direction| velocity.partial(direction) != 0.0);
            let late = if is_pushed { velocity / self.pull(state) } else { velocity };
            return self.half_cycle.map(|half_cycle| half_cycle.duration + late);
        }
        // v = 0 where S/C = v₀/(a v₀ + ω₀² x₀); S/C is tan(ωτ)/ω below and tanh(στ)/σ above critical damping.
        let pull = self.pull(state);
        if let Some(HalfCycle { angular, .. }) = self.half_cycle {
            let sign = velocity.value().signum();
            return Some((angular * velocity * sign).atan2(pull * sign) / angular);
        }
        let quotient = velocity / pull;
        if !(quotient.value() > 0.0 && quotient.value().is_finite()) {
            return None;
        }
        let argument = self.spread * quotient * quotient;
        if argument.value().abs() < 0.05 {
            // atanh(√u)/√u = Σ uⁿ/(2n+1); 0.05¹⁴ < 1e-18.
            let mut series = D::from(1.0 / 29.0);
            for n in (0..14).rev() {
                series = series * argument + 1.0 / f64::from(2 * n + 1);
            }
            return Some(quotient * series);
        }
        if argument.value() < 0.0 {
            let angular = (-self.spread).sqrt();
            return Some((angular * quotient).atan2(D::from(1.0)) / angular);
        }
        // 1 ± σ v₀/(a v₀ + ω₀² x₀) over the common denominator; a − σ as ω₀²/(a + σ), which does not cancel.
        let sigma = self.spread.sqrt();
        let fast = self.rate + sigma;
        let above = fast * velocity + self.square * state.position;
        let below = (velocity / fast + state.position) * self.square;
        let ratio = above / below;
        (ratio.value() > 1.0 && ratio.value().is_finite()).then(|| ratio.ln() / (sigma * 2.0))
    }

    /// Position after `duration`, which [`time_to_zero_velocity`](Self::time_to_zero_velocity) gave for `state`.
    pub(crate) fn position_at_zero_velocity(&self, state: State<D>, duration: D) -> D {
        match self.half_cycle {
            // Exact without damping: a half cycle from rest ends at the mirror image, to the last bit.
            Some(HalfCycle { ratio, .. }) if state.velocity.value() == 0.0 => -(state.position * ratio),
            _ => self.advance(state, duration).position,
        }
    }
}

/// A free decay from some time on: its value and first two derivatives there, and bounds of the magnitude of the decay
/// and its derivatives up to the third from there on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ahead {
    pub(crate) derivatives: [f64; 3],
    pub(crate) most: [f64; 4],
}

/// Ratio of σ to a from which on the two exponentials of a motion without oscillation are far enough apart to be
/// written as a sum.
const APART: f64 = 0.1;

impl Decay<f64> {
    /// Rate (1/s) at which the fastest part of the motion changes.
    pub(crate) fn fastest(&self) -> f64 {
        if self.spread > 0.0 { self.rate + self.spread.sqrt() } else { self.natural() }
    }

    /// The decay from `free` on, `elapsed` (s) later.
    pub(crate) fn ahead(&self, free: State<f64>, elapsed: f64) -> Ahead {
        let sigma = self.spread.max(0.0).sqrt();
        if sigma < APART * self.rate || sigma == 0.0 {
            let first = self.advance(free, elapsed);
            let second = self.derivative(first);
            let third = self.derivative(second);
            let derivatives = [first.position, first.velocity, second.velocity];
            return Ahead { derivatives, most: [first, second, third, self.derivative(third)].map(|s| self.most(s)) };
        }
        // A e^(−st) + B e^(−ft): the rounding of the fast part would hide the derivatives of the slow one, each by a
        // further f/s.
        let fast = self.rate + sigma;
        let slow = self.square / fast;
        let mut slow_part = (free.velocity + fast * free.position) / (2.0 * sigma) * (-slow * elapsed).exp();
        let mut fast_part = -(free.velocity + slow * free.position) / (2.0 * sigma) * (-fast * elapsed).exp();
        let (mut derivatives, mut most) = ([0.0; 3], [0.0; 4]);
        for (order, most) in most.iter_mut().enumerate() {
            if let Some(derivative) = derivatives.get_mut(order) {
                *derivative = slow_part + fast_part;
            }
            *most = slow_part.abs() + fast_part.abs();
            (slow_part, fast_part) = (-slow * slow_part, -fast * fast_part);
        }
        Ahead { derivatives, most }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    fn state(position: f64, velocity: f64) -> State {
        State { position, velocity }
    }

    /// The state must not depend on whether a time is covered in one step or in two, in any regime.
    #[test]
    fn two_steps_equal_one() {
        for ratio in [0.0, 1e-3, 0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.001, 3.0] {
            let decay: Decay<f64> = Decay::new(13.8 * ratio, 13.8 * 13.8);
            for elapsed in [1e-4, 0.03, 0.2, 1.5] {
                let start = state(0.01, -0.07);
                let one = decay.advance(start, elapsed);
                let two = decay.advance(decay.advance(start, 0.4 * elapsed), 0.6 * elapsed);
                assert!((one.position - two.position).abs() < 1e-16, "ratio {ratio}, {elapsed} s");
                assert!((one.velocity - two.velocity).abs() < 1e-15, "ratio {ratio}, {elapsed} s");
            }
        }
    }

    /// A motion that starts a little in its own direction is at its next rest a little earlier.
    #[test]
    fn a_push_from_rest_moves_the_next_rest() {
        let (rate, square, position) = (0.4, 13.8 * 13.8, 0.01);
        let decay: Decay<Dual<1>> = Decay::new(rate.into(), square.into());
        let at_rest = State { position: position.into(), velocity: Dual::variable(0.0, 0) };
        let slope = decay.time_to_zero_velocity(at_rest).unwrap().partial(0);
        assert!((slope - 1.0 / (square * position)).abs() < 1e-15, "{slope} s²/m");
        let plain: Decay<f64> = Decay::new(rate, square);
        let time = |velocity| plain.time_to_zero_velocity(state(position, velocity)).unwrap();
        // The bend of the arc tangent over 1e-6 m/s is some 1e-6 of its slope.
        let quotient = (time(0.0) - time(-1e-6)) / 1e-6;
        assert!((quotient / slope - 1.0).abs() < 1e-5, "{quotient} instead of {slope} s²/m");
    }

    /// A sum of exponentials and the recurrence of the equation of motion are two ways to the same derivatives; the
    /// first keeps those of a slow motion whose fast part, a million times faster, is gone.
    #[test]
    fn derivatives_ahead_belong_to_the_motion() {
        for ratio in [0.3, 1.0, 1.004, 1.006, 3.0] {
            let decay: Decay<f64> = Decay::new(13.8 * ratio, 13.8 * 13.8);
            let free = state(0.01, -0.07);
            for elapsed in [0.0, 0.01, 0.3] {
                let ahead = decay.ahead(free, elapsed);
                let first = decay.advance(free, elapsed);
                let curvature = decay.derivative(first).velocity;
                for (order, expected) in [first.position, first.velocity, curvature].into_iter().enumerate() {
                    let error = (ahead.derivatives[order] - expected).abs();
                    assert!(error < 1e-13 * ahead.most[order], "ratio {ratio}, {elapsed} s, order {order}: {error}");
                    for later in 0..50 {
                        let later = decay.ahead(free, elapsed + 0.02 * f64::from(later)).derivatives[order];
                        assert!(later.abs() <= ahead.most[order] * (1.0 + 1e-12), "ratio {ratio}, order {order}");
                    }
                }
            }
        }
        let decay: Decay<f64> = Decay::new(1e6, 6.0);
        let ahead = decay.ahead(state(1.0, 0.0), 1.0);
        let slow = 3e-6f64;
        assert!((ahead.most[3] / slow.powi(3) - 1.0).abs() < 1e-5, "jerk {} 1/s³", ahead.most[3]);
    }

    #[test]
    fn velocity_vanishes_where_it_is_said_to() {
        for ratio in [0.0, 0.3, 1.0 - 1e-8, 1.0, 1.0 + 1e-8, 1.2, 4.0] {
            let decay: Decay<f64> = Decay::new(13.8 * ratio, 13.8 * 13.8);
            for start in [state(0.01, 0.05), state(-0.002, 0.2), state(0.002, -0.2), state(0.0, 1.0)] {
                let Some(time) = decay.time_to_zero_velocity(start) else {
                    // Without oscillation a motion towards the centre need not turn: it must then never reach zero.
                    assert!(ratio > 1.0 - 1e-6 && start.position * start.velocity < 0.0);
                    continue;
                };
                assert!(time > 0.0);
                let end = decay.advance(start, time);
                assert!(end.velocity.abs() < 1e-15, "ratio {ratio}: {} m/s at {time} s", end.velocity);
                for i in 1..100 {
                    let before = decay.advance(start, time * f64::from(i) / 100.0);
                    assert!(before.velocity * start.velocity > 0.0, "ratio {ratio}: an earlier zero");
                }
            }
        }
    }

    /// Derivative in ω₀² through critical damping against central differences; step 1e-4 of 190, error about 1e-10.
    #[test]
    fn derivatives_pass_through_critical_damping() {
        let rate = 13.8;
        for square in [rate * rate * (1.0 - 1e-7), rate * rate, rate * rate * (1.0 + 1e-7), 150.0, 250.0] {
            let at = |square: f64| {
                let decay = Decay::new(rate, square);
                let time = decay.time_to_zero_velocity(state(0.01, 0.05)).unwrap();
                (time, decay.advance(state(0.01, 0.05), 0.1).position)
            };
            let decay = Decay::new(Dual::<1>::from(rate), Dual::variable(square, 0));
            let start = State { position: Dual::from(0.01), velocity: Dual::from(0.05) };
            let time = decay.time_to_zero_velocity(start).unwrap().partial(0);
            let position = decay.advance(start, Dual::from(0.1)).position.partial(0);
            let h = 1e-4 * square;
            let (above, below) = (at(square + h), at(square - h));
            let slopes = ((above.0 - below.0) / (2.0 * h), (above.1 - below.1) / (2.0 * h));
            assert!((time / slopes.0 - 1.0).abs() < 1e-6, "ω₀² = {square}: {time} against {}", slopes.0);
            assert!((position / slopes.1 - 1.0).abs() < 1e-6, "ω₀² = {square}: {position} against {}", slopes.1);
        }
    }
}
