//! Regression on a straight line.

use crate::{LinearRegression, Polynomial, Prediction, RegressionError, Weighting};

/// A straight line through observations.
///
/// ```text
/// ŷ = intercept + slope·x
/// ```
///
/// ```
/// use fmm_fit::{StraightLine, Weighting};
///
/// // Table 1 of the thesis: damping (N s/m) against peak velocity (m/s).
/// let velocity = [0.050, 0.076, 0.103, 0.129, 0.181, 0.207, 0.233, 0.258, 0.283];
/// let damping = [0.222, 0.235, 0.245, 0.256, 0.278, 0.288, 0.299, 0.313, 0.327];
/// let line = StraightLine::fit(&velocity, &damping, Weighting::Equal)?;
/// assert!((line.slope() - 0.4360).abs() < 5e-5);
/// assert!((line.intercept() - 0.2000).abs() < 5e-5);
/// assert!((line.regression().r_squared().unwrap() - 0.9972).abs() < 5e-5);
/// # Ok::<(), fmm_fit::RegressionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct StraightLine {
    polynomial: Polynomial,
}

impl StraightLine {
    /// Fits a straight line to `y` at the abscissae `x`. [`Polynomial::fit_through_origin`] fits one without intercept,
    /// and [`YorkLine`](crate::YorkLine) one with uncertainties in both variables.
    ///
    /// # Errors
    /// As for [`Polynomial::fit`].
    pub fn fit(x: &[f64], y: &[f64], weighting: Weighting<'_>) -> Result<Self, RegressionError> {
        Polynomial::fit(x, y, 1, weighting).map(|polynomial| Self { polynomial })
    }

    /// Value at x = 0.
    pub fn intercept(&self) -> f64 {
        self.polynomial.coefficients()[0]
    }

    /// Change of the value with x.
    pub fn slope(&self) -> f64 {
        self.polynomial.coefficients()[1]
    }

    /// Standard uncertainty of the intercept; `None` without a degree of freedom to tell s.
    pub fn intercept_uncertainty(&self) -> Option<f64> {
        self.regression().standard_uncertainty(0)
    }

    /// Standard uncertainty of the slope; `None` without a degree of freedom to tell s.
    pub fn slope_uncertainty(&self) -> Option<f64> {
        self.regression().standard_uncertainty(1)
    }

    /// Residuals, R² and what else there is to know; column 0 is the intercept and 1 the slope.
    pub fn regression(&self) -> &LinearRegression {
        self.polynomial.regression()
    }

    /// The value of the line at `x`.
    pub fn value(&self, x: f64) -> f64 {
        self.polynomial.value(x)
    }

    /// The prediction at `x`; `None` without a degree of freedom to tell s.
    pub fn predict(&self, x: f64) -> Option<Prediction> {
        self.polynomial.predict(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thesis, Table 1, whose line the text gives as 0.437 and 0.2005 without uncertainties.
    #[test]
    fn damping_grows_with_velocity() {
        let velocity = [0.050, 0.076, 0.103, 0.129, 0.181, 0.207, 0.233, 0.258, 0.283];
        let damping = [0.222, 0.235, 0.245, 0.256, 0.278, 0.288, 0.299, 0.313, 0.327];
        let line = StraightLine::fit(&velocity, &damping, Weighting::Equal).unwrap();
        // 0.4360(87) and 0.2000(16).
        let (slope, intercept) = (line.slope_uncertainty().unwrap(), line.intercept_uncertainty().unwrap());
        assert!((slope - 0.0087).abs() < 5e-5, "u of the slope {slope} N s²/m²");
        assert!((intercept - 0.0016).abs() < 5e-5, "u of the intercept {intercept} N s/m");
        assert!((line.slope() - 0.437).abs() < slope && (line.intercept() - 0.2005).abs() < intercept);
    }

    /// `get_prediction` of statsmodels 0.15 at x = 2.7.
    #[test]
    fn bands_are_those_of_statsmodels() {
        let x: Vec<f64> = (0..12).map(|i| 0.5 * f64::from(i)).collect();
        let y = [1.1, 1.4, 2.2, 2.3, 3.1, 3.2, 4.3, 4.4, 5.5, 5.6, 6.9, 7.2];
        let at = StraightLine::fit(&x, &y, Weighting::Equal).unwrap().predict(2.7).unwrap();
        let (lower, upper) = at.confidence(0.95).unwrap();
        let (lowest, highest) = at.observation(0.95, 1.0).unwrap();
        let found = [at.value(), at.standard_uncertainty(), lower, upper, lowest, highest];
        let expected = [
            3.876_899_766_899_767,
            0.084_926_646_931_154_22,
            3.687_671_405_303_541_8,
            4.066_128_128_495_992_5,
            3.194_891_283_514_332,
            4.558_908_250_285_202,
        ];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-10, "{found} instead of {expected}");
        }
    }
}
