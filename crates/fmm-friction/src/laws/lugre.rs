//! The LuGre model: bristles, damping and a Stribeck curve.

use fmm_model::Scalar;

use crate::law::expansion::{convolve, decay, is_whole, is_whole_with_derivatives, product, raise};
use crate::law::family::law_family;
use crate::law::functions::direction;
use crate::law::parameter::static_not_below;
use crate::law::{
    BristleLaw, Expansion, LawError, LawFamily, LawParameter, Regime, Role, SearchStage, SlidingLaw, SpecialCase,
};
use crate::laws::Stribeck;
use crate::laws::stribeck::EXPONENT;

/// Speed, in units of the Stribeck speed, below which the series of a power that is not whole is no good, and above
/// which nothing falls.
const SLOW: f64 = 0.2;
const FAST: f64 = 1e6;

law_family! {
    /// The LuGre model.
    ///
    /// ```text
    /// F = N (σ₀ z + σ₁ dz/dt + σ₂ v),    dz/dt = v − σ₀ |v| z/g(v),    g(v) = μ_c + (μ_s − μ_c) exp(−(|v|/v_s)^δ)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_c | `sliding` | 1 | coefficient of steady sliding at large speed, without the viscous part |
    /// | μ_s | `breakaway` | 1 | coefficient of steady sliding in the limit of zero speed, ≥ μ_c |
    /// | v_s | `fall_speed` | m/s | Stribeck speed, over which the coefficient falls |
    /// | δ | `exponent` | 1 | shape of the fall, 0.5 to 2; 1 and 2 are the usual choices |
    /// | σ₀ | `stiffness` | 1/m | slope of the coefficient at zero deflection |
    /// | σ₁ | `bristle_damping` | s/m | damping of the deflection |
    /// | σ₂ | `viscous` | s/m | increase of the coefficient with speed |
    ///
    /// The state z (m) is the mean bristle deflection; |z| ≤ μ_s/σ₀ is invariant. The contact shows presliding,
    /// frictional lag and a breakaway level that falls as the load grows faster. With μ_s = μ_c and σ₁ = σ₂ = 0 this is
    /// [`Dahl`](crate::Dahl) with i = 1; for σ₀ → ∞ it becomes [`Stribeck`].
    ///
    /// # References
    /// C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, "A new model for control of systems with friction",
    /// IEEE Trans. Automatic Control 40 (1995) 419, doi 10.1109/9.376053.
    pub struct LuGre, "lugre", bristle {
        sliding: LawParameter::positive("sliding_coefficient", "μ_c", "1", Role::Level).typically(0.9),
        breakaway: LawParameter::positive("static_coefficient", "μ_s", "1", Role::LevelAbove).typically(0.3),
        fall_speed: LawParameter::positive("stribeck_speed", "v_s", "m/s", Role::Shape).typically(0.2),
        exponent: EXPONENT,
        stiffness: LawParameter::positive("stiffness", "σ₀", "1/m", Role::Level).typically(50.0),
        bristle_damping: LawParameter::not_negative("bristle_damping", "σ₁", "s/m", Role::Level).typically(0.1),
        viscous: LawParameter::slope("viscous", "σ₂"),
    }

    /// Coefficients `sliding` μ_c and `breakaway` μ_s (1), `fall_speed` v_s (m/s), `exponent` δ (1), `stiffness` σ₀
    /// (1/m), `bristle_damping` σ₁ and `viscous` σ₂ (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite,
    /// [`LawError::Contradiction`] if μ_s < μ_c.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [SpecialCase::only("dahl", &[("exponent", 1.0)]), SpecialCase::of("stribeck")]
    tried [SearchStage::FurtherPresliding.trial().fixing(&[("exponent", 2.0)])]
}

impl<D: Scalar> LuGre<D> {
    /// The law of steady sliding, g(v) + σ₂ v.
    pub fn steady(&self) -> Stribeck<D> {
        Stribeck {
            sliding: self.sliding,
            breakaway: self.breakaway,
            fall_speed: self.fall_speed,
            exponent: self.exponent,
            viscous: self.viscous,
        }
    }
}

impl<D: Scalar> BristleLaw<D> for LuGre<D> {
    fn states(&self) -> usize {
        1
    }

    fn rate(&self, velocity: D, state: &[D], _regime: Regime, rate: &mut [D]) {
        let level = self.steady().dry_coefficient(velocity.abs());
        rate[0] = velocity * (D::from(1.0) - self.stiffness * state[0] / level * direction(velocity));
    }

    fn coefficient(&self, velocity: D, state: &[D], rate: &[D]) -> D {
        self.stiffness * state[0] + self.bristle_damping * rate[0] + self.viscous * velocity
    }

