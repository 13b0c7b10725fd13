//! The Bouc-Wen model: a hysteresis loop with an adjustable shape.

use alloc::format;

use fmm_model::{Bounds, Parameter, Scalar};

use crate::law::expansion::{is_whole, is_whole_with_derivatives, product, raise};
use crate::law::family::law_family;
use crate::law::functions::power;
use crate::law::{
    BristleLaw, Expansion, LawError, LawFamily, LawParameter, LawVisitor, Regime, Role, SearchRole, SearchStage,
    SpecialCase, digits,
};

/// Deflection over its bound (1) below which a power that is not whole has no usable series.
const NEAR_ZERO: f64 = 0.2;

law_family! {
    /// The Bouc-Wen model of hysteresis.
    ///
    /// ```text
    /// F = N κ z,    dz/dt = v (A − (β sgn(v z) + γ) |z|ⁿ)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | κ | `stiffness` | 1/m | coefficient per z |
    /// | A | `amplitude` | 1 | slope of z over the displacement at z = 0 |
    /// | β | `beta` | 1/mⁿ | shape of the loop |
    /// | γ | `gamma` | 1/mⁿ | shape of the loop, −β < γ ≤ β |
    /// | n | `exponent` | 1 | sharpness of the bend, ≥ 1 |
    ///
    /// The state z (m) stays within |z| ≤ (A/(β + γ))^(1/n); sliding, the coefficient tends to κ times that. Scaling A,
    /// β and γ against κ leaves the force unchanged, so a fit fixes A = 1. With n = 1, γ = 0 this is
    /// [`Dahl`](crate::Dahl) with i = 1, σ = κ A and μ = κ A/β; for n → ∞ it becomes one element of
    /// [`MaxwellSlip`](crate::MaxwellSlip).
    ///
    /// At z = 0 the rate has, for γ ≠ 0, only n − 1 continuous derivatives over z.
    ///
    /// # References
    /// Y. K. Wen, "Method for random vibration of hysteretic systems", J. Engineering Mechanics Division ASCE 102
    /// (1976) 249.
    ///
    /// M. Ismail, F. Ikhouane, J. Rodellar, "The hysteresis Bouc-Wen model, a survey", Arch. Computational Methods in
    /// Engineering 16 (2009) 161, doi 10.1007/s11831-009-9031-8.
    pub struct BoucWen, "bouc_wen", bristle {
        stiffness: LawParameter::positive("stiffness", "κ", "1/m", Role::Level).typically(50.0),
        amplitude: LawParameter::positive("amplitude", "A", "1", Role::Shape),
        beta: LawParameter::positive("beta", "β", "1/m^n", Role::Shape).typically(25.0),
        gamma: LawParameter::new(Parameter::new("gamma", "γ", "1/m^n"), Role::Shape),
        exponent: LawParameter::new(
            Parameter::new("exponent", "n", "1").bounded(Bounds::POSITIVE.at_least(1.0)),
            Role::Shape,
        ),
    }

    /// `stiffness` κ (1/m), `amplitude` A (1), `beta` β and `gamma` γ (1/mⁿ), `exponent` n (1).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite, [`LawError::Contradiction`]
    /// unless −β < γ ≤ β.
    pub fn new {
        let (loading, unloading) = (beta.value() + gamma.value(), beta.value() - gamma.value());
        if loading <= 0.0 || unloading < 0.0 {
            let [beta, gamma] = [beta, gamma].map(|value| digits(value.value()));
            let what = format!("a Bouc-Wen loop needs −β < γ ≤ β, but β = {beta} and γ = {gamma}");
            return Err(LawError::Contradiction { what });
        }
    }
    fitted by BoucWenByLevel
    special cases [SpecialCase::only("dahl", &[("exponent", 1.0)]), SpecialCase::of("coulomb")]
    tried [SearchStage::FurtherPresliding.trial().damped().fixing(&[("amplitude", 1.0)])]
}

impl<D: Scalar> BristleLaw<D> for BoucWen<D> {
    fn states(&self) -> usize {
        1
    }

    fn rate(&self, velocity: D, state: &[D], _regime: Regime, rate: &mut [D]) {
        let ahead = if velocity.value() < 0.0 { -state[0] } else { state[0] };
        let softening = if ahead.value() < 0.0 {
            (self.gamma - self.beta) * power(-ahead, self.exponent)
        } else {
            (self.gamma + self.beta) * power(ahead, self.exponent)
        };
        rate[0] = velocity * (self.amplitude - softening);
    }

