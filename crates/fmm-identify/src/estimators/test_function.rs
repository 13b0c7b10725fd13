//! Test functions of the weak form, and the weights that integrals against them give to samples.

use std::f64::consts::PI;

/// A function of time that vanishes with its slope at both ends of an interval, and outside.
///
/// ```text
/// even   w = (1 − cos 2πτ)/L = 2/L sin² πτ                 ∫w = 1
/// odd    w = (cos πτ − cos 3πτ)/L = 4/L sin² πτ cos πτ      ∫w = 0,        τ = (t − from)/L
/// ```
///
/// The even one weighs friction. The odd one is blind to it and to any constant, and weighs inertia against stiffness,
/// both of which are odd about the middle of a half swing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TestFunction {
    from: f64,
    length: f64,
    is_odd: bool,
}

impl TestFunction {
    /// On the interval of `length` (s) that begins at `from` (s).
    pub(crate) fn new(from: f64, length: f64, is_odd: bool) -> Self {
        Self { from, length, is_odd }
    }

    /// ∫w over all times (1).
    pub(crate) fn area(&self) -> f64 {
        if self.is_odd { 0.0 } else { 1.0 }
    }

    /// The `order`-fold integral of w from before the interval up to `time` (s); orders 0 to 3.
    pub(crate) fn integral(&self, order: i32, time: f64) -> f64 {
        let tau = (time - self.from) / self.length;
        if tau <= 0.0 {
            return 0.0;
        }
        let beyond = (tau - 1.0).max(0.0);
        let unit = if self.is_odd { odd(order, tau.min(1.0), beyond) } else { even(order, tau.min(1.0), beyond) };
        unit * self.length.powi(order - 1)
    }
}

fn even(order: i32, tau: f64, beyond: f64) -> f64 {
    let (sin, cos) = (2.0 * PI * tau).sin_cos();
    match order {
        0 if beyond > 0.0 => 0.0,
        0 => 1.0 - cos,
        1 => tau - sin / (2.0 * PI),
        2 => 0.5 * tau * tau - (1.0 - cos) / (4.0 * PI * PI) + beyond,
        _ => tau.powi(3) / 6.0 + (sin / (2.0 * PI) - tau) / (4.0 * PI * PI) + 0.5 * beyond + 0.5 * beyond * beyond,
    }
}

fn odd(order: i32, tau: f64, beyond: f64) -> f64 {
    let ((sin, cos), (sin3, cos3)) = ((PI * tau).sin_cos(), (3.0 * PI * tau).sin_cos());
    match order {
        0 if beyond > 0.0 => 0.0,
        0 => cos - cos3,
        1 => (sin - sin3 / 3.0) / PI,
        2 => (cos3 / 9.0 - cos + 8.0 / 9.0) / (PI * PI),
        _ => (sin3 / 27.0 - sin + 8.0 / 9.0 * PI * tau) / PI.powi(3) + 16.0 / 9.0 / (PI * PI) * beyond,
    }
}

/// A sum of test functions: what one equation of the weak form is multiplied by.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Weighing {
    pub(crate) terms: Vec<(f64, TestFunction)>,
}

impl Weighing {
    fn integral(&self, order: i32, time: f64) -> f64 {
        self.terms.iter().map(|(factor, function)| factor * function.integral(order, time)).sum()
    }

    /// The weights of samples first, first + 1, … every `interval` (s) from time 0 on, such that their sum with samples
    /// y is the integral of w against a derivative of y (negative: an integral of y), y being straight between samples.
    ///
    /// ```text
    /// ∫ w Dᵏy dt = (−1)ᵏ Σ y_i (W(t_{i+1}) − 2W(t_i) + W(t_{i−1}))/h,      W the (2−k)-fold integral of w
    /// ```
    ///
    /// No derivative of the samples is taken; all of them were moved to w by parts. As all terms of an equation are
    /// treated alike, the error of the straight lines is the same factor in each and cancels.
    pub(crate) fn weights(&self, derivative: i32, samples: std::ops::Range<usize>, interval: f64) -> Vec<f64> {
        let order = 2 - derivative;
        let sign = if derivative % 2 == 0 { 1.0 } else { -1.0 };
        let at = |i: f64| self.integral(order, i * interval);
        let first = samples.start as f64;
        let (mut before, mut here) = (at(first - 1.0), at(first));
        samples
            .map(|i| {
                let after = at(i as f64 + 1.0);
                let weight = sign * ((after - here) - (here - before)) / interval;
                (before, here) = (here, after);
                weight
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each integral is the sum of the one below it, by Simpson's rule, also beyond the interval.
    #[test]
    fn integrals_follow_from_each_other() {
        for is_odd in [false, true] {
            let function = TestFunction::new(0.3, 0.7, is_odd);
            for order in 0..3 {
                let mut sum = 0.0;
                let step = 1e-3;
                for i in 0..1500 {
                    let t = step * f64::from(i);
                    let piece = function.integral(order, t)
                        + 4.0 * function.integral(order, t + 0.5 * step)
                        + function.integral(order, t + step);
                    sum += piece * step / 6.0;
                    let expected = function.integral(order + 1, t + step);
                    // The ends of the interval lie on the grid; Simpson's error is h⁴ times the fourth derivative.
                    assert!((sum - expected).abs() < 1e-9, "odd {is_odd}, order {order}, {t} s: {sum} {expected}");
                }
            }
            assert!((function.integral(1, 5.0) - function.area()).abs() < 1e-15);
        }
    }

    /// Against y = t³ on a fine grid: ∫ w y″ = ∫ 6 w t and so on, by parts.
    #[test]
    fn weights_integrate_by_parts() {
        let (interval, count) = (1e-3, 1000);
        let even = TestFunction::new(0.2004, 0.5, false);
        let weighing = Weighing { terms: vec![(1.0, even)] };
        let samples: Vec<f64> = (0..count).map(|i| f64::from(i) * interval).collect();
        let sum = |derivative: i32, y: &dyn Fn(f64) -> f64| -> f64 {
            let weights = weighing.weights(derivative, 0..count as usize, interval);
            weights.iter().zip(&samples).map(|(w, t)| w * y(*t)).sum()
        };
        let middle = 0.4504;
        assert!((sum(0, &|_| 1.0) - 1.0).abs() < 1e-12, "{}", sum(0, &|_| 1.0));
        assert!((sum(0, &|t| t) - middle).abs() < 1e-12, "{}", sum(0, &|t| t));
        assert!((sum(1, &|t| t * t) - 2.0 * middle).abs() < 1e-12, "{}", sum(1, &|t| t * t));
        // A cubic is off by h²/12 of its own third derivative at most.
        assert!((sum(2, &|t| t * t * t) - 6.0 * middle).abs() < 1e-6, "{}", sum(2, &|t| t * t * t));
    }
}
