//! Dahl's model: friction that builds up over a small displacement.

use fmm_model::Scalar;

use crate::elements::direction;
use crate::family::law_family;
use crate::power::power;
use crate::{BristleLaw, LawError, LawFamily, LawParameter, Regime, Role};

law_family! {
    /// Dahl's presliding model.
    ///
    /// ```text
    /// F = N σ z,   dz/dt = v |1 − sgn(v) σ z/μ|ⁱ sgn(1 − sgn(v) σ z/μ)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ | `coefficient` | 1 | coefficient that steady sliding approaches |
    /// | σ | `stiffness` | 1/m | slope of the coefficient at zero deflection |
    /// | i | `exponent` | 1 | sharpness of the bend; 1 is the usual choice |
    ///
    /// The state z (m) is the bristle deflection; |z| ≤ μ/σ is invariant. For σ → ∞ the law becomes
    /// [`Coulomb`](crate::Coulomb); with i = 1 it is [`LuGre`](crate::LuGre) with equal levels and without damping, and
    /// [`BoucWen`](crate::BoucWen) with A = n = 1, γ = 0, β = σ/μ.
    ///
    /// # References
    /// P. R. Dahl, *A solid friction model*, The Aerospace Corporation TOR-0158(3107-18)-1, 1968.
    pub struct Dahl, "dahl", bristle {
        coefficient: LawParameter::positive("coefficient", "μ", "1", Role::Level),
        stiffness: LawParameter::positive("stiffness", "σ", "1/m", Role::Level).typically(50.0),
        exponent: LawParameter::positive("exponent", "i", "1", Role::Shape),
    }

    /// Coefficient `μ` (1), presliding `stiffness` σ (1/m) and `exponent` i (1).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter is not positive or not finite.
    pub fn new {}
    special cases [crate::SpecialCase::of("coulomb")]
}

impl<D: Scalar> BristleLaw<D> for Dahl<D> {
    fn states(&self) -> usize {
        1
    }

    fn rate(&self, velocity: D, state: &[D], _regime: Regime, rate: &mut [D]) {
        let reserve = D::from(1.0) - self.stiffness * state[0] / self.coefficient * direction(velocity);
        rate[0] = if reserve.value() < 0.0 {
            -velocity * power(-reserve, self.exponent)
        } else {
            velocity * power(reserve, self.exponent)
        };
    }

    fn coefficient(&self, _velocity: D, state: &[D], _rate: &[D]) -> D {
        self.stiffness * state[0]
    }

    fn bound(&self, _index: usize) -> D {
        self.coefficient / self.stiffness
    }

    fn steady_coefficient(&self, _speed: D) -> Option<D> {
        Some(self.coefficient)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(law: &Dahl, velocity: f64, state: f64) -> f64 {
        let mut rate = [0.0];
        law.rate(velocity, &[state], Regime::ALL_HOLD, &mut rate);
        rate[0]
    }

    /// On a monotone path from rest the law with i = 1 has the closed form F = μ (1 − exp(−σ x/μ)); its slope
    /// over x is what `rate` must give at unit velocity.
    #[test]
    fn follows_the_closed_form_of_exponent_one() {
        let law = Dahl::new(0.25, 1.0e4, 1.0).unwrap();
        for x in [0.0, 1e-6, 1e-5, 5e-5, 2e-4] {
            let coefficient: f64 = 0.25 * (1.0 - (-1.0e4 * x / 0.25f64).exp());
            let slope = (-1.0e4 * x / 0.25f64).exp();
            let z = coefficient / 1.0e4;
            assert!((rate(&law, 1.0, z) - slope).abs() < 1e-12, "x = {x} m");
            assert!((law.coefficient(1.0, &[z], &[slope]) - coefficient).abs() < 1e-15);
        }
    }

    #[test]
    fn is_odd_and_stays_in_its_box() {
        let law = Dahl::new(0.25, 1.0e4, 1.7).unwrap();
        let bound = law.bound(0);
        for z in [-1.2, -1.0, -0.4, 0.0, 0.4, 1.0, 1.2] {
            let z = z * bound;
            assert_eq!(rate(&law, 0.3, z), -rate(&law, -0.3, -z));
        }
        assert_eq!(rate(&law, 0.3, bound), 0.0);
        assert!(rate(&law, 0.3, 1.2 * bound) < 0.0);
    }
}