    fn coefficient(&self, _velocity: D, state: &[D], _rate: &[D]) -> D {
        self.stiffness * state[0]
    }

    fn bound(&self, _index: usize) -> D {
        (self.amplitude / (self.beta + self.gamma)).powf(D::from(1.0) / self.exponent)
    }

    fn steady_coefficient(&self, _speed: D) -> Option<D> {
        Some(self.stiffness * self.bound(0))
    }

    fn expand(&self, order: usize, series: &mut Expansion<D>) -> bool {
        series.coefficient[order] = self.stiffness * series.state[order];
        if series.held {
            return true;
        }
        let deflection = series.state[0].value();
        let near_zero = deflection.abs() < NEAR_ZERO * self.bound(0).value();
        if is_whole_with_derivatives(self.exponent) || near_zero && !is_whole(self.exponent) {
            return false;
        }
        let (sign, shape) =
            if deflection < 0.0 { (-1.0, self.gamma - self.beta) } else { (1.0, self.gamma + self.beta) };
        let [size, slope, powers, room, ..] = &mut series.room;
        size[order] = series.state[order] * sign;
        raise(size, self.exponent, powers, room, order);
        let softening = shape * powers[order];
        slope[order] = if order == 0 { self.amplitude - softening } else { -softening };
        series.rate[order] = product(&series.velocity, slope, order);
        true
    }
}

/// [`BoucWen`] by parameters that a record tells apart: its level, and how the loop unloads.
///
/// ```text
/// dz/dx = A (1 − (|z|/z_m)ⁿ) loading,    A (1 + u (|z|/z_m)ⁿ) unloading,    z_m = μ/κ
/// β + γ = A (κ/μ)ⁿ,    β − γ = u (β + γ)
/// ```
///
/// | symbol | parameter | unit | meaning |
/// |---|---|---|---|
/// | κ | `stiffness` | 1/m | coefficient per z |
/// | A | `amplitude` | 1 | slope of z over the displacement at z = 0 |
/// | μ | `coefficient` | 1 | level of sliding |
/// | u | `unloading` | 1 | unloading: a straight line for 0, the mirrored bend of loading for 1 (γ = 0) |
/// | n | `exponent` | 1 | sharpness of the bend, ≥ 1 |
///
/// β and γ change by powers of ten with n while the loop stays unchanged, and −β < γ ≤ β is no simple bound: fits by
/// them creep. These parameters have simple bounds, and a fit by them takes a few steps. Those of u and n, 100 and 20,
/// bound a search; [`BoucWen`] takes any.
///
/// ```
/// use fmm_friction::{BoucWenByLevel, LawFamily};
///
/// let law = BoucWenByLevel::at(&[2e3, 1.0, 0.2, 1.0, 2.0])?;
/// assert_eq!(law.values(), [2e3, 1.0, 1e8, 0.0, 2.0]);
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
///
/// # References
/// The normalised form in M. Ismail, F. Ikhouane, J. Rodellar, doi 10.1007/s11831-009-9031-8, whose σ = β/(β + γ) is
/// (1 + u)/2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoucWenByLevel;

