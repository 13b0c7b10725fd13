//! Maxwell slip laws of a fixed number of elements as a family.

use alloc::vec::Vec;

use fmm_model::Scalar;

use crate::{LawError, LawFamily, LawParameter, LawVisitor, MaxwellSlip, Role, SearchRole, SpecialCase};

/// The family of [`MaxwellSlip`] laws of `N` elements, from 1 to 8: what makes their levels and stiffnesses parameters
/// that can be fitted.
///
/// Elements of one law can change places; those listed first are meant to be the stiff ones that slide at most of the
/// force.
///
/// ```
/// use fmm_friction::{LawFamily, MaxwellSlip, MaxwellSlipOf};
///
/// let law = MaxwellSlipOf::<2>::at(&[0.15, 4.0e4, 0.1, 1.0e4])?;
/// assert_eq!(law, MaxwellSlip::new(&[(4.0e4, 0.15), (1.0e4, 0.1)])?);
/// assert_eq!(MaxwellSlipOf::<2>::PARAMETERS[3].parameter().name(), "stiffness_2");
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MaxwellSlipOf<const N: usize>;

const fn positive(name: &'static str, symbol: &'static str, unit: &'static str, typical: f64) -> LawParameter {
    LawParameter::positive(name, symbol, unit, Role::Level).typically(typical)
}

const NAMES: [&str; 8] = [
    "maxwell_slip_1",
    "maxwell_slip_2",
    "maxwell_slip_3",
    "maxwell_slip_4",
    "maxwell_slip_5",
    "maxwell_slip_6",
    "maxwell_slip_7",
    "maxwell_slip_8",
];

/// Level and stiffness of every element.
const PARAMETERS: &[LawParameter] = &[
    positive("level_1", "w₁", "1", 0.6),
    positive("stiffness_1", "κ₁", "1/m", 100.0),
    positive("level_2", "w₂", "1", 0.4),
    positive("stiffness_2", "κ₂", "1/m", 20.0),
    positive("level_3", "w₃", "1", 0.2),
    positive("stiffness_3", "κ₃", "1/m", 5.0),
    positive("level_4", "w₄", "1", 0.2),
    positive("stiffness_4", "κ₄", "1/m", 200.0),
    positive("level_5", "w₅", "1", 0.2),
    positive("stiffness_5", "κ₅", "1/m", 50.0),
    positive("level_6", "w₆", "1", 0.2),
    positive("stiffness_6", "κ₆", "1/m", 10.0),
    positive("level_7", "w₇", "1", 0.2),
    positive("stiffness_7", "κ₇", "1/m", 2.0),
    positive("level_8", "w₈", "1", 0.2),
    positive("stiffness_8", "κ₈", "1/m", 1.0),
];

impl<const N: usize> LawFamily for MaxwellSlipOf<N> {
    const NAME: &'static str = NAMES[N - 1];
    const PARAMETERS: &'static [LawParameter] = PARAMETERS.split_at(2 * N).0;
    const SPECIAL_CASES: &'static [SpecialCase] =
        &[SpecialCase::of(if N == 1 { "coulomb" } else { NAMES[N.saturating_sub(2)] })];
    const SEARCH: SearchRole =
        SearchRole::NotTried("a sum of elements is fitted to records of force, which show its corners");
    type At<D: Scalar> = MaxwellSlip<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<MaxwellSlip<D>, LawError> {
        if values.len() != 2 * N {
            return Err(LawError::WrongCount { law: Self::NAME, expected: 2 * N, got: values.len() });
        }
        for (parameter, value) in Self::PARAMETERS.iter().zip(values) {
            parameter.check(*value)?;
        }
        let elements: Vec<_> = values.chunks(2).map(|element| (element[1], element[0])).collect();
        MaxwellSlip::new(&elements)
    }

    fn visit<D: Scalar, V: LawVisitor<D, MaxwellSlip<D>>>(visitor: V) -> V::Output {
        visitor.elements()
    }
}
