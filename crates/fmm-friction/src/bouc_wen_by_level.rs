//! The Bouc-Wen model by its level and the shape of its loop.

use fmm_model::{Bounds, Parameter, Scalar};

use crate::{BoucWen, LawError, LawFamily, LawParameter, LawVisitor, Role, SearchRole};

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
/// | u | `unloading` | 1 | how the loop unloads: on a straight line for 0, with the bend of loading mirrored for 1 (γ = 0) |
/// | n | `exponent` | 1 | sharpness of the bend, ≥ 1 |
///
/// β and γ change by powers of ten with n where the loop stays as it is, and −β < γ ≤ β is no simple bound: fits by
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
/// The normalised form in M. Ismail, F. Ikhouane, J. Rodellar, doi 10.1007/s11831-009-9031-8, whose σ = β/(β + γ) is (1
/// + u)/2.
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
    use crate::{BristleLaw, Coulomb, FamilyVisitor, Regime};

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
        let recast = BoucWen::recast(&mut Names).unwrap();
        assert_eq!(recast.family, BoucWenByLevel::NAME);
        // β + γ = 1e8 1/m², β − γ half of it.
        let values = (recast.values)(&[2e3, 1.0, 0.2, 0.5, 2.0]).unwrap();
        assert_eq!(values, [2e3, 1.0, 7.5e7, 2.5e7, 2.0]);
        assert!((recast.values)(&[2e3, 1.0, 0.2, -0.5, 2.0]).is_err(), "out of bounds");
        assert!(Coulomb::recast(&mut Names).is_none());
    }
}
