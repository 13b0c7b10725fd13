//! Prediction of a new observation by a fitted model, with its uncertainty.

use fmm_model::coverage_factor;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

use crate::result::estimate::{Estimate, EstimateStatus};
use crate::result::fit::Fit;

/// The value of a fitted model at a new point with its uncertainty, by the law of propagation.
///
/// ```text
/// u² = gᵀ V g,     g = ∂f/∂θ at the fitted values
/// ```
///
/// | interval | method | half width |
/// |---|---|---|
/// | of the model at this point | [`confidence`](Self::confidence) | t_{(1+level)/2, ν} u |
/// | of the model at all points together | [`simultaneous`](Self::simultaneous) | √(p F_{level; p, ν}) u |
/// | of a new observation at this point | [`observation`](Self::observation) | t_{(1+level)/2, ν} √(u² + s²) |
///
/// Exact for models linear in their parameters with independent normal residuals; otherwise good as far as the model
/// is straight within a few standard uncertainties.
///
/// # References
/// H. Working, H. Hotelling, J. Am. Stat. Assoc. 24 (1929) 73; H. Scheffé, Biometrika 40 (1953) 87,
/// <https://doi.org/10.1093/biomet/40.1-2.87>.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    value: f64,
    standard_uncertainty: f64,
    residual_deviation: f64,
    rank: usize,
    /// Infinite if the uncertainties of the observations were known.
    freedom: f64,
}

impl Prediction {
    /// `None` unless all is finite and there is a degree of freedom.
    pub(crate) fn new(
        value: f64,
        variance: f64,
        residual_deviation: f64,
        rank: usize,
        degrees_of_freedom: f64,
    ) -> Option<Self> {
        let is_good = value.is_finite() && variance >= 0.0 && variance.is_finite() && degrees_of_freedom > 0.0;
        let standard_uncertainty = variance.sqrt();
        is_good.then_some(Self { value, standard_uncertainty, residual_deviation, rank, freedom: degrees_of_freedom })
    }

    /// The value of the model.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// u, standard uncertainty of the value of the model.
    pub fn standard_uncertainty(&self) -> f64 {
        self.standard_uncertainty
    }

    /// The interval that holds the value of the model at this one point with probability `level`; `None` for a level
    /// outside (0, 1).
    pub fn confidence(&self, level: f64) -> Option<(f64, f64)> {
        Some(self.around(coverage_factor(level, self.freedom)? * self.standard_uncertainty))
    }

    /// The interval of Working, Hotelling and Scheffé: the intervals at *all* points hold the model with probability
    /// `level`, as does a band drawn through them. `None` for a level outside (0, 1).
    pub fn simultaneous(&self, level: f64) -> Option<(f64, f64)> {
        let factor = simultaneous_coverage_factor(level, self.rank, self.freedom)?;
        Some(self.around(factor * self.standard_uncertainty))
    }

    /// The interval that holds a new observation at this point with probability `level`; `None` for a level outside
    /// (0, 1), or an uncertainty that is negative.
    ///
    /// `uncertainty` is the standard uncertainty of the new observation in the measure in which those of the fitted
    /// ones were given: 1 if they were not weighted, its value if their residuals were divided by absolute or relative
    /// uncertainties.
    pub fn observation(&self, level: f64, uncertainty: f64) -> Option<(f64, f64)> {
        if !(uncertainty >= 0.0 && uncertainty.is_finite()) {
            return None;
        }
        let deviation = self.standard_uncertainty.hypot(self.residual_deviation * uncertainty);
        Some(self.around(coverage_factor(level, self.freedom)? * deviation))
    }

    fn around(&self, reach: f64) -> (f64, f64) {
        (self.value - reach, self.value + reach)
    }
}

