//! Laws of simulators that cannot stick: regularised, smoothed, or with a dead zone.

use alloc::borrow::ToOwned;
use core::f64::consts::{E, SQRT_2};

use fmm_model::Scalar;

use crate::law::family::law_family;
use crate::law::functions::saturation;
use crate::law::parameter::static_not_below;
use crate::law::{LawError, LawFamily, LawParameter, Role, SearchStage, SlidingLaw, SpecialCase};

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
    /// [`LawError::Contradiction`] if μ_b < μ_c.
    pub fn new {
        static_not_below(sliding, peak)?;
    }
    special cases [SpecialCase::of("coulomb")]
    tried [SearchStage::OfSpeed.trial()]
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

/// A sliding law times tanh(v/ε): a smooth function of the velocity that never sticks.
///
/// ```text
/// F = N μ(|v|) tanh(v/ε)
/// ```
///
/// | symbol | field | unit | meaning |
/// |---|---|---|---|
/// | μ | `law` | - | the law to smooth |
/// | ε | `width` | m/s | speed below which it is smoothed |
///
/// It is for optimisers, other solvers and harmonic balance that need a smooth right-hand side. It is no default:
/// the contact creeps under any load instead of resting, equations become stiff as ε shrinks, and the motion is wrong
/// in proportion to ε. In a free decay of the thesis' Monte Carlo case the velocity is off by
///
/// | ε (m/s) | 1e-2 | 1e-3 | 1e-4 | 1e-5 | 1e-6 |
/// |---|---|---|---|---|---|
/// | error (m/s) | 3.8e-3 | 3.3e-4 | 3.4e-5 | 3.4e-6 | 3.4e-7 |
///
/// ```
/// use fmm_friction::{Coulomb, SlidingLaw, Smoothed};
///
/// let law = Smoothed::new(Coulomb::new(0.2)?, 1e-3)?;
/// assert_eq!(law.force_coefficient(-1.0), -0.2);
/// assert_eq!((law.coefficient(0.0), law.breakaway()), (0.0, 0.0));
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothed<L, D = f64> {
    law: L,
    width: D,
}

const TWO_LEVELS: &str =
    "a law that depends on the acceleration has two levels at one speed and cannot be smoothed in the speed";

const WIDTH: LawParameter = LawParameter::positive("smoothing_width", "ε", "m/s", Role::Shape);

impl<D: Scalar, L: SlidingLaw<D>> Smoothed<L, D> {
    /// `law`, smoothed below a speed of `width` ε (m/s).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if the width is not positive or not finite, [`LawError::Contradiction`] if the
    /// law has two values at one speed.
    pub fn new(law: L, width: D) -> Result<Self, LawError> {
        if law.depends_on_acceleration() {
            return Err(LawError::Contradiction { what: TWO_LEVELS.to_owned() });
        }
        Ok(Self { law, width: WIDTH.check(width)? })
    }

    /// Friction coefficient (1) at `velocity` (m/s) of either sign, with the sign of the velocity.
    pub fn force_coefficient(&self, velocity: D) -> D {
        let smooth = saturation(velocity.abs() / self.width);
        let smooth = if velocity.value() < 0.0 { -smooth } else { smooth };
        self.law.coefficient(velocity.abs()) * smooth
    }
}

impl<D: Scalar, L: SlidingLaw<D>> SlidingLaw<D> for Smoothed<L, D> {
    fn coefficient(&self, speed: D) -> D {
        self.force_coefficient(speed)
    }

    fn breakaway(&self) -> D {
        D::from(0.0)
    }
}

