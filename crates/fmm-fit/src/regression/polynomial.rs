//! Regression on powers of an abscissa.

use crate::error::FitError;
use crate::regression::double_double::DoubleDouble;
use crate::regression::linear_regression::LinearRegression;
use crate::regression::weighting::{Weighting, check_finite, overflow, too_few_abscissae, too_few_observations};
use crate::result::prediction::Prediction;

/// A polynomial through observations.
///
/// ```text
/// ŷ = Σₖ βₖ xᵏ = Σⱼ aⱼ tʲ,     t = (x − centre)/scale
/// ```
///
/// The fit is done in t, of magnitude about 1, in which powers are far less alike; the scale is a power of two and the
/// centre a short number, so that the change of the variable rounds nothing, and powers are kept in twice the
/// precision. The coefficients βₖ are then as right as the digits of the abscissae allow, also where powers of x as
/// columns would leave none.
///
/// ```
/// use fmm_fit::{Polynomial, Weighting};
///
/// let x = [1000.0, 1001.0, 1002.0, 1003.0, 1004.0];
/// let y = x.map(|x| 2.0 + 3.0 * x + 0.5 * x * x);
/// let parabola = Polynomial::fit(&x, &y, 2, Weighting::Equal)?;
/// assert!((parabola.coefficients()[0] - 2.0).abs() < 1e-8);
/// assert_eq!(parabola.value(1002.0), 505_010.0);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Polynomial {
    /// Coefficients of the powers of x.
    regression: LinearRegression,
    /// Coefficients and roots of the covariance in powers of t.
    local_coefficients: Vec<f64>,
    local_roots: Vec<Vec<f64>>,
    centre: f64,
    scale: f64,
}

impl Polynomial {
    /// Fits a polynomial of the given `order`, which has order + 1 coefficients, to `y` at the abscissae `x`.
    ///
    /// # Errors
    /// [`FitError`] if lengths differ, a value is not finite, an uncertainty not positive, or if there are not
    /// order + 1 different abscissae.
    pub fn fit(x: &[f64], y: &[f64], order: usize, weighting: Weighting<'_>) -> Result<Self, FitError> {
        check_finite("x", x, y.len())?;
        let coefficients = order.saturating_add(1);
        if x.len() < coefficients {
            return Err(too_few_observations(x.len(), coefficients));
        }
        let distinct = count_distinct(x);
        if distinct < coefficients {
            return Err(too_few_abscissae(distinct, coefficients));
        }
        let (centre, scale) = frame(x);
        let span = scale.powf(order as f64);
        // A power of the scale that overflows would turn coefficients into zeros or infinities.
        if !(span.is_normal() && span.recip().is_normal()) {
            return Err(overflow());
        }
        let t: Vec<DoubleDouble> = x.iter().map(|x| DoubleDouble::difference(*x, centre).scaled(1.0 / scale)).collect();
        let mut columns: Vec<Vec<DoubleDouble>> = Vec::with_capacity(coefficients);
        columns.push(vec![DoubleDouble::from(1.0); x.len()]);
        for k in 1..coefficients {
            let next = columns[k - 1].iter().zip(&t).map(|(power, t)| *power * *t).collect();
            columns.push(next);
        }
        let names = (0..=order).map(|k| format!("x^{k}")).collect();
        let (mut regression, solution) = LinearRegression::of(names, columns, y, weighting, true)?;
        if regression.rank() < coefficients {
            return Err(too_few_abscissae(regression.rank(), coefficients));
        }
        let global = |local: &[DoubleDouble]| -> Vec<f64> { expand(local, centre, scale) };
        let local_coefficients = std::mem::replace(&mut regression.coefficients, global(&solution));
        let roots = regression.roots.iter().map(|root| {
            let root: Vec<DoubleDouble> = root.iter().map(|value| DoubleDouble::from(*value)).collect();
            global(&root)
        });
        let roots = roots.collect();
        let local_roots = std::mem::replace(&mut regression.roots, roots);
        let all = regression.coefficients.iter().chain(regression.roots.iter().flatten());
        if !all.copied().all(f64::is_finite) {
            return Err(overflow());
        }
        Ok(Self { regression, local_coefficients, local_roots, centre, scale })
    }

    /// The coefficients of the powers of x, from x⁰ on.
    pub fn coefficients(&self) -> &[f64] {
        self.regression.coefficients()
    }

    /// Uncertainties, residuals and what else there is to know of the coefficients; columns are the powers from x⁰
    /// on. Its singular values are those of the powers of t.
    pub fn regression(&self) -> &LinearRegression {
        &self.regression
    }

    /// The value of the polynomial at `x`.
    pub fn value(&self, x: f64) -> f64 {
        let t = (x - self.centre) / self.scale;
        self.local_coefficients.iter().rev().fold(0.0, |sum, a| sum * t + a)
    }

    /// The prediction at `x`; `None` without a degree of freedom to tell s.
    pub fn predict(&self, x: f64) -> Option<Prediction> {
        let t = (x - self.centre) / self.scale;
        let powers = std::iter::successors(Some(1.0), |power| Some(power * t));
        let row: Vec<f64> = powers.take(self.local_coefficients.len()).collect();
        self.regression.predict_by(&self.local_coefficients, &self.local_roots, &row)
    }
}