impl Fit {
    /// The prediction of a quantity whose `value` at the fitted parameters and whose `gradient`, one derivative per
    /// parameter, are given.
    ///
    /// `None` if the gradient has not one number per parameter, if it has a component along a parameter that is not
    /// determined, or without a degree of freedom. Parameters that are fixed or at a bound count as known.
    ///
    /// ```
    /// # use fmm_fit::{EvaluationError, Options, Residuals, solve};
    /// # use fmm_model::Parameter;
    /// # struct Mean { data: [f64; 4], parameters: [Parameter; 1] }
    /// # impl Residuals for Mean {
    /// #     fn parameters(&self) -> &[Parameter] { &self.parameters }
    /// #     fn len(&self) -> usize { 4 }
    /// #     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
    /// #         residuals.iter_mut().zip(&self.data).for_each(|(r, y)| *r = p[0] - y);
    /// #         Ok(())
    /// #     }
    /// # }
    /// // The mean of four observations with a standard deviation of 0.2, predicted for a fifth.
    /// let problem = Mean { data: [1.1, 0.9, 1.2, 0.8], parameters: [Parameter::new("mean", "m", "1")] };
    /// let fit = solve(&problem, &[0.0], &Options::default())?;
    /// let fifth = fit.predict(fit.values()[0], &[1.0]).unwrap();
    /// // s = √(0.1/3), u = s/2, t = 3.182
    /// let (lower, upper) = fifth.observation(0.95, 1.0).unwrap();
    /// assert!((lower - 0.3504).abs() < 1e-4 && (upper - 1.6496).abs() < 1e-4);
    /// # Ok::<(), fmm_fit::FitError>(())
    /// ```
    pub fn predict(&self, value: f64, gradient: &[f64]) -> Option<Prediction> {
        let deviation = self.residual_standard_deviation()?;
        let variance = deviation * deviation * self.unit_variance(gradient)?;
        Prediction::new(value, variance, deviation, self.rank(), self.degrees_of_freedom() as f64)
    }

    /// gᵀ (Jᵀ J)⁺ g; `None` for a gradient of another length, or along a parameter that is not determined.
    pub(crate) fn unit_variance(&self, gradient: &[f64]) -> Option<f64> {
        let is_lost = |(g, estimate): (&f64, &Estimate)| *g != 0.0 && estimate.status() == EstimateStatus::Undetermined;
        if gradient.len() != self.estimates().len() || gradient.iter().zip(self.estimates()).any(is_lost) {
            return None;
        }
        let mut variance = 0.0;
        for (i, a) in gradient.iter().enumerate() {
            for (j, b) in gradient.iter().enumerate() {
                variance += self.unit_covariance(i, j).map_or(0.0, |covariance| a * covariance * b);
            }
        }
        // Rounding may leave a variance of zero slightly negative.
        Some(if variance < 0.0 { 0.0 } else { variance })
    }

    /// [`predict`](Self::predict) for the quantity that `model` computes from the parameters, whose gradient is
    /// taken by differences within the bounds.
    ///
    /// A step is the standard uncertainty of the parameter times the cube root of ε, or that share of its value if
    /// this is larger; to both sides where the bounds allow it.
    pub fn predict_by_differences(&self, model: impl Fn(&[f64]) -> f64) -> Option<Prediction> {
        let mut values = self.values().to_vec();
        let value = model(&values);
        let mut gradient = vec![0.0; values.len()];
        for (j, estimate) in self.estimates().iter().enumerate() {
            if estimate.status().is_at_bound() || estimate.status() == EstimateStatus::Fixed {
                continue;
            }
            let magnitude = estimate.value().abs().max(estimate.standard_uncertainty().unwrap_or(0.0));
            let step = f64::EPSILON.cbrt() * if magnitude > 0.0 { magnitude } else { 1.0 };
            let bounds = estimate.parameter().bounds();
            let (above, below) = (bounds.clamp(estimate.value() + step), bounds.clamp(estimate.value() - step));
            values[j] = above;
            let high = model(&values);
            values[j] = below;
            gradient[j] = (high - model(&values)) / (above - below);
            values[j] = estimate.value();
        }
        self.predict(value, &gradient)
    }
}

/// Degrees of freedom above which the expansion about the χ² distribution is the more accurate (1). From 10⁷ on the
/// inverse of statrs is wrong in the first digits, and from 10⁸ on it does not end.
const MANY_FOR_FISHER: f64 = 1e4;

