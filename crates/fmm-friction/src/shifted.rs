//! A law that starts at its inflection: a static level for curves that begin at zero.

use fmm_model::Scalar;

use crate::{FamilyMember, LawError, LawFamily, LawParameter, LawVisitor, MakkarDixon, SearchRole, SlidingLaw};

/// A law whose curve over the speed rises to a Stribeck peak and bends while it falls.
pub trait Inflected {
    /// The law's number type.
    type Number: Scalar;

    /// The inflection after the peak (m/s), where the curve has its steepest fall; zero for a curve without one.
    ///
    /// It depends on the law's parameters, and carries their derivatives to first order.
    fn inflection(&self) -> Self::Number;
}

/// A law that creeps, made one that sticks: its curve from the inflection after the Stribeck peak on.
///
/// ```text
/// F = N μ(v + v*),    d²μ/dv²(v*) = 0 with μ falling             (thesis section 7.5)
/// ```
///
/// | symbol | method | unit | meaning |
/// |---|---|---|---|
/// | μ | - | 1 | the law's coefficient |
/// | v* | [`inflection`](Self::inflection) | m/s | speed at which its fall is steepest |
/// | μ(v*) | `breakaway` | 1 | the static level |
///
/// A curve without an inflection is not shifted, v* = 0. The parameters are those of the law; v* follows from them, and
/// at dual numbers so do its derivatives. Derivatives beyond the first are not those of v*.
///
/// ```
/// use fmm_friction::{MakkarDixon, Shifted, SlidingLaw};
///
/// let law = Shifted::new(MakkarDixon::five(0.25, 100.0, 10.0, 0.1, 100.0)?);
/// assert!((law.inflection() - 0.037_451_077_446_664_115_f64).abs() < 1e-16);
/// assert!((law.breakaway() - 0.260_126_521_317_483_43_f64).abs() < 1e-15);
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shifted<L: Inflected> {
    law: L,
    inflection: L::Number,
}

impl<L: Inflected> Shifted<L> {
    /// `law` from its inflection on.
    pub fn new(law: L) -> Self {
        let inflection = law.inflection();
        Self { law, inflection }
    }

    /// The law before the shift.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// v*, the shift (m/s).
    pub fn inflection(&self) -> L::Number {
        self.inflection
    }
}

impl<D: Scalar, L: Inflected<Number = D> + SlidingLaw<D>> SlidingLaw<D> for Shifted<L> {
    fn coefficient(&self, speed: D) -> D {
        self.law.coefficient(speed + self.inflection)
    }

    fn breakaway(&self) -> D {
        self.coefficient(D::from(0.0))
    }
}

impl<D: Scalar> FamilyMember for Shifted<MakkarDixon<D>> {
    type Number = D;
    type Family = Shifted<MakkarDixon>;
}

impl LawFamily for Shifted<MakkarDixon> {
    const NAME: &'static str = "makkar_dixon_shifted";
    const PARAMETERS: &'static [LawParameter] = MakkarDixon::PARAMETERS;
    const SPECIAL_CASES: &'static [crate::SpecialCase] = MakkarDixon::SPECIAL_CASES;
    const SEARCH: SearchRole = SearchRole::NotTried(
        "its curve beyond the inflection is nearly that of a Stribeck law, which has fewer parameters",
    );
    type At<D: Scalar> = Shifted<MakkarDixon<D>>;

    fn at<D: Scalar>(values: &[D]) -> Result<Shifted<MakkarDixon<D>>, LawError> {
        MakkarDixon::at(values).map(Shifted::new)
    }

    fn visit<D: Scalar, V: LawVisitor<D, Self::At<D>>>(visitor: V) -> V::Output {
        visitor.sliding()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    const THESIS: [f64; 6] = [0.25, 100.0, 10.0, 0.1, 100.0, 0.0];

    #[test]
    fn starts_at_its_static_level_and_falls() {
        let law = Shifted::at(&THESIS).unwrap();
        assert_eq!(law.coefficient(0.0), law.breakaway());
        assert_eq!(law.coefficient(0.1), law.law().coefficient(0.1 + law.inflection()));
        assert!(law.coefficient(0.01) < law.breakaway());
    }

    /// v* was found by no derivative of itself: its own must be those of differences. Steps of 1e-6 leave 1e-12 times
    /// third derivatives and 1e-16/1e-6 of rounding, over sensitivities near 1e-3.
    #[test]
    fn the_shift_has_its_derivatives() {
        let seeded: Vec<_> = THESIS.iter().enumerate().map(|(i, value)| Dual::<6>::variable(*value, i)).collect();
        let dual = Shifted::at(&seeded).unwrap();
        for direction in 0..6 {
            let step = 1e-6 * THESIS[direction].max(1.0);
            let shift = |change: f64| {
                let mut values = THESIS;
                values[direction] += change;
                Shifted::at(&values).map(|law| law.inflection())
            };
            let forward = |step: f64| shift(step).unwrap() - shift(0.0).unwrap();
            // One-sided to second order, as γ₆ must not be negative.
            let difference = (4.0 * forward(step) - forward(2.0 * step)) / (2.0 * step);
            let exact = dual.inflection().partial(direction);
            let bound = 1e-9 + 1e-6 * exact.abs();
            assert!((exact - difference).abs() < bound, "γ{}: {exact} against {difference}", direction + 1);
        }
    }

    #[test]
    fn a_curve_without_inflection_is_not_shifted() {
        let law = Shifted::at(&[0.0, 100.0, 10.0, 0.1, 100.0, 0.0]).unwrap();
        assert_eq!((law.inflection(), law.breakaway()), (0.0, 0.0));
    }
}