/// Centre and scale that bring all of `x` to magnitudes of about 1 without rounding.
fn frame(x: &[f64]) -> (f64, f64) {
    let (low, high) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let scale = power_of_two_above(0.5 * high - 0.5 * low);
    let grain = 0.125 * scale;
    let middle = 0.5 * low + 0.5 * high;
    let centre = (middle / grain).round() * grain;
    // A centre that is so far out that rounding to the grain does nothing is as good as it is.
    (if centre.is_finite() { centre } else { middle }, scale)
}

/// The least power of two not below a magnitude; 1 for zero.
fn power_of_two_above(magnitude: f64) -> f64 {
    if magnitude > 0.0 { magnitude.log2().ceil().clamp(-1000.0, 1000.0).exp2() } else { 1.0 }
}

/// Number of different values.
fn count_distinct(x: &[f64]) -> usize {
    let mut sorted = x.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    sorted.len()
}

/// Coefficients in powers of x from those in powers of t, by Horner's scheme.
fn expand(local: &[DoubleDouble], centre: f64, scale: f64) -> Vec<f64> {
    let mut power = 1.0;
    let mut values: Vec<DoubleDouble> = Vec::with_capacity(local.len());
    for value in local {
        values.push(value.scaled(power));
        power /= scale;
    }
    // Taylor shift: p(x − centre) = Σ βₖ xᵏ.
    let shift = DoubleDouble::from(-centre);
    for low in 0..values.len().saturating_sub(1) {
        for k in (low..values.len() - 1).rev() {
            let above = values[k + 1];
            values[k] = values[k] + above * shift;
        }
    }
    values.into_iter().map(DoubleDouble::value).collect()
}

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
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone)]
pub struct StraightLine {
    polynomial: Polynomial,
}

impl StraightLine {
    /// Fits a straight line to `y` at the abscissae `x`. [`LinearRegression`] on x alone fits one without intercept,
    /// and [`YorkLine`](crate::YorkLine) one with uncertainties in both variables.
    ///
    /// # Errors
    /// Those of [`Polynomial::fit`].
    pub fn fit(x: &[f64], y: &[f64], weighting: Weighting<'_>) -> Result<Self, FitError> {
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

    /// Standard uncertainty of the slope; `None` if no degree of freedom is left to estimate the scatter.
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

    #[test]
    fn shift_of_a_cube() {
        // ((x − 3)/2)³ = x³/8 − 9x²/8 + 27x/8 − 27/8
        let cube = [0.0, 0.0, 0.0, 1.0].map(DoubleDouble::from);
        assert_eq!(expand(&cube, 3.0, 2.0), [-3.375, 3.375, -1.125, 0.125]);
    }

    #[test]
    fn both_frames_predict_alike() {
        let x: Vec<f64> = (0..20).map(|i| 5.0 + 0.3 * f64::from(i)).collect();
        let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
        let cubic = Polynomial::fit(&x, &y, 3, Weighting::Equal).unwrap();
        let at = 7.3f64;
        let row: Vec<f64> = (0..4).map(|k| at.powi(k)).collect();
        let (local, global) = (cubic.predict(at).unwrap(), cubic.regression().predict(&row).unwrap());
        // Powers of x are alike to about four digits.
        assert!((local.value() - global.value()).abs() < 1e-11);
        assert!((local.standard_uncertainty() / global.standard_uncertainty() - 1.0).abs() < 1e-9);
        assert_eq!(local.value(), cubic.predict(at).unwrap().value());
        assert!((cubic.value(at) - local.value()).abs() < 1e-14);
    }

    #[test]
    fn equal_abscissae_are_too_few() {
        let error = Polynomial::fit(&[2.0; 4], &[1.0, 2.0, 3.0, 4.0], 1, Weighting::Equal).unwrap_err();
        assert!(error.to_string().contains("1 different values of x"), "{error}");
        let mean = Polynomial::fit(&[2.0; 4], &[1.0, 2.0, 3.0, 4.0], 0, Weighting::Equal).unwrap();
        assert_eq!(mean.coefficients(), [2.5]);
    }

    #[test]
    fn extreme_abscissae_are_fitted_or_refused() {
        let y = [1.0, 2.0, 3.0, 5.0];
        for unit in [1e-150, 1e-20, 1.0, 1e20, 1e150] {
            let x = [1.0, 2.0, 3.0, 4.0].map(|x| x * unit);
            let line = Polynomial::fit(&x, &y, 1, Weighting::Equal).unwrap();
            let slope = line.coefficients()[1] * unit;
            assert!((slope - 1.3).abs() < 1e-14, "slope {slope} per {unit:e}");
        }
        let x = [-1e308, 0.0, 1e308, 1.5e308];
        let found = Polynomial::fit(&x, &y, 3, Weighting::Equal);
        assert!(matches!(found, Err(FitError::Problem { .. })), "{found:?}");
        assert!(Polynomial::fit(&x, &y, usize::MAX, Weighting::Equal).is_err());
        let narrow = [1.0, 1.0 + 1e-15, 1.0 + 2e-15, 1.0 + 3e-15];
        assert!(Polynomial::fit(&narrow, &y, 1, Weighting::Equal).is_ok());
    }

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