    fn bound(&self, _index: usize) -> D {
        self.breakaway / self.stiffness
    }

    fn steady_coefficient(&self, speed: D) -> Option<D> {
        Some(self.steady().coefficient(speed))
    }

    /// At constant velocity z tends exponentially to sgn(v) g(v)/σ₀.
    fn carry(&self, velocity: D, duration: D, state: &mut [D]) -> bool {
        let end = self.steady().dry_coefficient(velocity.abs()) / self.stiffness;
        let steady = end * direction(velocity);
        state[0] = steady + (state[0] - steady) * (-velocity.abs() * duration / end).exp();
        true
    }

    fn expand(&self, order: usize, series: &mut Expansion<D>) -> bool {
        let Expansion { velocity, state, rate, coefficient, held, room: [ratio, power, fallen, reserve, room, slope] } =
            series;
        if *held {
            coefficient[order] = self.stiffness * state[order] + self.viscous * velocity[order];
            return true;
        }
        // The coefficients of an order wait for those before, and none should wait for a division.
        let one = D::from(1.0);
        ratio[order] = velocity[order] * (one / self.fall_speed);
        let speed = ratio[0].value();
        let is_slow = speed < SLOW && !is_whole(self.exponent);
        if is_whole_with_derivatives(self.exponent) || is_slow || speed > FAST {
            return false;
        }
        raise(ratio, self.exponent, power, room, order);
        decay(power, fallen, slope, order);
        // 1 − σ z/g, from g (1 − σ z/g) = g − σ z.
        let excess = self.breakaway - self.sliding;
        let level = self.sliding + excess * fallen[0];
        let apart = if order == 0 { level } else { excess * fallen[order] } - self.stiffness * state[order];
        let known = convolve(&reserve[..order], &fallen[1..=order]);
        reserve[order] = (apart - excess * known) * (one / level);
        rate[order] = product(velocity, reserve, order);
        coefficient[order] =
            self.stiffness * state[order] + self.bristle_damping * rate[order] + self.viscous * velocity[order];
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At constant velocity z = (g/σ₀) (1 − exp(−σ₀ v t/g)), so dz/dt = v exp(−σ₀ v t/g).
    #[test]
    fn follows_the_closed_form_at_constant_velocity() {
        let law = LuGre::new(1.0, 1.5, 1e-3, 2.0, 1e5, 316.0, 0.4).unwrap();
        let velocity = 2e-3;
        let level = 1.0 + 0.5 * f64::exp(-4.0);
        for path in [0.1, 1.0, 5.0] {
            let state = [level / 1e5 * -f64::exp_m1(-path)];
            let mut rate = [0.0];
            law.rate(velocity, &state, Regime::ALL_HOLD, &mut rate);
            let expected = velocity * f64::exp(-path);
            assert!((rate[0] - expected).abs() < 1e-17, "{} m/s instead of {expected} m/s", rate[0]);
            let coefficient = 1e5 * state[0] + 316.0 * expected + 0.4 * velocity;
            assert!((law.coefficient(velocity, &state, &rate) - coefficient).abs() < 1e-14);
        }
    }

    #[test]
    fn is_carried_in_closed_form() {
        let law = LuGre::new(1.0, 1.5, 1e-3, 2.0, 1e5, 316.0, 0.4).unwrap();
        for (velocity, begin) in [(2e-3, 0.0), (-2e-3, 1e-5), (1e-3, -1.2e-5)] {
            let end = |duration: f64| {
                let mut state = [begin];
                assert!(law.carry(velocity, duration, &mut state));
                state[0]
            };
            let slope = (end(3e-3 + 1e-7) - end(3e-3 - 1e-7)) / 2e-7;
            let mut rate = [0.0];
            law.rate(velocity, &[end(3e-3)], Regime::ALL_HOLD, &mut rate);
            assert!((slope - rate[0]).abs() < 1e-8 * velocity.abs(), "{slope} m/s for {} m/s", rate[0]);
            assert!((end(0.0) - begin).abs() < 1e-20);
        }
    }

    #[test]
    fn contradictions_are_refused() {
        let refused = |values: [f64; 7]| LuGre::at(&values).unwrap_err().to_string();
        assert!(refused([1.5, 1.0, 1e-3, 2.0, 1e5, 0.0, 0.0]).starts_with("the static coefficient 1 must not"));
        assert!(refused([0.0, 1.0, 1e-3, 2.0, 1e5, 0.0, 0.0]).starts_with("sliding_coefficient must be"));
        assert!(refused([1.0, 1.5, 1e-3, 2.0, 1e5, -1.0, 0.0]).starts_with("bristle_damping must be"));
    }
}
