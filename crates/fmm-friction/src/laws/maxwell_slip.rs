//! Elements in parallel, each a spring that slides at its level.

use alloc::format;
use alloc::vec::Vec;

use fmm_model::{Bounds, Parameter, Scalar};

use crate::law::functions::direction;
use crate::law::parameter::all_checked;
use crate::law::{
    Affine, BristleLaw, Element, LawError, LawFamily, LawParameter, LawVisitor, PiecewiseLinearLaw, Regime, Role,
    SearchRole, SpecialCase,
};

/// Checks pairs of a stiffness κᵢ (1/m) and a second number, called `name` and `symbol`: all positive and finite, and
/// no more pairs than a regime can tell apart.
pub(crate) fn check<D: Scalar>(elements: &[(D, D)], name: &str, symbol: &str) -> Result<(), LawError> {
    if elements.is_empty() || elements.len() > Regime::CAPACITY {
        let (got, most) = (elements.len(), Regime::CAPACITY);
        let what = format!("a law of elements has 1 to {most} of them, but {got} were given");
        return Err(LawError::WrongCount { what, got });
    }
    for (number, (stiffness, second)) in (1..).zip(elements) {
        for (name, symbol, unit, value) in [("stiffness", "κ", "1/m", stiffness), (name, symbol, "1", second)] {
            let parameter = Parameter::named(format!("{name}_{number}"), format!("{symbol}_{number}"), unit);
            LawParameter::new(parameter.bounded(Bounds::POSITIVE), Role::Level).check(*value)?;
        }
    }
    Ok(())
}

/// The Maxwell slip model, also called Iwan's or Jenkins' model.
///
/// ```text
/// F = N Σ κᵢ zᵢ,    zᵢ ← clamp(zᵢ + Δx, ±wᵢ/κᵢ) for a monotone displacement Δx
/// ```
///
/// | symbol | meaning | unit |
/// |---|---|---|
/// | κᵢ | stiffness of an element | 1/m |
/// | wᵢ | coefficient at which it slides | 1 |
///
/// The state zᵢ (m) is the deflection of element i; |zᵢ| ≤ wᵢ/κᵢ is invariant if the element slides, as
/// [`Regime`] says, from the time at which its [`reserve`](BristleLaw::reserve) is used up until the velocity passes
/// zero. Sliding, the coefficient is Σ wᵢ; at rest without deflection its slope over the displacement is Σ κᵢ. The
/// force depends on the path alone, not on the speed, and its loops obey Masing's rules. One element with κ → ∞ is
/// [`Coulomb`](crate::Coulomb).
///
/// ```
/// use fmm_friction::MaxwellSlip;
///
/// let law = MaxwellSlip::new(&[(4.0e4, 0.25), (1.0e4, 0.6)])?;
/// let mut state = [0.0; 2];
/// // After 10 µm the first element slides, and the second holds: 0.25 + 1e4 · 1e-5.
/// law.deflect(&mut state, 1e-5);
/// assert!((law.coefficient_at(&state) - 0.35_f64).abs() < 1e-15);
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
///
/// # References
/// W. D. Iwan, "A distributed-element model for hysteresis and its steady-state dynamic response", Journal of Applied
/// Mechanics 33 (1966) 893.
#[derive(Debug, Clone, PartialEq)]
pub struct MaxwellSlip<D = f64> {
    elements: Vec<Element<D>>,
}

impl<D: Scalar> MaxwellSlip<D> {
    /// Elements of (stiffness κᵢ (1/m), level wᵢ (1)).
    ///
    /// # Errors
    /// [`LawError::WrongCount`] for no elements or more than [`Regime::CAPACITY`], [`LawError::OutOfBounds`] if a
    /// number is not positive or not finite.
    pub fn new(elements: &[(D, D)]) -> Result<Self, LawError> {
        check(elements, "level", "w")?;
        Ok(Self {
            elements: elements
                .iter()
                .map(|(stiffness, level)| Element { stiffness: *stiffness, level: *level })
                .collect(),
        })
    }

    /// Moves the contact by `displacement` (m) in one direction: the exact change of the deflections `state` (m),
    /// whatever the speed.
    pub fn deflect(&self, state: &mut [D], displacement: D) {
        for (element, deflection) in self.elements.iter().zip(state) {
            let bound = element.level / element.stiffness;
            let moved = *deflection + displacement;
            *deflection = if moved.value() > bound.value() {
                bound
            } else if moved.value() < -bound.value() {
                -bound
            } else {
                moved
            };
        }
    }

