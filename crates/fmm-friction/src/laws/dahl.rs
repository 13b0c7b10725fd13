//! Dahl's model: friction that builds up over a small displacement.

use fmm_model::Scalar;

use crate::law::expansion::{product, raise};
use crate::law::family::law_family;
use crate::law::functions::{direction, power};
use crate::law::{BristleLaw, Expansion, LawError, LawFamily, LawParameter, Regime, Role, SearchStage, SpecialCase};

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
    special cases [SpecialCase::of("coulomb")]
    tried [SearchStage::Presliding.trial().damped().fixing(&[("exponent", 1.0)])]
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

    /// With r = 1 − sgn(v) σ z/μ the law is dr/ds = −(σ/μ) |r|ⁱ sgn r along the path s, so that |r|¹⁻ⁱ falls in
    /// proportion to s.
    fn carry(&self, velocity: D, duration: D, state: &mut [D]) -> bool {
        let one = D::from(1.0);
        let sign = direction(velocity);
        let bound = self.coefficient / self.stiffness;
        let reserve = one - state[0] / bound * sign;
        let size = reserve.abs();
        let path = velocity.abs() * duration / bound;
        let left = if size.value() == 0.0 {
            size
        } else {
            // |r| (1 − w q)^(1/w) with w = 1 − i and q = s σ/μ |r|⁻ʷ, which is |r| exp(−q) for i = 1.
            let bend = one - self.exponent;
            let share = path * size.powf(-bend);
            let product = bend * share;
            if product.value() >= 1.0 { D::from(0.0) } else { size * (-share * falling_logarithm(product)).exp() }
        };
        let left = if reserve.value() < 0.0 { -left } else { left };
        state[0] = bound * (one - left) * sign;
        true
    }

    fn expand(&self, order: usize, series: &mut Expansion<D>) -> bool {
        series.coefficient[order] = self.stiffness * series.state[order];
        if series.held {
            return true;
        }
        let [reserve, powers, room, ..] = &mut series.room;
        let used = series.coefficient[order] / self.coefficient;
        reserve[order] = if order == 0 { D::from(1.0) - used } else { -used };
        if reserve[0].value() <= 0.0 {
            return false;
        }
        raise(reserve, self.exponent, powers, room, order);
        series.rate[order] = product(&series.velocity, powers, order);
        true
    }
}

/// −ln(1 − y)/y for y < 1, by its series next to zero.
fn falling_logarithm<D: Scalar>(y: D) -> D {
    let one = D::from(1.0);
    if y.value().abs() > 1e-2 {
        return -(one - y).ln() / y;
    }
    // The next term is below 1e-17.
    (1..=8).rev().fold(D::from(0.0), |sum, power| sum * y + one / f64::from(power))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    fn rate(law: &Dahl, velocity: f64, state: f64) -> f64 {
        let mut rate = [0.0];
        law.rate(velocity, &[state], Regime::ALL_HOLD, &mut rate);
        rate[0]
    }

    /// On a monotone path from rest the law with i = 1 has the closed form F = μ (1 − exp(−σ x/μ)); its slope
    /// over x equals `rate` at unit velocity.
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

    /// A path in two parts is the whole path, the state follows its rate, and derivatives are those of differences,
    /// next to an exponent of one as well.
    #[test]
    fn is_carried_in_closed_form() {
        let end = |values: [f64; 4], duration: f64| {
            let [coefficient, stiffness, exponent, state] = values;
            let law = Dahl::new(coefficient, stiffness, exponent).unwrap();
            let mut state = [state];
            assert!(law.carry(-0.02, duration, &mut state));
            state[0]
        };
        for exponent in [0.4, 0.999, 1.0, 1.000_001, 1.3, 2.0, 3.5] {
            for share in [-0.9, -0.2, 0.0, 0.5, 1.0, 1.1] {
                let values = [0.25, 1e4, exponent, share * 0.25 / 1e4];
                let [half, whole] = [5e-4, 1e-3].map(|duration| end(values, duration));
                let twice = end([values[0], values[1], exponent, half], 5e-4);
                assert!((twice - whole).abs() < 1e-13 * 2.5e-5, "{exponent}, {share}: {twice} m for {whole} m");
                let law = Dahl::new(0.25, 1e4, exponent).unwrap();
                let slope = (end(values, 1e-3 + 1e-7) - end(values, 1e-3 - 1e-7)) / 2e-7;
                let expected = rate(&law, -0.02, whole);
                assert!((slope - expected).abs() < 1e-7 * 0.02, "{exponent}, {share}: {slope} m/s for {expected} m/s");
                let seeded: [Dual<4>; 4] = std::array::from_fn(|index| Dual::variable(values[index], index));
                let dual = Dahl::new(seeded[0], seeded[1], seeded[2]).unwrap();
                let mut state = [seeded[3]];
                dual.carry(Dual::from(-0.02), Dual::from(1e-3), &mut state);
                for direction in 0..4 {
                    let step = [1e-6, 1e-1, 1e-6, 1e-11][direction];
                    let at = |by: f64| {
                        let mut moved = values;
                        moved[direction] += by;
                        end(moved, 1e-3)
                    };
                    let difference = (at(step) - at(-step)) / (2.0 * step);
                    let (exact, size) = (state[0].partial(direction), 2.5e-5 / values[direction].abs().max(2.5e-5));
                    let near = (exact - difference).abs() < 1e-6 * size.max(exact.abs());
                    assert!(near, "{exponent}, {share}, {direction}: {exact} for {difference}");
                }
            }
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
