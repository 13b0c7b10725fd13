//! The continuously differentiable law of Makkar and Dixon, and a version with a static level.

use alloc::format;

use fmm_model::Scalar;

use crate::law::family::law_family;
use crate::law::{
    FamilyMember, LawError, LawFamily, LawParameter, LawVisitor, Role, SearchRole, SearchStage, SlidingLaw,
    SpecialCase, digits,
};

law_family! {
    /// Makkar and Dixon's law: a difference of two hyperbolic tangents for the Stribeck peak, a third for the level and
    /// a viscous part.
    ///
    /// ```text
    /// F = N (γ₁ (tanh γ₂ v − tanh γ₃ v) + γ₄ tanh γ₅ v + γ₆ v)       (thesis Eq. 7.5, with the sign of γ₄ corrected)
    /// ```
    ///
    /// | symbol | field | unit | meaning |
    /// |---|---|---|---|
    /// | γ₁ | `difference` | 1 | scale of the Stribeck peak |
    /// | γ₂ | `rise` | s/m | inverse speed over which the peak rises, > γ₃ |
    /// | γ₃ | `fall` | s/m | inverse speed over which it falls |
    /// | γ₄ | `level` | 1 | coefficient at large speed, without the viscous part |
    /// | γ₅ | `level_rise` | s/m | inverse speed over which the level is reached |
    /// | γ₆ | `viscous` | s/m | increase of the coefficient with speed |
    ///
    /// The coefficient is zero at zero speed, so this contact never sticks, it creeps; [`ShiftedMakkarDixon`]
    /// gives it a static level. The thesis prints −γ₄ but computes with +γ₄, as Makkar does, and so does this law. Nor
    /// is γ₁ + γ₄ the height of the peak, unless γ₂ and γ₅ are infinite and γ₃ zero: [`peak`](Self::peak) has the
    /// height.
    ///
    /// With γ₁ = γ₆ = 0 this is [`Coulomb`](crate::Coulomb) [`Smoothed`](crate::Smoothed) over 1/γ₅.
    ///
    /// ```
    /// use fmm_friction::MakkarDixon;
    ///
    /// // The start values of the thesis' appendix A6: the peak is 0.288, not 0.25 + 0.1.
    /// let law = MakkarDixon::five(0.25, 100.0, 10.0, 0.1, 100.0)?;
    /// let (speed, coefficient): (f64, f64) = law.peak().ok_or("no peak")?;
    /// assert!((speed - 0.020_15).abs() < 1e-5 && (coefficient - 0.288_07).abs() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # References
    /// C. Makkar, W. E. Dixon, W. G. Sawyer, G. Hu, "A new continuously differentiable friction model for control
    /// systems design", Proc. IEEE/ASME Int. Conf. Advanced Intelligent Mechatronics (2005) 600.
    pub struct MakkarDixon, "makkar_dixon", sliding {
        difference: LawParameter::level("difference_coefficient", "γ₁").typically(0.4),
        rise: LawParameter::positive("rise", "γ₂", "s/m", Role::Shape).typically(50.0),
        fall: LawParameter::positive("fall", "γ₃", "s/m", Role::Shape).typically(3.0),
        level: LawParameter::level("coefficient", "γ₄").typically(0.8),
        level_rise: LawParameter::not_negative("level_rise", "γ₅", "s/m", Role::Shape).typically(50.0),
        viscous: LawParameter::slope("viscous", "γ₆"),
    }

    /// The law with all six parameters: `difference` γ₁ (1), `rise` γ₂ and `fall` γ₃ (s/m), `level` γ₄ (1),
    /// `level_rise` γ₅ (s/m) and `viscous` γ₆ (s/m).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if a parameter lies outside its bounds or is not finite, [`LawError::Contradiction`]
    /// unless γ₂ > γ₃, without which the coefficient could be negative.
    pub fn six {
        if rise.value() <= fall.value() {
            let [rise, fall] = [rise, fall].map(|value| digits(value.value()));
            let what = format!("γ₂ must be greater than γ₃, but γ₂ = {rise} and γ₃ = {fall}");
            return Err(LawError::Contradiction { what });
        }
    }
    special cases [SpecialCase::of("coulomb")]
    tried [SearchStage::OfSpeed.trial()]
}

