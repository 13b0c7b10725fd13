//! Stribeck curves: friction that falls from a static level as the speed grows.

use fmm_model::{Bounds, Parameter, Scalar};

use crate::law::family::law_family;
use crate::law::functions::{between, fallen, power};
use crate::law::parameter::static_not_below;
use crate::law::{LawError, LawFamily, LawParameter, Role, SearchStage, SlidingLaw, SpecialCase};

/// Exponents for which the curve is in use; below 1 its slope at zero speed is −∞.
pub(crate) const EXPONENT: LawParameter = LawParameter::new(
    Parameter::new("exponent", "δ", "1").bounded(Bounds::POSITIVE.at_least(0.5).at_most(2.0)),
    Role::Shape,
);

law_family! {
    /// Stribeck friction with an exponential fall and a viscous part.
    ///
    /// ```text
    /// F = N (μ_c + (μ_s − μ_c) exp(−(v/v_s)^δ) + β v)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_c | `sliding` | 1 | coefficient at large speed, without the viscous part |
    /// | μ_s | `breakaway` | 1 | coefficient at zero speed and at breakaway, ≥ μ_c |
    /// | v_s | `fall_speed` | m/s | Stribeck speed, over which the coefficient falls |
    /// | δ | `exponent` | 1 | shape of the fall, 0.5 to 2; 1 and 2 are the usual choices |
    /// | β | `viscous` | s/m | increase of the coefficient with speed |
    ///
    /// With δ = 1 and β = 0 this is [`Berger`](crate::Berger) with α = 1/v_s, with δ = 2 the Gaussian form, with
    /// μ_s = μ_c [`CoulombViscous`](crate::CoulombViscous); for v_s → 0 it becomes a static level of its own.
    ///
    /// At zero speed the coefficient is μ_s exactly. For δ < 1 its slope there is −∞: the value at v = 0 then carries
    /// the derivatives in the parameters, which are finite, and none in the speed.
    ///
    /// # References
    /// L. C. Bo, D. Pavelescu, "The friction-speed relation and its influence on the critical velocity of stick-slip
    /// motion", Wear 82 (1982) 277.
    ///
    /// B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, "A survey of models, analysis tools and compensation
    /// methods for the control of machines with friction", Automatica 30 (1994) 1083, doi 10.1016/0005-1098(94)90209-7.
    pub struct Stribeck, "stribeck", sliding {
        sliding: LawParameter::level("sliding_coefficient", "μ_c").typically(0.9),
        breakaway: LawParameter::level_above("static_coefficient", "μ_s").typically(0.4),
        fall_speed: LawParameter::positive("stribeck_speed", "v_s", "m/s", Role::Shape).typically(0.2),
        exponent: EXPONENT,
        viscous: LawParameter::slope("viscous", "β"),
    }

    /// Coefficients `sliding` μ_c and `breakaway` μ_s (1), `fall_speed` v_s (m/s), `exponent` δ (1) and `viscous`
    /// β (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite,
    /// [`LawError::Contradiction`] if μ_s < μ_c.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [SpecialCase::at("berger", &[("exponent", 1.0)]), SpecialCase::of("coulomb")]
    tried [SearchStage::OfSpeed.trial().fixing(&[("exponent", 2.0)]), SearchStage::OfSpeed.trial()]
}

impl<D: Scalar> Stribeck<D> {
    /// The coefficient (1) at `speed` ≥ 0 (m/s) without its viscous part, s(v) in bristle models.
    pub fn dry_coefficient(&self, speed: D) -> D {
        let ratio = speed / self.fall_speed;
        // √1e6 = 1000 and e⁻¹⁰⁰⁰ is zero in f64; beyond, the ratio or its derivatives may overflow.
        if ratio.value() > 1e6 {
            self.sliding
        } else {
            fallen(self.sliding, self.breakaway, power(ratio, self.exponent))
        }
    }
}

impl<D: Scalar> SlidingLaw<D> for Stribeck<D> {
    fn coefficient(&self, speed: D) -> D {
        self.dry_coefficient(speed) + self.viscous * speed
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }
}

