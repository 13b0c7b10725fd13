//! Friction of a record from the weak form of the equation of motion.

use std::f64::consts::PI;
use std::ops::Range;

use fmm_fit::{LinearRegression, Weighting};
use fmm_model::Oscillator;
use fmm_record::Record;
use nalgebra::{DMatrix, DVector};

use crate::Found;

/// Friction without a derivative of the record, without smoothing and without an initial position.
///
/// The equation of motion is multiplied by test functions w and integrated by parts, so that all derivatives and
/// integrals of the record turn into derivatives and integrals of w:
///
/// ```text
/// x″ + (c/m) x′ + (k/m)(x − x₀) + (F/m) sgn x′ = 0
///
/// ∫w x″ + (c/m) ∫w x′ + (k/m)(∫w x − x₀) ± F/m = 0        w = 2/L sin² πτ over each half cycle
/// ∫w x″ + (c/m) ∫w x′ + (k/m) ∫w x             = 0        w = 4/L sin² πτ cos πτ
/// ```
///
/// w vanishes where the velocity changes its sign, so that the times of reversals need not be known well. The
/// differences of neighbouring half cycles are taken: x₀ drops out, and what noise adds to the position does not add
/// up. The equations are weighted by their covariance under white noise. An offset of the velocity drifts the position
/// and is found as that. Mass, stiffness and damping are known, as for the energy method.
///
/// # References
/// M. Shinbrot, "On the analysis of linear and nonlinear systems", Trans. ASME 79 (1957) 547 (method of modulating
/// functions).
#[derive(Debug, Clone, Copy)]
pub(super) struct WeakForm {
    mass: f64,
    /// c/m (1/s).
    damping: f64,
    /// k/m (1/s²).
    stiffness: f64,
}

impl WeakForm {
    /// For a machine that is known.
    pub(super) fn new(oscillator: &Oscillator) -> Self {
        let mass = oscillator.mass();
        let damping = oscillator.damping().linear_coefficient() / mass;
        Self { mass, damping, stiffness: (2.0 * PI * oscillator.natural_frequency()).powi(2) }
    }

    /// Friction force (N) in a velocity `record` without offset that begins at time 0, between `reversals`, times of
    /// zero velocity (s).
    pub(super) fn friction(&self, record: &Record, reversals: &[f64]) -> Found<f64> {
        Ok(self.solve(record, reversals, false)?[0])
    }

    /// Friction force (N), and offset (m/s) of the record.
    pub(super) fn friction_and_offset(&self, record: &Record, reversals: &[f64]) -> Found<(f64, f64)> {
        let found = self.solve(record, reversals, true)?;
        Ok((found[0], found[1]))
    }

    fn solve(&self, record: &Record, reversals: &[f64], fits_offset: bool) -> Found<Vec<f64>> {
        let equations = self.equations(record, reversals);
        let covariance = DMatrix::from_fn(equations.len(), equations.len(), |i, j| equations[i].overlap(&equations[j]));
        let factor = covariance.cholesky().ok_or("the equations are not independent")?.unpack();
        let white = |of: fn(&Equation) -> f64| -> Found<Vec<f64>> {
            let column = DVector::from_iterator(equations.len(), equations.iter().map(of));
            let white = factor.solve_lower_triangular(&column).ok_or("the equations are not independent")?;
            Ok(white.as_slice().to_vec())
        };
        let rest: Vec<f64> = white(|equation| equation.rest)?.iter().map(|rest| -rest).collect();
        let friction = white(|equation| equation.friction)?;
        let drift = white(|equation| equation.drift)?;
        let mut columns = vec![("friction", friction.as_slice())];
        if fits_offset {
            columns.push(("offset", drift.as_slice()));
        }
        let found = LinearRegression::fit(&columns, &rest, Weighting::Equal)?;
        let scales = [self.mass, 1.0];
        Ok(found.coefficients().iter().zip(scales).map(|(value, scale)| value * scale).collect())
    }