impl<D: Scalar> MakkarDixon<D> {
    /// The law without a viscous part, γ₆ = 0; parameters as in [`six`](Self::six).
    ///
    /// # Errors
    /// [`LawError`] in the same cases as [`six`](Self::six).
    pub fn five(difference: D, rise: D, fall: D, level: D, level_rise: D) -> Result<Self, LawError> {
        Self::six(difference, rise, fall, level, level_rise, D::from(0.0))
    }

    /// Speed (m/s) and coefficient (1) of the Stribeck peak, the first maximum over the speed. `None` if the
    /// coefficient only grows.
    ///
    /// The search ends at 20/γ₃, beyond which the fall is complete to rounding. It finds a peak whose fall extends over
    /// more than a twentieth of the speed.
    pub fn peak(&self) -> Option<(D, D)> {
        let plain = self.plain();
        let bracket = plain.first(plain.start(), |slopes| slopes[0] < 0.0)?;
        let speed = self.zero(0, bracket);
        Some((speed, self.coefficient(speed)))
    }

    /// Speed of the inflection after the peak (m/s), at which d²μ/dv² passes from − to +; zero for a curve without one.
    ///
    /// It is searched as [`peak`](Self::peak) is.
    fn inflection(&self) -> D {
        let plain = self.plain();
        let bracket = plain
            .first(plain.start(), |slopes| slopes[0] < 0.0)
            .and_then(|(before_peak, _)| plain.first(before_peak, |slopes| slopes[0] < 0.0 && slopes[1] > 0.0));
        bracket.map_or(D::from(0.0), |bracket| self.zero(1, bracket))
    }

    /// First to third derivative of the coefficient with respect to the speed.
    fn slopes(&self, speed: D) -> [D; 3] {
        let (rise, fall) = (tanh_slopes(self.rise, speed), tanh_slopes(self.fall, speed));
        let level = tanh_slopes(self.level_rise, speed);
        let mut slopes =
            [0, 1, 2].map(|order| self.difference * (rise[order] - fall[order]) + self.level * level[order]);
        slopes[0] += self.viscous;
        slopes
    }

    /// The same law without derivatives.
    fn plain(&self) -> MakkarDixon {
        MakkarDixon {
            difference: self.difference.value(),
            rise: self.rise.value(),
            fall: self.fall.value(),
            level: self.level.value(),
            level_rise: self.level_rise.value(),
            viscous: self.viscous.value(),
        }
    }

    /// The zero of the slope of this `order` (0 for the first) in a bracket, with its derivatives in the parameters.
    ///
    /// One Newton step from the value of the zero, s(v; p)/s′(v), is the implicit function theorem when it is taken in
    /// numbers that carry derivatives.
    fn zero(&self, order: usize, bracket: (f64, f64)) -> D {
        let speed = self.plain().bisect(order, bracket);
        let slopes = self.slopes(D::from(speed));
        -(slopes[order] / slopes[order + 1].value()) + speed
    }
}

impl MakkarDixon {
    /// A speed below which the law is a straight line to within 1e-4.
    fn start(&self) -> f64 {
        0.01 / self.rise.max(self.level_rise)
    }

    /// Brackets the least speed from `start` on at which `holds` is true of the slopes, on a grid that is far finer
    /// than the hyperbolic tangents.
    fn first(&self, start: f64, holds: impl Fn([f64; 3]) -> bool) -> Option<(f64, f64)> {
        let (mut before, mut speed) = (start, start);
        while speed < 20.0 / self.fall {
            if holds(self.slopes(speed)) {
                return Some((before, speed));
            }
            before = speed;
            speed *= 1.05;
        }
        None
    }

    /// The zero of the slope of this `order` in a bracket, to the last bit.
    fn bisect(&self, order: usize, (mut low, mut high): (f64, f64)) -> f64 {
        let positive = self.slopes(high)[order] > 0.0;
        loop {
            let middle = f64::midpoint(low, high);
            if middle <= low || middle >= high {
                return middle;
            }
            if (self.slopes(middle)[order] > 0.0) == positive { high = middle } else { low = middle }
        }
    }
}

impl<D: Scalar> SlidingLaw<D> for MakkarDixon<D> {
    fn coefficient(&self, speed: D) -> D {
        self.difference * tanh_difference(self.rise * speed, self.fall * speed)
            + self.level * (self.level_rise * speed).tanh()
            + self.viscous * speed
    }

    fn breakaway(&self) -> D {
        D::from(0.0)
    }
}

