//! The motion within a step of an integrator, as polynomials.

use fmm_model::Scalar;

use crate::State;

/// Degree of the polynomial within a step, plus one.
pub(crate) const COEFFICIENTS: usize = 8;

/// x and v as polynomials in the part θ ∈ [0, 1] of a step: y + θ (F₀ + (1−θ) (F₁ + θ (F₂ + (1−θ) (F₃ + …)))).
#[derive(Clone, Copy)]
pub(crate) struct Within<D> {
    begin: State<D>,
    /// F₀ to F₆.
    nested: [State<D>; 7],
}

impl<D: Scalar> Within<D> {
    /// The polynomials from `begin` on with the terms `nested`.
    pub(crate) const fn new(begin: State<D>, nested: [State<D>; 7]) -> Self {
        Self { begin, nested }
    }

    /// Σ cᵢ θⁱ for the position.
    pub(crate) fn position(&self) -> [D; COEFFICIENTS] {
        expand(self.begin.position, self.nested.map(|term| term.position))
    }

    /// Σ cᵢ θⁱ for the velocity.
    pub(crate) fn velocity(&self) -> [D; COEFFICIENTS] {
        expand(self.begin.velocity, self.nested.map(|term| term.velocity))
    }

    /// The state at the part `theta` of the step.
    pub(crate) fn at(&self, theta: f64) -> State<D> {
        let zero = State { position: D::from(0.0), velocity: D::from(0.0) };
        let sum = (0..self.nested.len()).rev().fold(zero, |sum, index| {
            // Times θ for even, times 1 − θ for odd terms.
            let weight = if index % 2 == 0 { theta } else { 1.0 - theta };
            let term = self.nested[index];
            State {
                position: (sum.position + term.position) * weight,
                velocity: (sum.velocity + term.velocity) * weight,
            }
        });
        State { position: self.begin.position + sum.position, velocity: self.begin.velocity + sum.velocity }
    }
}

/// Powers of θ out of y + θ (F₀ + (1−θ) (F₁ + θ (F₂ + (1−θ) (F₃ + …)))).
fn expand<D: Scalar>(start: D, nested: [D; 7]) -> [D; COEFFICIENTS] {
    let zero = D::from(0.0);
    let mut powers = [zero; COEFFICIENTS];
    for (index, term) in nested.into_iter().enumerate().rev() {
        powers[0] += term;
        // Times θ for even, times 1 − θ for odd terms.
        for i in (0..COEFFICIENTS).rev() {
            let shifted = if i > 0 { powers[i - 1] } else { zero };
            powers[i] = if index % 2 == 0 { shifted } else { powers[i] - shifted };
        }
    }
    powers[0] += start;
    powers
}
