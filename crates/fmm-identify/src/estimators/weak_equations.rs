//! The equations of the weak form: one number per term and equation, made independent under white noise.

use std::ops::Range;

use fmm_record::Quantity;

use crate::estimators::banded::BandedFactor;
use crate::estimators::test_function::{TestFunction, Weighing};

/// Samples from time 0 on, and the times of zero velocity among them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion<'a> {
    /// Displacement or velocity.
    pub(crate) values: &'a [f64],
    /// Sampling interval (s).
    pub(crate) interval: f64,
    pub(crate) quantity: Quantity,
    /// Increasing (s), at least three.
    pub(crate) reversals: &'a [f64],
}

/// The terms of each equation. Divided by Cholesky's factor of their covariance: white noise of variance 1 in the
/// record leaves residuals that are independent and of variance 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Equations {
    /// ∫w x″.
    pub(crate) inertia: Vec<f64>,
    /// ∫w x′.
    pub(crate) damping: Vec<f64>,
    /// ∫w x, up to what x₀ adds to it.
    pub(crate) position: Vec<f64>,
    /// What the term `position` becomes for a record of 1.
    pub(crate) constant: Vec<f64>,
    /// ∫w sgn x′.
    pub(crate) friction: Vec<f64>,
    /// ∫w |x′| x′; zero for a displacement.
    pub(crate) quadratic: Vec<f64>,
}

/// Equations further apart than this share no sample: each half swing has two, which reach into the next.
const WIDTH: usize = 5;

/// One equation before its noise is known.
struct Equation {
    samples: Range<usize>,
    /// Response of the residual to each of the samples.
    response: Vec<f64>,
    terms: [f64; 6],
}

impl Equations {
    /// The equations of `motion`, their noise being that of about this `damping` (1/s) and `stiffness` (1/s²); the
    /// `offset` enters |x′| x′. `None` if they are not independent.
    pub(crate) fn of(motion: &Motion<'_>, damping: f64, stiffness: f64, offset: f64) -> Option<Self> {
        let rows = motion.equations(damping, stiffness, offset);
        let factor = BandedFactor::of(rows.len(), WIDTH, |i, j| product(&rows[i], &rows[j]))?;
        let column = |term: usize| factor.whiten(&rows.iter().map(|row| row.terms[term]).collect::<Vec<_>>());
        Some(Self {
            inertia: column(0),
            damping: column(1),
            position: column(2),
            constant: column(3),
            friction: column(4),
            quadratic: column(5),
        })
    }
}

/// Sum of the products of two responses where they overlap.
fn product(a: &Equation, b: &Equation) -> f64 {
    let (start, end) = (a.samples.start.max(b.samples.start), a.samples.end.min(b.samples.end));
    if start >= end {
        return 0.0;
    }
    let part = |row: &Equation| start - row.samples.start..end - row.samples.start;
    a.response[part(a)].iter().zip(&b.response[part(b)]).map(|(x, y)| x * y).sum()
}

impl Motion<'_> {
    fn equations(&self, damping: f64, stiffness: f64, offset: f64) -> Vec<Equation> {
        let half_swings: Vec<(f64, f64)> = self.reversals.windows(2).map(|pair| (pair[0], pair[1] - pair[0])).collect();
        let even = |j: usize| TestFunction::new(half_swings[j].0, half_swings[j].1, false);
        let sign = self.first_sign(half_swings.len(), even);
        let sign = |j: usize| if j.is_multiple_of(2) { sign } else { -sign };
        let mut rows = Vec::with_capacity(2 * half_swings.len());
        for (j, &(from, length)) in half_swings.iter().enumerate() {
            let odd = Weighing { terms: vec![(1.0, TestFunction::new(from, length, true))] };
            rows.push(self.equation(&odd, from..from + length, &[sign(j)], [damping, stiffness, offset]));
            if self.quantity == Quantity::Displacement {
                let weighing = Weighing { terms: vec![(1.0, even(j))] };
                rows.push(self.equation(&weighing, from..from + length, &[sign(j)], [damping, stiffness, offset]));
            } else if let Some(&(next, next_length)) = half_swings.get(j + 1) {
                let weighing = Weighing { terms: vec![(-1.0, even(j)), (1.0, even(j + 1))] };
                let signs = [sign(j), sign(j + 1)];
                rows.push(self.equation(&weighing, from..next + next_length, &signs, [damping, stiffness, offset]));
            }
        }
        rows
    }

    /// Order of the derivative that the record is of the position.
    fn order(&self) -> i32 {
        i32::from(self.quantity != Quantity::Displacement)
    }

    /// The samples that an equation over `times` depends on.
    fn samples(&self, times: &Range<f64>) -> Range<usize> {
        let first = (times.start / self.interval).floor().max(0.0) as usize;
        first..((times.end / self.interval).ceil().max(0.0) as usize + 1).min(self.values.len())
    }

    /// Sign of the velocity in the first half swing. The signs alternate, and so an offset does not count.
    fn first_sign(&self, count: usize, even: impl Fn(usize) -> TestFunction) -> f64 {
        let mean_velocity = |j: usize| -> f64 {
            let samples = self.samples(&(self.reversals[j]..self.reversals[j + 1]));
            let weights =
                Weighing { terms: vec![(1.0, even(j))] }.weights(1 - self.order(), samples.clone(), self.interval);
            dot(&weights, &self.values[samples])
        };
        let alternating: f64 =
            (0..count).map(|j| if j.is_multiple_of(2) { mean_velocity(j) } else { -mean_velocity(j) }).sum();
        if alternating < 0.0 { -1.0 } else { 1.0 }
    }

    /// The equation that `weighing` makes of the motion during `times`, with the sign of the velocity for each of its
    /// functions.
    fn equation(
        &self,
        weighing: &Weighing,
        times: Range<f64>,
        signs: &[f64],
        [damping, stiffness, offset]: [f64; 3],
    ) -> Equation {
        let samples = self.samples(&times);
        let weights = |derivative: i32| weighing.weights(derivative - self.order(), samples.clone(), self.interval);
        let [inertia, drag, position] = [weights(2), weights(1), weights(0)];
        let values = &self.values[samples.clone()];
        let friction =
            weighing.terms.iter().zip(signs).map(|((factor, function), sign)| factor * function.area() * sign);
        let quadratic = if self.quantity == Quantity::Displacement {
            0.0
        } else {
            drag.iter().zip(values).map(|(weight, v)| weight * (v - offset).abs() * (v - offset)).sum()
        };
        let response = inertia.iter().zip(&drag).zip(&position);
        Equation {
            response: response.map(|((a, v), x)| a + damping * v + stiffness * x).collect(),
            terms: [
                dot(&inertia, values),
                dot(&drag, values),
                dot(&position, values),
                position.iter().sum(),
                friction.sum(),
                quadratic,
            ],
            samples,
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
