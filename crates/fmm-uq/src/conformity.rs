//! Conformity with limits of tolerance, after JCGM 106:2012.

use fmm_model::{Rounded, student_quantile};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::error::UncertaintyError;

/// Degrees of freedom from which on Student's t is the normal distribution to nine digits of a probability.
const NORMAL_ABOVE: f64 = 1e8;

/// Limits that a quantity has to keep, on one side or on both.
///
/// ```text
/// p_c = F((T_U − y)/u) − F((T_L − y)/u),   specific risk = 1 − p_c       (JCGM 106:2012, 7.1, 7.2, 9.3.2)
/// A_U = T_U − w,   A_L = T_L + w,   w = r U                              (JCGM 106:2012, 8.3.2, 8.3.3)
/// ```
///
/// | symbol | meaning |
/// |---|---|
/// | T_L, T_U | tolerance limits |
/// | A_L, A_U | acceptance limits: a measured value within these is accepted |
/// | p_c | probability that the quantity conforms, given the measured value |
/// | w | guard band |
/// | F | Student's t of ν degrees of freedom, or the normal distribution |
///
/// What is known of the quantity is the measurement alone: nothing is assumed of how the quantity varies from item to
/// item, of which global risks would need a model.
///
/// ```
/// use fmm_uq::ToleranceInterval;
///
/// // Kinematic viscosity of an oil, 12.5 mm²/s to 16.3 mm²/s, measured 13.6 mm²/s with u = 1.8 mm²/s.
/// let tolerance = ToleranceInterval::new(12.5, 16.3)?;
/// let risk = tolerance.specific_risk(13.6, 1.8, f64::INFINITY)?;
/// assert!((1.0 - risk - 0.66).abs() < 5e-3);
/// // A guard band of U would accept nothing; one of half of u still does.
/// assert!(tolerance.guarded(3.6).is_err());
/// assert!(tolerance.guarded(0.9)?.holds(13.6));
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
///
/// # References
/// JCGM 106:2012, *Evaluation of measurement data – The role of measurement uncertainty in conformity assessment*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToleranceInterval {
    lower: f64,
    upper: f64,
}

impl ToleranceInterval {
    /// Interval from `lower` to `upper` (unit of the quantity); a side without a limit is infinite.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless lower < upper and one of them is finite.
    pub fn new(lower: f64, upper: f64) -> Result<Self, UncertaintyError> {
        if lower < upper && (lower.is_finite() || upper.is_finite()) {
            return Ok(Self { lower, upper });
        }
        let [lower, upper] = [lower, upper].map(Rounded::every_digit);
        let what = format!(
            "a tolerance has a lower limit, a larger upper limit, or both, but is given from {lower} to {upper}"
        );
        Err(UncertaintyError::invalid(what))
    }

    /// Lower limit (unit of the quantity), or −∞.
    pub const fn lower(&self) -> f64 {
        self.lower
    }

    /// Upper limit (unit of the quantity), or ∞.
    pub const fn upper(&self) -> f64 {
        self.upper
    }

    /// True for a value within the limits, these included.
    pub fn holds(&self, value: f64) -> bool {
        (self.lower..=self.upper).contains(&value)
    }

    /// Probability (1) that the quantity does not conform, although its measured value is `estimate`, with standard
    /// uncertainty u of ν `degrees_of_freedom`: the specific risk of accepting it. What is left of 1 is p_c.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an estimate that is not finite, an uncertainty that is negative or not finite,
    /// and degrees of freedom below 1.
    pub fn specific_risk(
        &self,
        estimate: f64,
        standard_uncertainty: f64,
        degrees_of_freedom: f64,
    ) -> Result<f64, UncertaintyError> {
        if !estimate.is_finite() {
            return Err(UncertaintyError::out_of_range("measured value", estimate, "finite"));
        }
        if !(standard_uncertainty >= 0.0 && standard_uncertainty.is_finite()) {
            let unit = "(unit of the quantity)";
            return Err(UncertaintyError::uncertainty_out_of_range("the quantity", standard_uncertainty, unit));
        }
        let nu = UncertaintyError::require_degrees_of_freedom("the quantity", degrees_of_freedom)?;
        if standard_uncertainty == 0.0 {
            return Ok(if self.holds(estimate) { 0.0 } else { 1.0 });
        }
        let beyond = |limit: f64, sign: f64| tail((limit - estimate) * sign / standard_uncertainty, nu);
        Ok((beyond(self.upper, 1.0) + beyond(self.lower, -1.0)).min(1.0))
    }