impl LawFamily for BoucWenByLevel {
    const NAME: &'static str = "bouc_wen_by_level";
    const PARAMETERS: &'static [LawParameter] = &[
        LawParameter::positive("stiffness", "κ", "1/m", Role::Level).typically(50.0),
        LawParameter::positive("amplitude", "A", "1", Role::Shape),
        LawParameter::positive("coefficient", "μ", "1", Role::Level),
        LawParameter::new(
            Parameter::new("unloading", "u", "1").bounded(Bounds::NOT_NEGATIVE.at_most(100.0)),
            Role::Shape,
        ),
        LawParameter::new(
            Parameter::new("exponent", "n", "1").bounded(Bounds::POSITIVE.at_least(1.0).at_most(20.0)),
            Role::Shape,
        ),
    ];
    const SPECIAL_CASES: &'static [SpecialCase] = BoucWen::SPECIAL_CASES;
    const SEARCH: SearchRole = SearchRole::NotTried("it is tried as the family bouc_wen");
    type At<D: Scalar> = BoucWen<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<BoucWen<D>, LawError> {
        let [stiffness, amplitude, coefficient, unloading, exponent] = Self::checked(values)?;
        let half = amplitude * (stiffness / coefficient).powf(exponent) * 0.5;
        BoucWen::new(stiffness, amplitude, half + half * unloading, half - half * unloading, exponent)
    }

    fn visit<D: Scalar, V: LawVisitor<D, BoucWen<D>>>(visitor: V) -> V::Output {
        visitor.bristle()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::FamilyVisitor;
    use crate::laws::Coulomb;

    fn rate(law: &BoucWen, velocity: f64, state: f64) -> f64 {
        let mut rate = [0.0];
        law.rate(velocity, &[state], Regime::ALL_HOLD, &mut rate);
        rate[0]
    }

    /// n = 2 on a monotone path from rest: z = z_m tanh(A x/z_m) with z_m = √(A/(β + γ)).
    #[test]
    fn follows_the_closed_form_of_exponent_two() {
        let law = BoucWen::new(2e4, 1.0, 6e8, 4e8, 2.0).unwrap();
        let most = 1e9f64.powf(-0.5);
        assert!((law.bound(0) - most).abs() < 1e-20, "{} m", law.bound(0));
        for x in [0.0, 1e-6, 2e-5, 1e-4] {
            let tanh = f64::tanh(x / most);
            let slope = rate(&law, 1.0, most * tanh);
            assert!((slope - (1.0 - tanh * tanh)).abs() < 1e-15, "x = {x} m: {slope}");
        }
    }

    /// Against the deflection the loop is stiffer: with γ = β it unloads on a straight line.
    #[test]
    fn unloads_as_gamma_says() {
        let law = BoucWen::new(1.0, 1.0, 5e3, 5e3, 1.0).unwrap();
        assert_eq!(rate(&law, -0.1, 5e-5), -0.1);
        assert_eq!(rate(&law, 0.1, 5e-5), 0.05);
    }

    #[test]
    fn loops_that_create_energy_are_refused() {
        let refused = |beta: f64, gamma: f64| BoucWen::new(1.0, 1.0, beta, gamma, 1.0).unwrap_err().to_string();
        assert_eq!(refused(1.0, 2.0), "a Bouc-Wen loop needs −β < γ ≤ β, but β = 1 and γ = 2");
        assert_eq!(refused(1.0, -1.0), "a Bouc-Wen loop needs −β < γ ≤ β, but β = 1 and γ = -1");
        assert!(BoucWen::new(1.0, 1.0, 1.0, 0.5, 0.9).is_err());
    }

    /// The slopes that the documentation states, at half the way to the bound.
    #[test]
    fn loads_and_unloads_as_the_parameters_say() {
        for (unloading, exponent) in [(0.0, 1.0), (1.0, 2.0), (3.0, 1.5)] {
            let law = BoucWenByLevel::at(&[2e3, 0.5, 0.2, unloading, exponent]).unwrap();
            assert!((law.steady_coefficient(1.0).unwrap() - 0.2).abs() < 1e-15);
            let rate = |velocity: f64| {
                let mut rate = [0.0];
                law.rate(velocity, &[0.5 * law.bound(0)], Regime::ALL_HOLD, &mut rate);
                rate[0]
            };
            let share = 0.5_f64.powf(exponent);
            assert!((rate(1.0) - 0.5 * (1.0 - share)).abs() < 1e-15, "{unloading}, {exponent}");
            assert!((rate(-1.0) + 0.5 * (1.0 + unloading * share)).abs() < 1e-14, "{unloading}, {exponent}");
        }
    }

    #[test]
    fn bouc_wen_is_fitted_by_these_parameters() {
        struct Names;
        impl FamilyVisitor for Names {
            type Output = &'static str;

            fn visit<F: LawFamily>(&mut self) -> &'static str {
                F::NAME
            }
        }
        let other = BoucWen::reparametrisation(&mut Names).unwrap();
        assert_eq!(other.family, BoucWenByLevel::NAME);
        // β + γ = 1e8 1/m², β − γ half of it.
        let values = (other.values)(&[2e3, 1.0, 0.2, 0.5, 2.0]).unwrap();
        assert_eq!(values, [2e3, 1.0, 7.5e7, 2.5e7, 2.0]);
        assert!((other.values)(&[2e3, 1.0, 0.2, -0.5, 2.0]).is_err(), "out of bounds");
        assert!(Coulomb::reparametrisation(&mut Names).is_none());
    }
}
