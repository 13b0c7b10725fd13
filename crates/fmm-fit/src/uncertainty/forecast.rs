//! Forecast of a minimum for other fixed values, without a fit.

/// The estimates as a polynomial in the inputs about those of a fit.
///
/// ```text
/// θ ≈ θ₀ + Σᵢ Σₙ aᵢₙ tᵢⁿ + Σᵢ<ₖ (b₁₁ tᵢ tₖ + b₂₁ tᵢ² tₖ + b₁₂ tᵢ tₖ² + b₂₂ tᵢ² tₖ²),     tᵢ = (αᵢ − αᵢ₀)/uᵢ,   n ≤ 4
/// ```
///
/// Only first powers are known until the estimates at some inputs are given.
#[derive(Debug, Clone)]
pub(super) struct Forecast {
    centre: Vec<f64>,
    inputs: Vec<f64>,
    /// u, which is 1 of each input's unit as long as only slopes are known.
    spread: Vec<f64>,
    /// a, estimate by estimate and input by input.
    axes: Vec<[f64; 4]>,
    /// b, estimate by estimate and pair by pair.
    pairs: Vec<[f64; 4]>,
}

/// An input that is moved, and by how many of its spreads.
type Move = (usize, f64);

impl Forecast {
    /// The straight lines through the estimates `centre` at `inputs` with the `slopes` ∂θ/∂α, estimate by estimate.
    pub(super) fn straight(centre: Vec<f64>, inputs: Vec<f64>, slopes: &[f64]) -> Self {
        let axes = slopes.iter().map(|slope| [*slope, 0.0, 0.0, 0.0]).collect();
        Self { centre, spread: vec![1.0; inputs.len()], inputs, axes, pairs: Vec::new() }
    }

    /// The same for these of its inputs, in this order.
    pub(super) fn of_inputs(&self, places: &[usize]) -> Self {
        let slopes: Vec<f64> =
            (0..self.centre.len()).flat_map(|j| places.iter().map(move |&place| self.slope(j, place))).collect();
        Self::straight(self.centre.clone(), places.iter().map(|&place| self.inputs[place]).collect(), &slopes)
    }

    /// ∂θ/∂α.
    fn slope(&self, estimate: usize, input: usize) -> f64 {
        self.axes[estimate * self.inputs.len() + input][0] / self.spread[input]
    }

    /// Through the estimates that `fit` finds at one and two of `spread` either way of each input, and one of each
    /// pair; straight for an input whose spread is zero.
    pub(super) fn through<E>(
        &self,
        spread: &[f64],
        mut fit: impl FnMut(&[f64]) -> Result<Vec<f64>, E>,
    ) -> Result<Self, E> {
        let mut at = |moves: &[Move]| {
            let mut inputs = self.inputs.clone();
            for &(input, steps) in moves {
                inputs[input] += steps * spread[input];
            }
            fit(&inputs)
        };
        let (count, outputs) = (spread.len(), self.centre.len());
        let centre = at(&[])?;
        let mut axes = vec![[0.0; 4]; outputs * count];
        for input in 0..count {
            if spread[input] == 0.0 {
                for j in 0..outputs {
                    axes[j * count + input][0] = self.slope(j, input);
                }
                continue;
            }
            let [far_below, below, above, far_above] =
                [at(&[(input, -2.0)])?, at(&[(input, -1.0)])?, at(&[(input, 1.0)])?, at(&[(input, 2.0)])?];
            for (j, centre) in centre.iter().enumerate() {
                // Odd and even parts at one and two spreads.
                let (odd, odd_far) = (0.5 * (above[j] - below[j]), 0.5 * (far_above[j] - far_below[j]));
                let even = 0.5 * (above[j] + below[j]) - centre;
                let even_far = 0.5 * (far_above[j] + far_below[j]) - centre;
                let (third, fourth) = ((odd_far - 2.0 * odd) / 6.0, (even_far - 4.0 * even) / 12.0);
                axes[j * count + input] = [odd - third, even - fourth, third, fourth];
            }
        }
        let mut bent = Self { centre, inputs: self.inputs.clone(), spread: units(spread), axes, pairs: Vec::new() };
        let mut pairs = Vec::new();
        for (first, second) in places(count) {
            if spread[first] == 0.0 || spread[second] == 0.0 {
                pairs.push(vec![[0.0; 4]; outputs]);
                continue;
            }
            let mut rest = |steps: f64, other_steps: f64| -> Result<Vec<f64>, E> {
                let mut rest = at(&[(first, steps), (second, other_steps)])?;
                for (j, rest) in rest.iter_mut().enumerate() {
                    let alone = |input: usize, steps| power_sum(&bent.axes[j * count + input], steps);
                    *rest -= bent.centre[j] + alone(first, steps) + alone(second, other_steps);
                }
                Ok(rest)
            };
            let [both, only_first, only_second, neither] =
                [rest(1.0, 1.0)?, rest(1.0, -1.0)?, rest(-1.0, 1.0)?, rest(-1.0, -1.0)?];
            pairs.push(
                (0..outputs)
                    .map(move |j| {
                        let [a, b, c, d] = [both[j], only_first[j], only_second[j], neither[j]].map(|rest| 0.25 * rest);
                        [a - b - c + d, a - b + c - d, a + b - c - d, a + b + c + d]
                    })
                    .collect::<Vec<_>>(),
            );
        }
        bent.pairs = (0..outputs).flat_map(|j| pairs.iter().map(move |pair| pair[j])).collect();
        Ok(bent)
    }