/// tanh a − tanh b for a ≥ b ≥ 0, as a product of positive numbers: the difference itself loses its digits if both are
/// close to 1.
fn tanh_difference<D: Scalar>(a: D, b: D) -> D {
    let (small, large) = ((a * -2.0).exp(), (b * -2.0).exp());
    (a - b).tanh() * (small + large) * 2.0 / ((small + 1.0) * (large + 1.0))
}

/// First to third derivative of tanh(γ v) with respect to v ≥ 0, from tanh′ = 1 − tanh².
fn tanh_slopes<D: Scalar>(gamma: D, speed: D) -> [D; 3] {
    let ratio = gamma * speed;
    let (tanh, small) = (ratio.tanh(), (ratio * -2.0).exp());
    let sech_squared = small * 4.0 / ((small + 1.0) * (small + 1.0));
    let first = gamma * sech_squared;
    let second = -(gamma * first * tanh * 2.0);
    [first, second, gamma * gamma * first * (tanh * tanh * 4.0 - sech_squared * 2.0)]
}

/// Makkar and Dixon's law made to stick: its curve from the inflection after the Stribeck peak on.
///
/// ```text
/// F = N μ(v + v*),    d²μ/dv²(v*) = 0 with μ falling             (thesis section 7.5)
/// ```
///
/// | symbol | method | unit | meaning |
/// |---|---|---|---|
/// | μ | - | 1 | coefficient of [`MakkarDixon`] |
/// | v* | [`inflection`](Self::inflection) | m/s | speed of the steepest fall |
/// | μ(v*) | `breakaway` | 1 | static level |
///
/// A curve without an inflection is not shifted, v* = 0. The parameters are those of the law; v* follows from them, and
/// at dual numbers so do its derivatives of first order.
///
/// ```
/// use fmm_friction::{MakkarDixon, ShiftedMakkarDixon, SlidingLaw};
///
/// let law = ShiftedMakkarDixon::new(MakkarDixon::five(0.25, 100.0, 10.0, 0.1, 100.0)?);
/// assert!((law.inflection() - 0.037_451_077_446_664_115_f64).abs() < 1e-16);
/// assert!((law.breakaway() - 0.260_126_521_317_483_43_f64).abs() < 1e-15);
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShiftedMakkarDixon<D = f64> {
    law: MakkarDixon<D>,
    inflection: D,
}

impl<D: Scalar> ShiftedMakkarDixon<D> {
    /// `law` from its inflection on.
    pub fn new(law: MakkarDixon<D>) -> Self {
        Self { law, inflection: law.inflection() }
    }

    /// The law before the shift.
    pub fn law(&self) -> &MakkarDixon<D> {
        &self.law
    }

    /// v*, the shift (m/s).
    pub fn inflection(&self) -> D {
        self.inflection
    }
}

impl<D: Scalar> SlidingLaw<D> for ShiftedMakkarDixon<D> {
    fn coefficient(&self, speed: D) -> D {
        self.law.coefficient(speed + self.inflection)
    }

    fn breakaway(&self) -> D {
        self.coefficient(D::from(0.0))
    }
}

impl<D: Scalar> FamilyMember for ShiftedMakkarDixon<D> {
    type Number = D;
    type Family = ShiftedMakkarDixon;
}

impl LawFamily for ShiftedMakkarDixon {
    const NAME: &'static str = "makkar_dixon_shifted";
    const PARAMETERS: &'static [LawParameter] = MakkarDixon::PARAMETERS;
    const SPECIAL_CASES: &'static [SpecialCase] = MakkarDixon::SPECIAL_CASES;
    const SEARCH: SearchRole = SearchRole::NotTried(
        "its curve beyond the inflection is nearly that of a Stribeck law, which has fewer parameters",
    );
    type At<D: Scalar> = ShiftedMakkarDixon<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<ShiftedMakkarDixon<D>, LawError> {
        MakkarDixon::at(values).map(Self::At::new)
    }