law_family! {
    /// Stribeck friction with a Lorentzian fall and a viscous part.
    ///
    /// ```text
    /// F = N (μ_c + (μ_s − μ_c)/(1 + (v/v_s)²) + β v)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_c | `sliding` | 1 | coefficient at large speed, without the viscous part |
    /// | μ_s | `breakaway` | 1 | coefficient at zero speed and at breakaway, ≥ μ_c |
    /// | v_s | `fall_speed` | m/s | Stribeck speed, at which half of the fall has happened |
    /// | β | `viscous` | s/m | increase of the coefficient with speed |
    ///
    /// To second order in the speed it is the Gaussian [`Stribeck`](crate::Stribeck) curve; at large speed it falls
    /// far more slowly.
    ///
    /// # References
    /// D. P. Hess, A. Soom, "Friction at a lubricated line contact operating at oscillating sliding velocities",
    /// Journal of Tribology 112 (1990) 147.
    pub struct StribeckLorentzian, "stribeck_lorentzian", sliding {
        sliding: LawParameter::level("sliding_coefficient", "μ_c").typically(0.9),
        breakaway: LawParameter::level_above("static_coefficient", "μ_s").typically(0.4),
        fall_speed: LawParameter::positive("stribeck_speed", "v_s", "m/s", Role::Shape).typically(0.2),
        viscous: LawParameter::slope("viscous", "β"),
    }

    /// Coefficients `sliding` μ_c and `breakaway` μ_s (1), `fall_speed` v_s (m/s) and `viscous` β (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite,
    /// [`LawError::Contradiction`] if μ_s < μ_c.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [SpecialCase::of("coulomb")]
    tried [SearchStage::OfSpeed.trial()]
}

impl<D: Scalar> SlidingLaw<D> for StribeckLorentzian<D> {
    fn coefficient(&self, speed: D) -> D {
        let ratio = speed / self.fall_speed;
        let viscous = self.viscous * speed;
        // The square of a larger ratio or its derivatives may overflow, and its inverse is below any coefficient.
        if ratio.value() > 1e100 {
            return self.sliding + viscous;
        }
        let share = D::from(1.0) / (ratio * ratio + 1.0);
        between(self.sliding, self.breakaway, share, || ratio * ratio * share) + viscous
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1.75 + 1.75/e + 0.5 · 0.02 at v = v_s, whatever the exponent.
    #[test]
    fn falls_by_one_e_th_at_the_stribeck_speed() {
        for exponent in [0.5, 1.0, 1.5, 2.0] {
            let law = Stribeck::new(1.75, 3.5, 0.02, exponent, 0.5).unwrap();
            let expected = 1.75 + 1.75 * f64::exp(-1.0) + 0.01;
            assert!((law.coefficient(0.02) - expected).abs() < 1e-15, "δ = {exponent}: {}", law.coefficient(0.02));
            assert_eq!((law.coefficient(0.0), law.breakaway()), (3.5, 3.5));
        }
    }

    #[test]
    fn contradictions_are_refused() {
        let refused = |values: [f64; 5]| Stribeck::at(&values).unwrap_err().to_string();
        assert_eq!(
            refused([0.3, 0.2, 0.01, 1.0, 0.0]),
            "the static coefficient 0.2 must not be below the sliding coefficient 0.3"
        );
        assert_eq!(refused([0.1, 0.2, 0.01, 2.5, 0.0]), "exponent must be in [0.5, 2], but is 2.5");
        assert!(refused([0.1, 0.2, 0.0, 1.0, 0.0]).starts_with("stribeck_speed must be greater than 0 m/s, but is 0"));
        assert_eq!(
            refused([0.1, f64::INFINITY, 0.01, 1.0, 0.0]),
            "static_coefficient must be at least 0 and finite, but is inf"
        );
        assert!(refused([0.1, 0.2, 0.01, 1.0, f64::NAN]).starts_with("viscous must be"));
    }
}