    /// Two equations for each half cycle: an odd test function within it, and an even one in it less one in the next.
    fn equations(&self, record: &Record, reversals: &[f64]) -> Vec<Equation> {
        let halves: Vec<(f64, f64)> = reversals.windows(2).map(|pair| (pair[0], pair[1] - pair[0])).collect();
        let test = |j: usize, is_odd: bool| TestFunction { from: halves[j].0, length: halves[j].1, is_odd };
        // The signs of the velocity alternate.
        let alternating: f64 = (0..halves.len())
            .map(|j| {
                let samples = samples(record, reversals[j]..reversals[j + 1]);
                let weights = weights(&[(1.0, test(j, false))], 0, samples.clone(), record.interval());
                let mean = dot(&weights, &record.values()[samples]);
                if j.is_multiple_of(2) { mean } else { -mean }
            })
            .sum();
        let first = if alternating < 0.0 { -1.0 } else { 1.0 };
        let mut equations = Vec::with_capacity(2 * halves.len());
        for j in 0..halves.len() {
            let sign = if j.is_multiple_of(2) { first } else { -first };
            equations.push(self.equation(record, &[(1.0, test(j, true))], reversals[j]..reversals[j + 1], 0.0));
            if j + 1 < halves.len() {
                let terms = [(-1.0, test(j, false)), (1.0, test(j + 1, false))];
                equations.push(self.equation(record, &terms, reversals[j]..reversals[j + 2], -2.0 * sign));
            }
        }
        equations
    }

    /// The equation of a sum of test functions during `times`, in which F/m has the factor `friction`.
    fn equation(&self, record: &Record, terms: &[(f64, TestFunction)], times: Range<f64>, friction: f64) -> Equation {
        let samples = samples(record, times);
        let weights = |derivative: i32| weights(terms, derivative, samples.clone(), record.interval());
        let [inertia, drag, position] = [weights(1), weights(0), weights(-1)];
        let response = inertia.iter().zip(&drag).zip(&position);
        let response: Vec<f64> = response.map(|((a, v), x)| a + self.damping * v + self.stiffness * x).collect();
        Equation {
            rest: dot(&response, &record.values()[samples.clone()]),
            drift: -self.stiffness * position.iter().sum::<f64>(),
            friction,
            first: samples.start,
            response,
        }
    }
}

/// One equation: rest + drift · offset + friction · F/m = 0.
struct Equation {
    rest: f64,
    drift: f64,
    friction: f64,
    /// Response of `rest` to each of the samples from the `first` on.
    response: Vec<f64>,
    first: usize,
}

impl Equation {
    /// Covariance of two equations under white noise of variance 1.
    fn overlap(&self, other: &Self) -> f64 {
        let (start, end) = (self.first.max(other.first), (self.end()).min(other.end()));
        if start >= end {
            return 0.0;
        }
        let part = |one: &Self| start - one.first..end - one.first;
        dot(&self.response[part(self)], &other.response[part(other)])
    }

    fn end(&self) -> usize {
        self.first + self.response.len()
    }
}

/// The samples that an equation over `times` depends on.
fn samples(record: &Record, times: Range<f64>) -> Range<usize> {
    let first = (times.start / record.interval()).floor().max(0.0) as usize;
    first..((times.end / record.interval()).ceil().max(0.0) as usize + 1).min(record.len())
}

/// A function of time that vanishes with its slope at both ends of an interval, and outside.
///
/// ```text
/// even   w = (1 − cos 2πτ)/L = 2/L sin² πτ                 ∫w = 1
/// odd    w = (cos πτ − cos 3πτ)/L = 4/L sin² πτ cos πτ      ∫w = 0,        τ = (t − from)/L
/// ```
///
/// The even one weighs friction. The odd one is blind to it and to any constant, and weighs inertia against stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TestFunction {
    /// Begin and length of the interval (s).
    from: f64,
    length: f64,
    is_odd: bool,
}

