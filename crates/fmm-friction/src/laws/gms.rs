//! The generalised Maxwell slip model: elements that follow a Stribeck curve.

use alloc::format;
use alloc::vec::Vec;

use fmm_model::Scalar;

use crate::law::functions::direction;
use crate::law::parameter::all_checked;
use crate::law::{
    BristleLaw, LawError, LawFamily, LawParameter, LawVisitor, Regime, Role, SearchRole, SpecialCase, digits,
};
use crate::laws::Stribeck;
use crate::laws::maxwell_slip::check;
use crate::laws::stribeck::EXPONENT;

const ATTRACTION: LawParameter = LawParameter::positive("attraction", "C", "1/s", Role::Level);
const LEAST: LawParameter = LawParameter::positive("sliding_coefficient", "μ_c", "1", Role::Level);

/// The generalised Maxwell slip model (GMS).
///
/// ```text
/// F = N (Σ fᵢ + β v)
/// dfᵢ/dt = κᵢ v                               while element i holds, until sgn(v) fᵢ = αᵢ s(v)
/// dfᵢ/dt = C (αᵢ sgn(v) − fᵢ/s(v))            while it slides, until v passes zero
/// ```
///
/// | symbol | meaning | unit |
/// |---|---|---|
/// | s(v) | [`Stribeck::dry_coefficient`] at \|v\| | 1 |
/// | β | viscous part of the same Stribeck law | s/m |
/// | C | attraction, how fast a sliding element follows the curve | 1/s |
/// | κᵢ | stiffness of element i | 1/m |
/// | αᵢ | its share of the contact, Σ αᵢ = 1 | 1 |
///
/// The state is fᵢ (1), the part of the coefficient that element i carries; |fᵢ| ≤ αᵢ μ_s is invariant if
/// [`Regime`] follows the rules above. An element slides at its own *share* αᵢ s(v), not at s(v). Steady
/// sliding gives s(v) + β v; a sliding element approaches its share with the time constant s(v)/C. For C → ∞ and
/// constant s this is [`MaxwellSlip`](crate::MaxwellSlip) with levels αᵢ s.
///
/// # References
/// F. Al-Bender, V. Lampaert, J. Swevers, "The generalized Maxwell-slip model: a novel model for friction simulation
/// and compensation", IEEE Trans. Automatic Control 50 (2005) 1883, doi 10.1109/TAC.2005.858676.
#[derive(Debug, Clone, PartialEq)]
pub struct Gms<D = f64> {
    curve: Stribeck<D>,
    attraction: D,
    elements: Vec<(D, D)>,
}

impl<D: Scalar> Gms<D> {
    /// `curve` with s(v) and β, `attraction` C (1/s) and elements of (stiffness κᵢ (1/m), share αᵢ (1)).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a number is not positive or not finite, the sliding coefficient of the curve among
    /// them; [`LawError::WrongCount`] for no elements or more than [`Regime::CAPACITY`];
    /// [`LawError::Contradiction`] if the shares do not sum to 1 within 1e-9.
    pub fn new(curve: Stribeck<D>, attraction: D, elements: &[(D, D)]) -> Result<Self, LawError> {
        LEAST.check(curve.sliding)?;
        ATTRACTION.check(attraction)?;
        check(elements, "share", "α")?;
        let sum: f64 = elements.iter().map(|(_, share)| share.value()).sum();
        if (sum - 1.0).abs() > 1e-9 {
            let what = format!("the shares of the elements must sum to 1 within 1e-9, but sum to {}", digits(sum));
            return Err(LawError::Contradiction { what });
        }
        Ok(Self { curve, attraction, elements: elements.to_vec() })
    }

    /// The law of steady sliding, s(v) + β v.
    pub fn steady(&self) -> &Stribeck<D> {
        &self.curve
    }
}

impl<D: Scalar> BristleLaw<D> for Gms<D> {
    fn states(&self) -> usize {
        self.elements.len()
    }