    /// Standard deviations of the estimates over independent inputs of the standard deviations `spread`, to first
    /// order.
    pub(super) fn deviations(&self, spread: &[f64]) -> Vec<f64> {
        let variance = |estimate: usize| -> f64 {
            spread.iter().enumerate().map(|(input, u)| (self.slope(estimate, input) * u).powi(2)).sum()
        };
        (0..self.centre.len()).map(|estimate| variance(estimate).sqrt()).collect()
    }

    /// The estimates foreseen at `inputs`, one after the other.
    pub(super) fn at<'f>(&'f self, inputs: &'f [f64]) -> impl Iterator<Item = f64> + 'f {
        let count = self.inputs.len();
        let moved = move |input: usize| (inputs[input] - self.inputs[input]) / self.spread[input];
        self.centre.iter().enumerate().map(move |(j, centre)| {
            let alone: f64 = (0..count).map(|input| power_sum(&self.axes[j * count + input], moved(input))).sum();
            let pairs = self.pairs.len() / self.centre.len().max(1);
            let together = places(count).zip(&self.pairs[j * pairs..(j + 1) * pairs]).map(|((first, second), b)| {
                let (t, s) = (moved(first), moved(second));
                t * s * (b[0] + b[1] * t + b[2] * s + b[3] * t * s)
            });
            centre + alone + together.sum::<f64>()
        })
    }
}

/// Units of changes: spreads, or 1 where there is none.
fn units(spread: &[f64]) -> Vec<f64> {
    spread.iter().map(|spread| if *spread > 0.0 { *spread } else { 1.0 }).collect()
}

/// Σ cₙ tⁿ, n from 1.
fn power_sum(coefficients: &[f64; 4], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| (sum + coefficient) * t)
}

/// The pairs of `count` inputs.
fn places(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |first| (first + 1..count).map(move |second| (first, second)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polynomials of the form are met everywhere, others at the nodes.
    #[test]
    fn forecasts_are_exact_for_polynomials_of_their_form() {
        let formula = |x: &[f64]| {
            let (t, s) = ((x[0] - 2.0) / 0.1, (x[1] + 3.0) / 0.5);
            vec![
                1.0 + t - 0.3 * t * t + 0.2 * t.powi(3) + 0.1 * s.powi(4),
                t * s * (1.0 - 0.5 * t + 0.25 * s + 0.125 * t * s),
            ]
        };
        let straight = Forecast::straight(vec![1.0, 0.0], vec![2.0, -3.0], &[10.0, 0.0, 0.0, 0.0]);
        let bent = straight.through(&[0.1, 0.5], |x| Ok::<_, ()>(formula(x))).unwrap();
        for inputs in [[2.0, -3.0], [2.17, -3.4], [1.7, -1.2]] {
            for (foreseen, exact) in bent.at(&inputs).zip(formula(&inputs)) {
                assert!(
                    (foreseen - exact).abs() < 1e-12 * (1.0 + exact.abs()),
                    "{foreseen}, not {exact}, at {inputs:?}"
                );
            }
        }
        assert_eq!(straight.at(&[2.3, 5.0]).collect::<Vec<_>>(), [1.0 + 10.0 * (2.3 - 2.0), 0.0]);
        assert_eq!(straight.of_inputs(&[1, 0]).at(&[5.0, 2.3]).next(), Some(1.0 + 10.0 * (2.3 - 2.0)));
    }

    #[test]
    fn a_failure_at_a_node_is_passed_on() {
        let straight = Forecast::straight(vec![1.0], vec![0.0], &[1.0]);
        assert_eq!(
            straight.through(&[1.0], |x| if x[0] > 1.5 { Err("beyond") } else { Ok(vec![x[0]]) }).err(),
            Some("beyond")
        );
    }
}
