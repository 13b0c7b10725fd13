//! A Stribeck curve that passes smoothly through zero: friction for simulators that cannot stick.

use core::f64::consts::{E, SQRT_2};

use fmm_model::Scalar;

use crate::family::{law_family, static_not_below};
use crate::smoothed::saturation;
use crate::{LawError, LawFamily, LawParameter, Role, SlidingLaw};

law_family! {
    /// Regularised Stribeck friction, as block-diagram simulators such as Simscape use it.
    ///
    /// ```text
    /// F = N (√(2e) (μ_b − μ_c) exp(−(v/v_st)²) v/v_st + μ_c tanh(v/v_c) + f v),    v_st = √2 v_b,  v_c = v_b/10
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_b | `peak` | 1 | coefficient at the speed v_b, without the viscous part, ≥ μ_c |
    /// | μ_c | `sliding` | 1 | coefficient at large speed, without the viscous part |
    /// | v_b | `peak_speed` | m/s | speed of the peak |
    /// | f | `viscous` | s/m | increase of the coefficient with speed |
    ///
    /// There is no static level: under the smallest load the contact creeps. `peak` is reached but for
    /// 1 − tanh 10 = 4e-9 of μ_c.
    ///
    /// # References
    /// MathWorks, *Simscape Reference*, block Translational Friction.
    pub struct RegularisedStribeck, "regularised_stribeck", sliding {
        peak: LawParameter::level_above("peak_coefficient", "μ_b").typically(0.3),
        sliding: LawParameter::level("sliding_coefficient", "μ_c").typically(0.9),
        peak_speed: LawParameter::positive("peak_speed", "v_b", "m/s", Role::Shape).typically(0.03),
        viscous: LawParameter::slope("viscous", "f"),
    }

    /// Coefficients `peak` μ_b and `sliding` μ_c (1), `peak_speed` v_b (m/s) and `viscous` f (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite,
    /// [`LawError::StaticBelowSliding`] if μ_b < μ_c.
    pub fn new {
        static_not_below(sliding, peak)?;
    }
    special cases [crate::SpecialCase::of("coulomb")]
    tried [crate::SearchStage::FurtherOfSpeed.trial()]
}

impl<D: Scalar> SlidingLaw<D> for RegularisedStribeck<D> {
    fn coefficient(&self, speed: D) -> D {
        let ratio = speed / (self.peak_speed * SQRT_2);
        // e^(−100²) is zero in f64; beyond, the ratio or its derivatives may overflow.
        let bump =
            if ratio.value() > 100.0 { D::from(0.0) } else { (-(ratio * ratio)).exp() * ratio * (2.0 * E).sqrt() };
        (self.peak - self.sliding) * bump
            + self.sliding * saturation(speed / (self.peak_speed * 0.1))
            + self.viscous * speed
    }

    fn breakaway(&self) -> D {
        D::from(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    #[test]
    fn peaks_where_its_parameters_say() {
        let law = RegularisedStribeck::new(25.0, 20.0, 0.1, 100.0).unwrap();
        // tanh 10 is 1 − 4.12e-9; the viscous part at 0.1 m/s is 10.
        assert!((law.coefficient(0.1) - (35.0 - 20.0 * 4.122_307e-9)).abs() < 1e-13, "{}", law.coefficient(0.1));
        let dry = RegularisedStribeck::new(25.0, 20.0, 0.1, 0.0).unwrap();
        assert!(dry.coefficient(0.1) > dry.coefficient(0.09) && dry.coefficient(0.1) > dry.coefficient(0.11));
        assert!(RegularisedStribeck::new(20.0, 25.0, 0.1, 0.0).is_err());
    }

    #[test]
    fn tiny_speeds_of_the_peak_leave_the_derivatives_finite() {
        let law = RegularisedStribeck::new(Dual::<1>::from(25.0), 20.0.into(), Dual::variable(1e-300, 0), 0.0.into());
        let coefficient = law.unwrap().coefficient(Dual::from(0.1));
        assert_eq!((coefficient.value(), coefficient.partial(0)), (20.0, 0.0));
    }
}