    /// The acceptance limits with a guard band w (unit of the quantity) within each limit; a negative one lies outside
    /// (guarded rejection).
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for a guard band that is not finite, [`UncertaintyError::NoAnswer`] if it leaves
    /// nothing to accept.
    pub fn guarded(&self, guard_band: f64) -> Result<Self, UncertaintyError> {
        if !guard_band.is_finite() {
            return Err(UncertaintyError::out_of_range("guard band", guard_band, "finite"));
        }
        let (lower, upper) = (self.lower + guard_band, self.upper - guard_band);
        if lower <= upper {
            return Ok(Self { lower, upper });
        }
        let [band, width] = [guard_band, self.upper - self.lower].map(Rounded::every_digit);
        Err(UncertaintyError::no_answer(format!(
            "guard bands of {band} on both sides leave nothing of a tolerance of {width}; measure better or take a \
             smaller band"
        )))
    }

    /// The acceptance limits within which the specific risk of accepting is at most `risk` (1), for measured values of
    /// standard uncertainty u with ν `degrees_of_freedom`.
    ///
    /// ```text
    /// A_U = T_U − t_ν(1 − risk) u for one limit; for two, both tails together
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless 0 < risk ≤ 1/2, and as for
    /// [`specific_risk`](ToleranceInterval::specific_risk); [`UncertaintyError::NoAnswer`] if even a value in the middle
    /// has a greater risk.
    pub fn at_risk(
        &self,
        standard_uncertainty: f64,
        degrees_of_freedom: f64,
        risk: f64,
    ) -> Result<Self, UncertaintyError> {
        if !(risk > 0.0 && risk <= 0.5) {
            return Err(UncertaintyError::out_of_range("risk", risk, "above 0 and at most 0.5"));
        }
        let any = if self.lower.is_finite() { self.lower } else { self.upper };
        self.specific_risk(any, standard_uncertainty, degrees_of_freedom)?;
        let band = student_quantile(risk, degrees_of_freedom) * standard_uncertainty;
        if !(self.lower.is_finite() && self.upper.is_finite()) || standard_uncertainty == 0.0 {
            return self.guarded(band);
        }
        let half = 0.5 * self.upper - 0.5 * self.lower;
        let exceeds = |band: f64| {
            let near = tail(band / standard_uncertainty, degrees_of_freedom);
            near + tail((2.0 * half - band) / standard_uncertainty, degrees_of_freedom) > risk
        };
        if exceeds(half) {
            let least = 2.0 * tail(half / standard_uncertainty, degrees_of_freedom);
            return Err(UncertaintyError::no_answer(format!(
                "no measured value has a risk of {risk} or less: even in the middle of the tolerance it is {least:.3}; \
                 measure better or allow more risk"
            )));
        }
        // The other tail widens the band of one limit; between that and the middle the risk falls.
        let (mut small, mut large) = (band.min(half), half);
        while exceeds(small) {
            let middle = 0.5 * (small + large);
            if !(middle > small && middle < large) {
                break;
            }
            if exceeds(middle) { small = middle } else { large = middle }
        }
        self.guarded(if exceeds(small) { large } else { small })
    }
}