impl TestFunction {
    /// The `order`-fold integral of w from before the interval up to `time` (s); orders 0 to 3.
    fn integral(&self, order: i32, time: f64) -> f64 {
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

/// Weights of `samples`, every `interval` (s) from time 0 on, whose sum with samples y is the integral of a sum of test
/// functions against a derivative of y (negative: an integral of y), y being straight between samples.
///
/// ```text
/// ∫ w Dᵏy dt = (−1)ᵏ Σ y_i (W(t_{i+1}) − 2W(t_i) + W(t_{i−1}))/h,      W the (2−k)-fold integral of w
/// ```
///
/// No derivative of the samples is taken; all of them were moved to w by parts. All terms of an equation are treated
/// alike: the error of the straight lines is one factor in each and cancels.
fn weights(terms: &[(f64, TestFunction)], derivative: i32, samples: Range<usize>, interval: f64) -> Vec<f64> {
    let sign = if derivative % 2 == 0 { 1.0 } else { -1.0 };
    let at = |i: f64| -> f64 {
        terms.iter().map(|(factor, function)| factor * function.integral(2 - derivative, i * interval)).sum()
    };
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

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chapter_6_energy::{Example, friction};
    use crate::ring_down::tests::{close, statistics};
    use crate::ring_down::{velocity_record, with_noise};

    /// Chapter 6 with m, k and c known and x₀ unknown: 0.0001, 0.0007 and 0.006 N at 0.01, 0.1 and 1 mm/s.
    #[test]
    fn friction_of_chapter_six() {
        const REPETITIONS: u64 = 200;
        let example = Example::new().unwrap();
        let weak = WeakForm::new(example.scenario.oscillator());
        let estimate = |noise: f64, seed: u64| {
            let values = with_noise(example.contact.velocity().values(), noise, seed).unwrap();
            weak.friction(&velocity_record(values).unwrap(), &example.reversals).unwrap()
        };
        // (2π/455)²/24 relative.
        close(estimate(0.0, 0), friction(), 1e-5, "clean friction (N)");
        for (noise, printed) in [(1e-5, 0.0001), (1e-4, 0.0007), (1e-3, 0.006)] {
            let all: Vec<f64> = (0..REPETITIONS).map(|seed| estimate(noise, seed)).collect();
            let (mean, deviation) = statistics(&all);
            // Weighted by their covariance, the equations leave half of what the table has.
            assert!(deviation < printed, "{noise} m/s: std {deviation} N, printed {printed} N");
            assert!((mean - friction()).abs() < 4.0 * deviation / (REPETITIONS as f64).sqrt() + 2e-5, "mean {mean} N");
        }
    }

    #[test]
    fn an_offset_is_found() {
        let example = Example::new().unwrap();
        let shifted = example.contact.velocity().values().iter().map(|v| v + 1e-4).collect();
        let weak = WeakForm::new(example.scenario.oscillator());
        let (force, offset) = weak.friction_and_offset(&velocity_record(shifted).unwrap(), &example.reversals).unwrap();
        close(force, friction(), 1e-4, "friction (N)");
        close(offset, 1e-4, 1e-2, "offset (m/s)");
    }

    /// Each integral is the sum of the one below it, by Simpson's rule, also beyond the interval.
    #[test]
    fn integrals_follow_from_each_other() {
        for is_odd in [false, true] {
            let function = TestFunction { from: 0.3, length: 0.7, is_odd };
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
            let area = if is_odd { 0.0 } else { 1.0 };
            assert!((function.integral(1, 5.0) - area).abs() < 1e-15);
        }
    }

    /// Against y = t³ on a fine grid: ∫ w y″ = ∫ 6 w t and so on, by parts.
    #[test]
    fn weights_integrate_by_parts() {
        let (interval, count) = (1e-3, 1000);
        let even = TestFunction { from: 0.2004, length: 0.5, is_odd: false };
        let samples: Vec<f64> = (0..count).map(|i| f64::from(i) * interval).collect();
        let sum = |derivative: i32, y: &dyn Fn(f64) -> f64| -> f64 {
            let weights = weights(&[(1.0, even)], derivative, 0..count as usize, interval);
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
