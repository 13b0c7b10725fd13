//! Responses of a linear machine at rest, without a division by its stiffness.

use fmm_model::Scalar;

/// x″ + 2a x′ + ω₀² x = f/m, with or without a spring.
#[derive(Debug, Clone, Copy)]
pub(super) struct Linear<D> {
    /// 2a (1/s).
    pub(super) damping: D,
    /// ω₀² (1/s²).
    pub(super) square: D,
}

/// Motion of a machine from rest within a time τ after an acceleration from outside that is an impulse, a step or a ramp.
///
/// ```text
/// g₁″ + 2a g₁′ + ω₀² g₁ = 0,   g₁(0) = 0,   g₁′(0) = 1,   g₂ = ∫ g₁,   g₃ = ∫ g₂
/// ```
///
/// Near τ = 0 these are τ, τ²/2 and τ³/6. In them the motion from any state has no terms that cancel, however weak the
/// spring is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Response<D> {
    /// g₁ (s).
    pub(super) impulse: D,
    /// g₁′ (1).
    pub(super) impulse_slope: D,
    /// g₂ (s²).
    pub(super) step: D,
    /// g₃ (s³).
    pub(super) ramp: D,
}

/// 2a τ and ω₀ τ up to which the power series are taken (1).
const NEAR: f64 = 0.5;
/// Terms of the series: the next is below 0.5¹⁶/16! < 1e-18.
const TERMS: usize = 17;

/// 1/n.
const RECIPROCALS: [f64; TERMS + 2] = {
    let mut reciprocals = [1.0; TERMS + 2];
    let mut n = 1;
    while n < reciprocals.len() {
        reciprocals[n] = 1.0 / n as f64;
        n += 1;
    }
    reciprocals
};

impl<D: Scalar> Linear<D> {
    /// The machine without derivatives.
    pub(super) fn plain(&self) -> Linear<f64> {
        Linear { damping: self.damping.value(), square: self.square.value() }
    }

    /// The responses after a time `elapsed` (s).
    pub(super) fn respond(&self, elapsed: D) -> Response<D> {
        let turn = self.square.value().sqrt();
        let mut size = elapsed.value() * self.damping.value().abs().max(turn);
        let (mut halvings, mut part) = (0, elapsed);
        // One that is not finite is not halved, and found by its result.
        while size > NEAR && size.is_finite() {
            size *= 0.5;
            part *= 0.5;
            halvings += 1;
        }
        let Response { mut impulse, mut step, mut ramp, .. } = self.series(part);
        for _ in 0..halvings {
            // The motion goes on from the state after the first half.
            let spring = self.square * step;
            let twice = -(self.damping * impulse) - spring * 2.0 + 2.0;
            ramp = ramp * (-spring + 2.0) + impulse * step + part * step;
            step = step * (-spring + 2.0) + impulse * impulse;
            impulse *= twice;
            part *= 2.0;
        }
        let impulse_slope = -(self.damping * impulse) - self.square * step + 1.0;
        Response { impulse, impulse_slope, step, ramp }
    }

    /// Responses soon after the beginning: n (n + 1) tₙ₊₁ = −2aτ n tₙ − ω₀²τ² tₙ₋₁ for the terms of g₁, and t₁ = τ.
    fn series(&self, elapsed: D) -> Response<D> {
        let (damping, square) = (self.damping * elapsed, self.square * elapsed * elapsed);
        let zero = D::from(0.0);
        let (mut before, mut term) = (zero, elapsed);
        let (mut impulse, mut step, mut ramp) = (zero, zero, zero);
        for n in 1..TERMS {
            let [this, next] = [RECIPROCALS[n], RECIPROCALS[n + 1]];
            impulse += term;
            step += term * next;
            ramp += term * (next * RECIPROCALS[n + 2]);
            (before, term) = (term, -(damping * term + square * before * this) * next);
        }
        let (step, ramp) = (step * elapsed, ramp * elapsed * elapsed);
        let impulse_slope = -(self.damping * impulse) - self.square * step + 1.0;
        Response { impulse, impulse_slope, step, ramp }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without a spring, and without anything, the responses are elementary; with it they are those of the oscillation.
    #[test]
    fn responses_are_those_of_the_closed_forms() {
        for elapsed in [1e-6, 1e-3, 0.3, 2.0, 40.0] {
            let free = Linear { damping: 0.0, square: 0.0 }.respond(elapsed);
            let expected = [elapsed, 1.0, elapsed.powi(2) / 2.0, elapsed.powi(3) / 6.0];
            near(free, expected, 4.0, "free");
            let damping = 3.0;
            let left: f64 = (-damping * elapsed).exp();
            let gone = -f64::exp_m1(-damping * elapsed);
            let damped = Linear { damping, square: 0.0 }.respond(elapsed);
            // The closed form of g₂ loses its digits at small times, where the series has them; g₁′ is what is left of 1.
            let step = if elapsed < 0.1 { f64::NAN } else { elapsed / damping - gone / damping.powi(2) };
            near(damped, [gone / damping, f64::NAN, step, f64::NAN], 40.0, "damped");
            assert!((damped.impulse_slope - left).abs() < 8.0 * f64::EPSILON);
            let angular = 2.0f64;
            let spring = Linear { damping: 0.0, square: angular * angular }.respond(elapsed);
            let (sin, cos) = (angular * elapsed).sin_cos();
            let half = (0.5 * angular * elapsed).sin();
            let rounding = 8.0 * (1.0 + angular * elapsed);
            let size = 1.0 / angular;
            assert!((spring.impulse - sin / angular).abs() < rounding * f64::EPSILON * size.min(elapsed));
            assert!((spring.impulse_slope - cos).abs() < rounding * f64::EPSILON);
            let step = 2.0 * (half / angular).powi(2);
            assert!((spring.step - step).abs() < rounding * f64::EPSILON * (size * size).min(elapsed * elapsed));
        }
    }

    /// Responses (their digits within a number of roundings) against expected ones, NaN where nothing is known.
    fn near(found: Response<f64>, expected: [f64; 4], roundings: f64, what: &str) {
        let found = [found.impulse, found.impulse_slope, found.step, found.ramp];
        for (found, expected) in found.into_iter().zip(expected) {
            let near = (found - expected).abs() <= roundings * f64::EPSILON * expected.abs().max(f64::MIN_POSITIVE);
            assert!(near || expected.is_nan(), "{what}: {found} instead of {expected}");
        }
    }

    /// A heavily damped machine creeps: neither the fast part nor the doublings leave their rounding in the slow one.
    #[test]
    fn heavy_damping_keeps_the_slow_motion() {
        let (damping, square) = (1e6, 9.0f64);
        let fast = 0.5 * (damping + (damping * damping - 4.0 * square).sqrt());
        let slow = square / fast;
        for elapsed in [1.0, 1e3, 1e5] {
            let response = Linear { damping, square }.respond(elapsed);
            let expected = (-slow * elapsed).exp() / (fast - slow);
            let error = (response.impulse / expected - 1.0).abs();
            assert!(error < 1e-11, "{error} of the impulse after {elapsed} s");
            // ω₀² g₂ = 1 − (f e^(−st) − s e^(−ft))/(f − s) with the fast part gone.
            let expected = (-f64::exp_m1(-slow * elapsed) * fast - slow) / (fast - slow) / square;
            let error = (response.step / expected - 1.0).abs();
            assert!(error < 1e-11, "{error} of the step after {elapsed} s");
        }
    }
}