/// The factor for `order` estimates, and all that depends on them linearly, at once (Scheffé).
pub(crate) fn simultaneous_coverage_factor(level: f64, order: usize, degrees_of_freedom: f64) -> Option<f64> {
    if !(level > 0.0 && level < 1.0 && degrees_of_freedom > 0.0) {
        return None;
    }
    let count = order as f64;
    let square = if degrees_of_freedom <= MANY_FOR_FISHER {
        count * FisherSnedecor::new(count, degrees_of_freedom).ok()?.inverse_cdf(level)
    } else {
        let square = ChiSquared::new(count).ok()?.inverse_cdf(level);
        square * (1.0 + 0.5 * (square - count + 2.0) / degrees_of_freedom)
    };
    Some(square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_model::coverage_factor;

    /// Quantiles of scipy.stats 1.17: t, F, χ² and normal.
    #[test]
    fn half_widths_are_quantiles() {
        let prediction = Prediction::new(0.0, 1.0, 2.0, 2, 7.0).unwrap();
        let reach = |interval: Option<(f64, f64)>| interval.unwrap().1;
        let t = 2.364_624_251_592_784;
        // statrs inverts the incomplete beta function to about ten digits.
        assert!((reach(prediction.confidence(0.95)) / t - 1.0).abs() < 1e-9);
        assert!((reach(prediction.observation(0.95, 1.0)) / (t * 5f64.sqrt()) - 1.0).abs() < 1e-9);
        let f = (2.0f64 * 4.737_414_127_775_881).sqrt();
        assert!((reach(prediction.simultaneous(0.95)) / f - 1.0).abs() < 1e-9);
        let known = Prediction::new(0.0, 1.0, 1.0, 2, f64::INFINITY).unwrap();
        assert!((reach(known.confidence(0.95)) / 1.959_963_984_540_054 - 1.0).abs() < 1e-9);
        let chi = 5.991_464_547_107_979f64.sqrt();
        assert!((reach(known.simultaneous(0.95)) / chi - 1.0).abs() < 1e-9);
    }

    #[test]
    fn what_has_no_meaning_has_no_interval() {
        let prediction = Prediction::new(0.0, 1.0, 2.0, 2, 7.0).unwrap();
        assert_eq!(prediction.confidence(1.0), None);
        assert_eq!(prediction.simultaneous(f64::NAN), None);
        assert_eq!(prediction.observation(0.95, -1.0), None);
        assert_eq!(Prediction::new(0.0, 1.0, 2.0, 2, 0.0), None);
        assert_eq!(Prediction::new(f64::NAN, 1.0, 2.0, 2, 1.0), None);
    }

    /// One estimate at once is one estimate: F of (1, ν) is the square of t of ν. Tables: t and χ² of Abramowitz and
    /// Stegun.
    #[test]
    fn factors_are_continuous_to_infinitely_many_degrees_of_freedom() {
        for (freedom, expected) in
            [(1.0, 12.706_205), (10.0, 2.228_139), (120.0, 1.979_930), (f64::INFINITY, 1.959_964)]
        {
            assert!((coverage_factor(0.95, freedom).unwrap() - expected).abs() < 1e-6, "{freedom} degrees of freedom");
        }
        assert!((simultaneous_coverage_factor(0.95, 3, f64::INFINITY).unwrap() - 7.814_728f64.sqrt()).abs() < 1e-6);
        for level in [0.5, 0.95, 0.9973] {
            let mut last = (f64::INFINITY, f64::INFINITY);
            for freedom in [900.0, 1100.0, 9e3, 1.1e4, 1e6, 1e7, 1e9, 1e15, f64::INFINITY] {
                let one = coverage_factor(level, freedom).unwrap();
                let same = simultaneous_coverage_factor(level, 1, freedom).unwrap();
                assert!((same / one - 1.0).abs() < 1e-6, "{one} and {same} at {freedom}");
                let three = simultaneous_coverage_factor(level, 3, freedom).unwrap();
                assert!(one <= last.0 && three <= last.1, "{one}, {three} at {freedom} after {last:?}");
                last = (one, three);
            }
        }
    }

    #[test]
    fn impossible_intervals_have_no_factor() {
        for (level, freedom) in [(0.0, 10.0), (1.0, 10.0), (f64::NAN, 10.0), (0.95, 0.0), (0.95, f64::NAN)] {
            assert_eq!(coverage_factor(level, freedom), None);
            assert_eq!(simultaneous_coverage_factor(level, 2, freedom), None);
        }
    }
}
