//! Generalised Maxwell slip laws of a fixed number of elements as a family.

use alloc::vec::Vec;

use fmm_model::Scalar;

use crate::stribeck::EXPONENT;
use crate::{Gms, LawError, LawFamily, LawParameter, LawVisitor, Role, SearchRole, SpecialCase, Stribeck};

/// The family of [`Gms`] laws of `N` elements, from 1 to 4: what makes their numbers parameters that can be fitted.
///
/// ```text
/// α₁ = 1/(1 + Σ aⱼ),   αᵢ = aᵢ/(1 + Σ aⱼ),   j, i = 2 … N
/// ```
///
/// Shares are given by their ratios aᵢ to that of the first element, so that any positive values make a law. Elements
/// of one law can change places; the first is meant to be the stiffest.
///
/// ```
/// use fmm_friction::{Gms, GmsOf, LawFamily, Stribeck};
///
/// let law = GmsOf::<2>::at(&[0.1, 0.3, 0.01, 2.0, 0.5, 3.0, 1e4, 1e3, 4.0])?;
/// assert_eq!(law, Gms::new(Stribeck::new(0.1, 0.3, 0.01, 2.0, 0.5)?, 3.0, &[(1e4, 0.2), (1e3, 0.8)])?);
/// assert_eq!(GmsOf::<2>::PARAMETERS[8].parameter().name(), "share_ratio_2");
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GmsOf<const N: usize>;

const NAMES: [&str; 4] = ["gms_1", "gms_2", "gms_3", "gms_4"];
const SPECIAL_CASES: [SpecialCase; 5] = [
    SpecialCase::of("stribeck"),
    SpecialCase::of("maxwell_slip_1"),
    SpecialCase::of("maxwell_slip_2"),
    SpecialCase::of("maxwell_slip_3"),
    SpecialCase::of("maxwell_slip_4"),
];

/// Parameters before those of the elements.
const BEFORE: usize = 6;

const fn stiffness(name: &'static str, symbol: &'static str, typical: f64) -> LawParameter {
    LawParameter::positive(name, symbol, "1/m", Role::Level).typically(typical)
}

const fn share_ratio(name: &'static str, symbol: &'static str) -> LawParameter {
    LawParameter::positive(name, symbol, "1", Role::Shape)
}

const PARAMETERS: &[LawParameter] = &[
    LawParameter::positive("sliding_coefficient", "μ_c", "1", Role::Level).typically(0.9),
    LawParameter::positive("static_coefficient", "μ_s", "1", Role::LevelAbove).typically(0.3),
    LawParameter::positive("stribeck_speed", "v_s", "m/s", Role::Shape).typically(0.2),
    EXPONENT,
    LawParameter::slope("viscous", "β"),
    LawParameter::positive("attraction", "C", "1/s", Role::Level).typically(20.0),
    stiffness("stiffness_1", "κ₁", 100.0),
    stiffness("stiffness_2", "κ₂", 20.0),
    share_ratio("share_ratio_2", "a₂"),
    stiffness("stiffness_3", "κ₃", 5.0),
    share_ratio("share_ratio_3", "a₃"),
    stiffness("stiffness_4", "κ₄", 1.0),
    share_ratio("share_ratio_4", "a₄"),
];

impl<const N: usize> LawFamily for GmsOf<N> {
    const NAME: &'static str = NAMES[N - 1];
    const PARAMETERS: &'static [LawParameter] = PARAMETERS.split_at(BEFORE - 1 + 2 * N).0;
    const SPECIAL_CASES: &'static [SpecialCase] = SPECIAL_CASES.split_at(N + 1).0;
    const SEARCH: SearchRole = SearchRole::NotTried("its parameters exceed the information of a ring-down");
    type At<D: Scalar> = Gms<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<Gms<D>, LawError> {
        if values.len() != Self::PARAMETERS.len() {
            return Err(LawError::WrongCount { law: Self::NAME, expected: Self::PARAMETERS.len(), got: values.len() });
        }
        for (parameter, value) in Self::PARAMETERS.iter().zip(values) {
            parameter.check(*value)?;
        }
        let (before, elements) = values.split_at(BEFORE);
        let one = D::from(1.0);
        let whole = elements[1..].chunks(2).fold(one, |sum, element| sum + element[1]);
        let others = elements[1..].chunks(2).map(|element| (element[0], element[1] / whole));
        let elements: Vec<_> = core::iter::once((elements[0], one / whole)).chain(others).collect();
        let curve = Stribeck::new(before[0], before[1], before[2], before[3], before[4])?;
        Gms::new(curve, before[5], &elements)
    }

    fn visit<D: Scalar, V: LawVisitor<D, Gms<D>>>(visitor: V) -> V::Output {
        visitor.bristle()
    }

    fn steady_coefficient<D: Scalar>(law: &Gms<D>, speed: D, losing: bool) -> Option<D> {
        Stribeck::steady_coefficient(law.steady(), speed, losing)
    }
}
