//! Excursion of a model: its values as far from the estimates as the inputs may be.

use crate::gum::derivatives::{Derivatives, Expansion};
use crate::inputs::{Input, Inputs};

/// Half distance of three points with the weights 1/6, 2/3, 1/6, which have the mean and the variance of a normal
/// quantity.
const SQRT_3: f64 = 1.732_050_807_568_877_2;
/// Roundings that a model may have made of its inputs.
const ROUNDINGS: f64 = 16.0;

/// Distance of an output from its expansion, along all directions together.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Departure {
    /// Departure of the mean (unit of the output).
    pub(crate) mean: f64,
    /// Departure of the variance (square of the unit).
    pub(crate) variance: f64,
    /// Largest move of the output itself (unit of the output), roundings not counted.
    pub(crate) moved: f64,
}

impl Departure {
    /// True if it changes an uncertainty and an estimate by no more than the share `tolerated` (1) of the uncertainty.
    pub(crate) fn is_tolerable(self, standard_uncertainty: f64, tolerated: f64) -> bool {
        let tolerated = tolerated * standard_uncertainty;
        // 2 u Δu.
        self.mean <= tolerated && self.variance <= 2.0 * standard_uncertainty * tolerated
    }
}

/// The points at √3 standard uncertainties on both sides along each direction, or at the limits of the inputs if those
/// are nearer.
///
/// An expansion is made at a point, where a kink, a pole or a high power is not to be seen. With r the difference of
/// model and expansion at a distance of ±h, the three-point rule gives its effect:
///
/// ```text
/// ΔE = (r₊ + r₋)/2h²,   ΔV = g (r₊ − r₋)/h + (r₊² + r₋²)/2h²
/// ```
pub(crate) struct Excursion<'a, M> {
    inputs: &'a Inputs,
    model: &'a M,
    /// Values of the outputs at the estimates.
    values: &'a [f64],
    /// Bound of the rounding of each output (its unit).
    roundings: Vec<f64>,
}

impl<'a, M: Derivatives> Excursion<'a, M> {
    pub(crate) fn new(inputs: &'a Inputs, model: &'a M, values: &'a [f64], sensitivities: &[Vec<f64>]) -> Self {
        let size = |(value, slopes): (&f64, &Vec<f64>)| {
            let part = |(slope, input): (&f64, &Input)| {
                slope.abs() * (input.value().abs() + SQRT_3 * input.standard_uncertainty())
            };
            let sum: f64 = slopes.iter().zip(inputs.as_slice()).map(part).sum();
            ROUNDINGS * f64::EPSILON * (sum + value.abs())
        };
        let roundings = values.iter().zip(sensitivities).map(size).collect();
        Self { inputs, model, values, roundings }
    }

    /// Bound of the rounding of an output (its unit).
    pub(crate) fn rounding(&self, output: usize) -> f64 {
        self.roundings[output]
    }

    /// Adds the departures along a direction, by output; false if the model has no value there.
    pub(crate) fn along(&self, direction: &[f64], own: &[Expansion], departures: &mut [Departure]) -> bool {
        let distance = self.distance(direction);
        let (Some(above), Some(below)) = (self.at(direction, distance), self.at(direction, -distance)) else {
            return false;
        };
        let h = distance;
        for (k, (departure, e)) in departures.iter_mut().zip(own).enumerate() {
            let beyond = |found: f64, h: f64| {
                let moved = found - self.values[k];
                let expected = h * (e.a + h * (0.5 * e.aa + h * (e.aaa / 6.0)));
                let own = self.roundings[k] + ROUNDINGS * f64::EPSILON * (moved.abs() + expected.abs());
                (beyond_rounding(moved, self.roundings[k]), beyond_rounding(moved - expected, own))
            };
            let ((first, above), (second, below)) = (beyond(above[k], h), beyond(below[k], -h));
            departure.moved = departure.moved.max(first.abs()).max(second.abs());
            departure.mean += ((above + below) / (2.0 * h * h)).abs();
            departure.variance += (e.a * (above - below) / h + (above * above + below * below) / (2.0 * h * h)).abs();
        }
        true
    }

    /// The same for all directions at once, to unequal distances: effects of several inputs together.
    pub(crate) fn together(&self, directions: &[Vec<f64>], departures: &mut [Departure]) -> bool {
        for turn in [1.0, -1.0] {
            let mut all = vec![0.0; self.inputs.as_slice().len()];
            let mut sign = 1.0;
            for (m, direction) in directions.iter().enumerate() {
                // Distances in no simple ratio, so that nothing cancels by the choice of points.
                let part = sign * (0.5 + 0.5 * (0.618_034 * (m as f64 + 1.0)).fract());
                all.iter_mut().zip(direction).for_each(|(sum, step)| *sum += part * step);
                sign *= turn;
            }
            let Some(found) = self.at(&all, self.distance(&all)) else { return false };
            for (k, departure) in departures.iter_mut().enumerate() {
                let moved = beyond_rounding(found[k] - self.values[k], self.roundings[k]);
                departure.moved = departure.moved.max(moved.abs());
            }
        }
        true
    }

    /// √3 or as far as all inputs can go on both sides.
    fn distance(&self, direction: &[f64]) -> f64 {
        let inputs = self.inputs.as_slice().iter().zip(direction).filter(|(_, step)| **step != 0.0);
        inputs.fold(SQRT_3, |h, (input, step)| {
            let (low, high) = input.distribution().limits();
            h.min((input.value() - low).min(high - input.value()) / step.abs())
        })
    }

    fn at(&self, direction: &[f64], distance: f64) -> Option<Vec<f64>> {
        if !(distance.abs() > 0.0) {
            return None;
        }
        let inputs = self.inputs.as_slice().iter().zip(direction);
        let place = |(input, step): (&Input, &f64)| {
            // A limit may be missed by a rounding.
            let (low, high) = input.distribution().limits();
            if *step == 0.0 { input.value() } else { (input.value() + distance * step).max(low).min(high) }
        };
        let outputs = self.model.outputs_at(&inputs.map(place).collect::<Vec<_>>())?;
        (outputs.len() == self.values.len() && outputs.iter().all(|y| y.is_finite())).then_some(outputs)
    }
}

/// Part of a difference that rounding cannot have made.
fn beyond_rounding(difference: f64, rounding: f64) -> f64 {
    if difference.abs() <= rounding { 0.0 } else { difference }
}