/// Probability (1) that Student's t of ν degrees of freedom, or the normal variable, exceeds `value`, which may be
/// infinite.
fn tail(value: f64, nu: f64) -> f64 {
    if value.is_infinite() {
        return if value > 0.0 { 0.0 } else { 1.0 };
    }
    match StudentsT::new(0.0, 1.0, nu) {
        Ok(student) if nu < NORMAL_ABOVE => student.sf(value),
        _ => Normal::standard().sf(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn between(lower: f64, upper: f64) -> ToleranceInterval {
        ToleranceInterval::new(lower, upper).unwrap()
    }

    /// Examples of JCGM 106:2012, 7.4 and 7.5, printed figures from memory: a Zener diode, a vessel under pressure, an oil.
    #[test]
    fn probabilities_are_those_of_the_guide() {
        for (tolerance, estimate, u, printed) in [
            (between(f64::NEG_INFINITY, -5.40), -5.47, 0.05, 0.92),
            (between(490.0, f64::INFINITY), 509.7, 8.6, 0.99),
            (between(12.5, 16.3), 13.6, 1.8, 0.66),
        ] {
            let conforms = 1.0 - tolerance.specific_risk(estimate, u, f64::INFINITY).unwrap();
            assert!((conforms - printed).abs() < 5e-3, "{conforms} instead of {printed}");
        }
    }

    /// Closed forms: ν = 1 is Cauchy's distribution, ν = 2 has F = 1/2 + t/(2 √(2 + t²)).
    #[test]
    fn few_degrees_of_freedom_make_tails_heavy() {
        let above = between(f64::NEG_INFINITY, 1.0);
        for t in [-3.0_f64, 0.0, 0.5, 2.0, 30.0] {
            let risk = |nu: f64| above.specific_risk(1.0 - 0.2 * t, 0.2, nu).unwrap();
            assert!((risk(1.0) - (0.5 - t.atan() / std::f64::consts::PI)).abs() < 1e-12, "t = {t}");
            assert!((risk(2.0) - (0.5 - t / (2.0 * (2.0 + t * t).sqrt()))).abs() < 1e-12, "t = {t}");
            // They differ by t (t² + 1) φ(t)/(4 ν).
            assert!((risk(1e7) - risk(f64::INFINITY)).abs() < 1e-7, "t = {t}");
            assert_eq!(risk(1e9), risk(f64::INFINITY), "t = {t}");
        }
        // 10 u away the normal risk is 7.619 853e-24, of which a difference from 1 would leave nothing.
        let small = above.specific_risk(-1.0, 0.2, f64::INFINITY).unwrap();
        assert!((small / 7.619_853_024_160_527e-24 - 1.0).abs() < 1e-9, "{small}");
    }

    #[test]
    fn certain_values_conform_or_not() {
        let tolerance = between(1.0, 2.0);
        for (value, risk) in [(0.999, 1.0), (1.0, 0.0), (2.0, 0.0), (2.001, 1.0)] {
            assert_eq!(tolerance.specific_risk(value, 0.0, 5.0).unwrap(), risk, "{value}");
        }
        assert_eq!(tolerance.at_risk(0.0, f64::INFINITY, 0.05).unwrap(), tolerance);
    }

    /// At the acceptance limits the risk is the one allowed, and just within it is smaller.
    #[test]
    fn acceptance_limits_have_the_risk_that_is_allowed() {
        // z of 95 % within a single limit.
        let single = between(f64::NEG_INFINITY, 10.0).at_risk(0.5, f64::INFINITY, 0.05).unwrap();
        assert!((single.upper() - (10.0 - 0.5 * 1.644_853_626_951_472_7)).abs() < 1e-12, "{}", single.upper());
        for (width, nu) in [(20.0, f64::INFINITY), (4.0, f64::INFINITY), (2.05, f64::INFINITY), (4.0, 6.0)] {
            let tolerance = between(0.0, width);
            let accepted = tolerance.at_risk(0.5, nu, 0.05).unwrap();
            let risk = |value: f64| tolerance.specific_risk(value, 0.5, nu).unwrap();
            assert!((risk(accepted.upper()) - 0.05).abs() < 1e-9, "{width}: {}", risk(accepted.upper()));
            assert!((accepted.lower() + accepted.upper() - width).abs() < 1e-12, "{accepted:?}");
            assert!(risk(accepted.upper() - 1e-3 * width) < 0.05);
        }
        let error = between(0.0, 1.9).at_risk(0.5, f64::INFINITY, 0.05).unwrap_err().to_string();
        assert!(error.contains("in the middle of the tolerance it is 0.057"), "{error}");
    }

    #[test]
    fn guard_bands_lie_on_either_side_of_the_limits() {
        let tolerance = between(1.0, 2.0);
        assert_eq!(tolerance.guarded(0.25).unwrap(), between(1.25, 1.75));
        assert_eq!(tolerance.guarded(-0.25).unwrap(), between(0.75, 2.25));
        assert!(tolerance.guarded(0.6).unwrap_err().to_string().contains("leave nothing"));
        assert!(tolerance.guarded(f64::NAN).is_err());
        for (lower, upper) in [(2.0, 1.0), (1.0, 1.0), (f64::NAN, 1.0), (f64::NEG_INFINITY, f64::INFINITY)] {
            assert!(ToleranceInterval::new(lower, upper).is_err(), "{lower} to {upper}");
        }
        for (estimate, u, nu) in [(f64::NAN, 0.1, 5.0), (1.0, -0.1, 5.0), (1.0, f64::NAN, 5.0), (1.0, 0.1, 0.5)] {
            assert!(tolerance.specific_risk(estimate, u, nu).is_err(), "{estimate}, {u}, {nu}");
        }
        for risk in [0.0, 0.6, f64::NAN] {
            assert!(tolerance.at_risk(0.1, 5.0, risk).is_err(), "{risk}");
        }
    }
}