    /// Friction coefficient (1) at the deflections `state` (m).
    pub fn coefficient_at(&self, state: &[D]) -> D {
        self.elements
            .iter()
            .zip(state)
            .fold(D::from(0.0), |sum, (element, deflection)| sum + element.stiffness * *deflection)
    }
}

impl<D: Scalar> PiecewiseLinearLaw<D> for MaxwellSlip<D> {
    fn affine(&self) -> Affine<D> {
        Affine { level: D::from(0.0), slope: D::from(0.0), breakaway: D::from(0.0) }
    }

    fn elements(&self) -> &[Element<D>] {
        &self.elements
    }
}

impl<D: Scalar> BristleLaw<D> for MaxwellSlip<D> {
    fn states(&self) -> usize {
        self.elements.len()
    }

    fn rate(&self, velocity: D, _state: &[D], regime: Regime, rate: &mut [D]) {
        for (index, rate) in rate.iter_mut().enumerate() {
            *rate = if regime.slides(index) { D::from(0.0) } else { velocity };
        }
    }

    fn coefficient(&self, _velocity: D, state: &[D], _rate: &[D]) -> D {
        self.coefficient_at(state)
    }

    fn carry(&self, velocity: D, duration: D, state: &mut [D]) -> bool {
        self.deflect(state, velocity * duration);
        true
    }

    fn bound(&self, index: usize) -> D {
        self.elements[index].level / self.elements[index].stiffness
    }

    fn reserve(&self, index: usize, velocity: D, state: &[D]) -> Option<D> {
        let element = self.elements.get(index)?;
        Some(element.level - element.stiffness * state[index] * direction(velocity))
    }
}

/// The family of [`MaxwellSlip`] laws of `N` elements, from 1 to 4. It makes their levels and stiffnesses parameters of
/// a fit.
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

const NAMES: [&str; 4] = ["maxwell_slip_1", "maxwell_slip_2", "maxwell_slip_3", "maxwell_slip_4"];

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
        all_checked(Self::NAME, Self::PARAMETERS, values)?;
        let elements: Vec<_> = values.chunks(2).map(|element| (element[1], element[0])).collect();
        MaxwellSlip::new(&elements)
    }

    fn visit<D: Scalar, V: LawVisitor<D, MaxwellSlip<D>>>(visitor: V) -> V::Output {
        visitor.elements()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The loading curve has its corners at wᵢ/κᵢ; the unloading curve is twice as large (Masing).
    #[test]
    fn loops_obey_masings_rule() {
        let law = MaxwellSlip::new(&[(4e4, 0.25), (3e4, 0.4), (2e4, 0.5), (1e4, 0.6)]).unwrap();
        let at = |from: f64, to: f64| {
            let mut state = [0.0; 4];
            law.deflect(&mut state, from);
            law.deflect(&mut state, to - from);
            law.coefficient_at(&state)
        };
        // 1e5 · 1e-6 while all hold; 1.75 when all slide.
        assert!((at(0.0, 1e-6) - 0.1).abs() < 1e-15);
        assert!((at(0.0, 1e-3) - 1.75).abs() < 1e-15);
        for x in [1e-6, 1e-5, 4e-5] {
            let unloaded = at(5e-5, 5e-5 - 2.0 * x);
            let expected = at(0.0, 5e-5) - 2.0 * at(0.0, x);
            assert!((unloaded - expected).abs() < 1e-14, "{unloaded} against {expected} at {x} m");
        }
    }

    #[test]
    fn lists_of_elements_that_make_no_law_are_refused() {
        let refused = |pairs: &[(f64, f64)]| MaxwellSlip::new(pairs).unwrap_err().to_string();
        assert_eq!(refused(&[]), "a law of elements has 1 to 64 of them, but 0 were given");
        assert_eq!(refused(&[(1.0, 1.0); 65]), "a law of elements has 1 to 64 of them, but 65 were given");
        assert!(refused(&[(1.0, 1.0), (-1.0, 1.0)]).starts_with("stiffness_2 must be"));
        assert!(refused(&[(1.0, 0.0)]).starts_with("level_1 must be"));
    }
}