law_family! {
    /// Karnopp's friction: Coulomb friction with a band of speeds that counts as rest.
    ///
    /// ```text
    /// F = μ_d N            for v > v_d
    /// F = load             for v ≤ v_d and |load| ≤ μ_s N
    /// F = μ_s N            for v ≤ v_d otherwise
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | μ_d | `sliding` | 1 | coefficient while sliding faster than v_d |
    /// | μ_s | `breakaway` | 1 | the most that the contact holds within the dead zone, ≥ μ_d |
    /// | v_d | `dead_zone` | m/s | speed at and below which the contact can be at rest |
    ///
    /// The dead zone spares a simulator the search for v = 0, at the price of an error that grows with it. It is here
    /// for comparison with such simulators: for v_d → 0 the law becomes [`CoulombStatic`](crate::CoulombStatic), which
    /// needs no dead zone.
    ///
    /// # References
    /// D. Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic systems", Journal of Dynamic
    /// Systems, Measurement, and Control 107 (1985) 100, doi 10.1115/1.3140698.
    pub struct Karnopp, "karnopp", sliding {
        sliding: LawParameter::level("sliding_coefficient", "μ_d"),
        breakaway: LawParameter::level_above("static_coefficient", "μ_s").typically(0.1),
        dead_zone: LawParameter::positive("dead_zone", "v_d", "m/s", Role::Shape).typically(0.01),
    }

    /// Coefficient `sliding` μ_d outside and `breakaway` μ_s (1) inside the `dead_zone` v_d (m/s).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a coefficient is negative, the dead zone not positive, or either not finite,
    /// [`LawError::Contradiction`] if μ_s < μ_d.
    pub fn new {
        static_not_below(sliding, breakaway)?;
    }
    special cases [SpecialCase::of("coulomb")]
    tried [SearchStage::OfSpeed.trial().damped()]
}

impl<D: Scalar> SlidingLaw<D> for Karnopp<D> {
    fn coefficient(&self, speed: D) -> D {
        if speed.value() <= self.dead_zone.value() { self.breakaway } else { self.sliding }
    }

    fn breakaway(&self) -> D {
        self.breakaway
    }

    fn capture_speed(&self) -> D {
        self.dead_zone
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    use crate::laws::{AccelerationCoulomb, Coulomb, ExponentialPair, Stribeck};

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

    #[test]
    fn is_odd_and_smooth_through_zero() {
        let law = Smoothed::new(Stribeck::new(0.1, 0.2, 0.01, 2.0, 0.0).unwrap(), 1e-3).unwrap();
        for velocity in [1e-9, 1e-4, 0.01, 0.7, 1e300] {
            assert_eq!(law.force_coefficient(-velocity), -law.force_coefficient(velocity), "at {velocity} m/s");
        }
        // tanh r = r − r³/3: 3e-7 of r at r = 1e-3, on either side of zero.
        for velocity in [-1e-6, 1e-6] {
            let slope = law.force_coefficient(velocity) / velocity;
            assert!((slope / (0.2 / 1e-3) - 1.0).abs() < 1e-6, "{slope} s/m at {velocity} m/s");
        }
    }

    #[test]
    fn laws_with_two_values_at_one_speed_are_refused() {
        let steps = AccelerationCoulomb::new(0.2, 0.1).unwrap();
        let pair = ExponentialPair::new(0.1, 0.2, 10.0, 10.0).unwrap();
        assert_eq!(Smoothed::new(steps, 1e-3), Err(LawError::Contradiction { what: TWO_LEVELS.to_owned() }));
        assert_eq!(Smoothed::new(pair, 1e-3), Err(LawError::Contradiction { what: TWO_LEVELS.to_owned() }));
        let flat = Smoothed::new(Coulomb::new(0.2).unwrap(), 0.0).unwrap_err();
        assert!(flat.to_string().starts_with("smoothing_width must be"), "{flat}");
    }

    #[test]
    fn holds_within_its_dead_zone() {
        let law = Karnopp::new(0.1, 0.2, 1e-3).unwrap();
        assert_eq!([0.0, 1e-3, 1.001e-3].map(|speed| law.coefficient(speed)), [0.2, 0.2, 0.1]);
        assert_eq!((law.breakaway(), law.capture_speed()), (0.2, 1e-3));
        assert!(Karnopp::new(0.2, 0.1, 1e-3).is_err() && Karnopp::new(0.1, 0.2, 0.0).is_err());
    }
}