    fn visit<D: Scalar, V: LawVisitor<D, Self::At<D>>>(visitor: V) -> V::Output {
        visitor.sliding()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::Dual;

    fn thesis() -> MakkarDixon {
        MakkarDixon::five(0.25, 100.0, 10.0, 0.1, 100.0).unwrap()
    }

    #[test]
    fn slopes_are_those_of_the_coefficient() {
        let law = MakkarDixon::six(0.25, 100.0, 10.0, 0.1, 40.0, 0.3).unwrap();
        for speed in [0.001, 0.02, 0.08, 0.4] {
            let coefficient = law.at_dual().coefficient(Dual::variable(speed, 0));
            let slopes = law.slopes(speed);
            assert!((slopes[0] - coefficient.partial(0)).abs() < 1e-13, "at {speed} m/s");
            // Each slope is the derivative of the one before; terms are up to γ³ = 1e6.
            let next = law.at_dual().slopes(Dual::variable(speed, 0));
            for order in [0, 1] {
                let error = (next[order].partial(0) - slopes[order + 1]).abs();
                assert!(error < 1e-9, "slope {order} at {speed} m/s is off by {error}");
            }
        }
    }

    impl MakkarDixon {
        fn at_dual(&self) -> MakkarDixon<Dual<1>> {
            MakkarDixon::at(&self.values().map(Dual::from)).unwrap()
        }
    }

    #[test]
    fn peak_is_where_the_slope_vanishes() {
        let (speed, coefficient) = thesis().peak().unwrap();
        assert!(thesis().slopes(speed)[0].abs() < 1e-13, "slope {} s/m", thesis().slopes(speed)[0]);
        for other in [0.9 * speed, 1.1 * speed] {
            assert!(thesis().coefficient(other) < coefficient);
        }
        // By the envelope theorem the height of the peak changes as the coefficient at a fixed speed does.
        let values = [0.25, 100.0, 10.0, 0.1, 100.0, 0.0];
        let mut index = 0;
        let law = MakkarDixon::at(&values.map(|value| {
            index += 1;
            Dual::<6>::variable(value, index - 1)
        }))
        .unwrap();
        let ((_, height), fixed) = (law.peak().unwrap(), law.coefficient(Dual::from(speed)));
        for direction in 0..6 {
            let (one, other) = (height.partial(direction), fixed.partial(direction));
            assert!((one - other).abs() < 1e-13, "γ{}: {one} against {other}", direction + 1);
        }
    }

    #[test]
    fn a_curve_that_only_grows_has_no_peak_and_no_inflection() {
        for law in [
            MakkarDixon::five(0.0, 100.0, 10.0, 0.1, 100.0).unwrap(),
            MakkarDixon::six(0.25, 100.0, 10.0, 0.1, 100.0, 5.0).unwrap(),
        ] {
            assert_eq!(law.peak(), None);
            assert_eq!(law.inflection(), 0.0);
        }
    }

    #[test]
    fn extreme_parameters_end_the_search() {
        for fall in [f64::MIN_POSITIVE, 1e-200, 99.999] {
            let law = MakkarDixon::five(0.25, 100.0, fall, 0.1, 0.0).unwrap();
            assert!(law.inflection().is_finite(), "γ₃ = {fall} s/m");
        }
    }

    #[test]
    fn a_fall_quicker_than_the_rise_is_refused() {
        let refused = MakkarDixon::five(0.25, 10.0, 10.0, 0.1, 100.0).unwrap_err();
        assert_eq!(refused.to_string(), "γ₂ must be greater than γ₃, but γ₂ = 10 and γ₃ = 10");
    }

    const THESIS: [f64; 6] = [0.25, 100.0, 10.0, 0.1, 100.0, 0.0];

    #[test]
    fn starts_at_its_static_level_and_falls() {
        let law = ShiftedMakkarDixon::at(&THESIS).unwrap();
        assert_eq!(law.coefficient(0.0), law.breakaway());
        assert_eq!(law.coefficient(0.1), law.law.coefficient(0.1 + law.inflection()));
        assert!(law.coefficient(0.01) < law.breakaway());
    }

    /// v* was found by no derivative of itself: its own must be those of differences. Steps of 1e-6 leave 1e-12 times
    /// third derivatives and 1e-16/1e-6 of rounding, over sensitivities near 1e-3.
    #[test]
    fn the_shift_has_its_derivatives() {
        let seeded: Vec<_> = THESIS.iter().enumerate().map(|(i, value)| Dual::<6>::variable(*value, i)).collect();
        let dual = ShiftedMakkarDixon::at(&seeded).unwrap();
        for direction in 0..6 {
            let step = 1e-6 * THESIS[direction].max(1.0);
            let shift = |change: f64| {
                let mut values = THESIS;
                values[direction] += change;
                ShiftedMakkarDixon::at(&values).map(|law| law.inflection())
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
        let law = ShiftedMakkarDixon::at(&[0.0, 100.0, 10.0, 0.1, 100.0, 0.0]).unwrap();
        assert_eq!((law.inflection(), law.breakaway()), (0.0, 0.0));
    }
}