    fn rate(&self, velocity: D, state: &[D], regime: Regime, rate: &mut [D]) {
        let level = self.curve.dry_coefficient(velocity.abs());
        for (index, (stiffness, share)) in self.elements.iter().enumerate() {
            rate[index] = if regime.slides(index) {
                self.attraction * (*share * direction(velocity) - state[index] / level)
            } else {
                *stiffness * velocity
            };
        }
    }

    fn coefficient(&self, velocity: D, state: &[D], _rate: &[D]) -> D {
        state.iter().fold(self.curve.viscous * velocity, |sum, part| sum + *part)
    }

    /// At constant velocity an element that holds follows the path up to its share, and one that slides tends
    /// exponentially to it.
    fn carry_on(&self, velocity: D, duration: D, state: &mut [D], regime: &mut Regime) -> bool {
        let level = self.curve.dry_coefficient(velocity.abs());
        let left = (-self.attraction * duration / level).exp();
        for (index, ((stiffness, share), part)) in self.elements.iter().zip(state).enumerate() {
            let end = *share * level * direction(velocity);
            let reserve = (end - *part) * direction(velocity);
            let holds = !regime.slides(index) && reserve.value() > 0.0;
            let bent = *stiffness * velocity * duration;
            if holds && bent.value().abs() < reserve.value() {
                *part += bent;
                continue;
            }
            *regime = regime.sliding(index);
            // One that reaches its share stays there.
            *part = if holds { end } else { end + (*part - end) * left };
        }
        true
    }

    fn bound(&self, index: usize) -> D {
        self.elements[index].1 * self.curve.breakaway
    }

    fn reserve(&self, index: usize, velocity: D, state: &[D]) -> Option<D> {
        let (_, share) = self.elements.get(index)?;
        Some(*share * self.curve.dry_coefficient(velocity.abs()) - state[index] * direction(velocity))
    }
}

/// The family of [`Gms`] laws of `N` elements, from 1 to 4. It makes their numbers parameters of a fit.
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
        all_checked(Self::NAME, Self::PARAMETERS, values)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(sliding: f64) -> Stribeck {
        Stribeck::new(sliding, 0.3, 0.01, 2.0, 0.5).unwrap()
    }

    /// An element is tested against its own share of s(v): at 0.2 of the curve's 0.3 it slides at 0.06.
    #[test]
    fn elements_slide_at_their_share() {
        let law = Gms::new(curve(0.1), 3.0, &[(1e4, 0.2), (1e4, 0.8)]).unwrap();
        for velocity in [1e-9_f64, -1e-9] {
            let state = [0.06 * velocity.signum(), 0.06 * velocity.signum()];
            assert!(law.reserve(0, velocity, &state).unwrap().abs() < 1e-14);
            assert!((law.reserve(1, velocity, &state).unwrap() - 0.18).abs() < 1e-14);
        }
        assert_eq!(law.reserve(2, 1.0, &[0.0, 0.0]), None);
        let mut rate = [0.0; 2];
        // At 1 m/s s = 0.1: the element relaxes from 0.06 towards 0.02 at C (0.2 − 0.06/0.1).
        law.rate(1.0, &[0.06, 0.06], Regime::ALL_HOLD.sliding(0), &mut rate);
        assert!((rate[0] + 3.0 * 0.4).abs() < 1e-15, "{}", rate[0]);
        assert_eq!(rate[1], 1e4);
        assert!((law.coefficient(1.0, &[0.06, 0.06], &rate) - 0.62).abs() < 1e-15);
    }

    #[test]
    fn shares_must_be_of_one_whole() {
        let refused = |elements: &[(f64, f64)]| Gms::new(curve(0.1), 3.0, elements).unwrap_err().to_string();
        assert_eq!(
            refused(&[(1e4, 0.5), (1e4, 0.25)]),
            "the shares of the elements must sum to 1 within 1e-9, but sum to 0.75"
        );
        assert!(refused(&[(1e4, 1.5), (1e4, -0.5)]).starts_with("share_2 must be"));
        assert!(Gms::new(curve(0.0), 3.0, &[(1e4, 1.0)]).is_err(), "a curve that falls to zero");
        assert!(Gms::new(curve(0.1), 0.0, &[(1e4, 1.0)]).is_err());
    }
}
