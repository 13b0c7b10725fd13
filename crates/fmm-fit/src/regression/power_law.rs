//! Regression on a power law with an offset.

use std::fmt;

use fmm_model::{Bounds, Parameter, Rounded};

use crate::error::FitError;
use crate::fitting::solve::solve;
use crate::problem::residuals::{Derivatives, EvaluationError, Residuals};
use crate::regression::linear_regression::LinearRegression;
use crate::regression::polynomial::count_distinct;
use crate::regression::weighting::{Weighting, check_finite, overflow, too_few_abscissae};
use crate::result::fit::Fit;
use crate::result::prediction::Prediction;
use crate::solver::options::Options;

/// A power law with an offset through observations.
///
/// ```text
/// ŷ = a xᵇ + c                                                                  (thesis, Eq. 7.2)
/// ```
///
/// | parameter | name | |
/// |---|---|---|
/// | a | `coefficient` | in the unit of y over that of xᵇ |
/// | b | `exponent` | |
/// | c | `offset` | in the unit of y |
///
/// The three are seldom well determined together: where xᵇ is nearly a straight line in ln x over the range of the
/// data, a larger offset goes with a smaller coefficient and a larger exponent. The curve is known much better than its
/// coefficients; look at [`predict`](Self::predict), and at the fit [without offset](Self::fit_without_offset).
///
/// ```
/// use fmm_fit::{PowerLaw, Weighting};
///
/// let x: Vec<f64> = (1..20).map(f64::from).collect();
/// let y: Vec<f64> = x.iter().map(|x| 2.0 * x.powf(-0.5) + 1.0).collect();
/// let law = PowerLaw::fit(&x, &y, Weighting::Equal)?;
/// assert!((law.exponent() + 0.5).abs() < 1e-9);
/// assert!((law.offset() - 1.0).abs() < 1e-9);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone)]
pub struct PowerLaw {
    fit: Fit,
    total: Option<f64>,
    is_absolute: bool,
}

/// Magnitudes of the exponents that starts are looked for at.
const EXPONENTS: [f64; 10] = [0.03, 0.06, 0.12, 0.25, 0.5, 1.0, 1.5, 2.0, 4.0, 8.0];

/// From how many of the best of them the solver starts.
const STARTS: usize = 3;

impl PowerLaw {
    /// Fits coefficient, exponent and offset to `y` at the abscissae `x`, which must not be negative.
    ///
    /// # Errors
    /// [`FitError`] if lengths differ, a value is not finite, an abscissa negative, an uncertainty not positive,
    /// or if there are not as many different abscissae as free parameters.
    pub fn fit(x: &[f64], y: &[f64], weighting: Weighting<'_>) -> Result<Self, FitError> {
        Self::fit_within(x, y, weighting, [Bounds::UNBOUNDED; 3])
    }

    /// As [`fit`](Self::fit) with an offset of zero.
    ///
    /// # Errors
    /// As for [`fit`](Self::fit).
    pub fn fit_without_offset(x: &[f64], y: &[f64], weighting: Weighting<'_>) -> Result<Self, FitError> {
        let zero = Bounds::NOT_NEGATIVE.at_most(0.0);
        Self::fit_within(x, y, weighting, [Bounds::UNBOUNDED, Bounds::UNBOUNDED, zero])
    }

    /// As [`fit`](Self::fit) with coefficient, exponent and offset within `bounds`; equal bounds hold one fixed. If an
    /// abscissa is zero the exponent is positive in any case.
    ///
    /// # Errors
    /// As for [`fit`](Self::fit).
    pub fn fit_within(x: &[f64], y: &[f64], weighting: Weighting<'_>, bounds: [Bounds; 3]) -> Result<Self, FitError> {
        check_finite("y", y, y.len())?;
        check_finite("x", x, y.len())?;
        if let Some(index) = x.iter().position(|x| *x < 0.0) {
            let value = Rounded::every_digit(x[index]);
            let what = format!("value {index} of x is {value}, but a power law needs values that are not negative");
            return Err(FitError::out_of_range(what, x[index]));
        }
        let [coefficient, exponent, offset] = bounds;
        let exponent = if x.contains(&0.0) { exponent.at_least(f64::MIN_POSITIVE) } else { exponent };
        let bounds = [coefficient, exponent, offset];
        let free = bounds.iter().filter(|bounds| !bounds.is_fixed()).count();
        let distinct = count_distinct(x, false);
        if distinct < free {
            return Err(too_few_abscissae(distinct, free));
        }
        let problem = Problem {
            x,
            y,
            factors: weighting.factors(y.len())?,
            parameters: [
                Parameter::new("coefficient", "a", "1").bounded(coefficient),
                Parameter::new("exponent", "b", "1").bounded(exponent),
                Parameter::new("offset", "c", "1").bounded(offset),
            ],
        };
        let mut best: Option<Fit> = None;
        let mut refusal = overflow();
        for start in starts(x, y, weighting, &bounds)? {
            match solve(&problem, &start, &Options::default()) {
                Ok(fit) => {
                    let is_better = |best: &Fit| {
                        (fit.outcome().is_success(), -fit.sum_of_squares())
                            > (best.outcome().is_success(), -best.sum_of_squares())
                    };
                    if best.as_ref().is_none_or(is_better) {
                        best = Some(fit);
                    }
                }
                Err(error) => refusal = error,
            }
        }
        // The scatter that a constant, or without offset nothing, leaves.
        let ones = vec![if offset.is_fixed() { 0.0 } else { 1.0 }; y.len()];
        let total = LinearRegression::fit(&[("constant", &ones)], y, weighting)?.sum_of_squares();
        let fit = best.ok_or(refusal)?;
        Ok(Self { fit, total: (total > 0.0).then_some(total), is_absolute: weighting.is_absolute() })
    }

    /// a, in the unit of y over that of xᵇ.
    pub fn coefficient(&self) -> f64 {
        self.fit.values()[0]
    }

    /// b.
    pub fn exponent(&self) -> f64 {
        self.fit.values()[1]
    }

    /// c, in the unit of y.
    pub fn offset(&self) -> f64 {
        self.fit.values()[2]
    }

    /// The fit: residuals, model minus data over the standard uncertainty if there is one, and what they could not
    /// tell. Its own uncertainties are those for equal or relative weights.
    pub fn as_fit(&self) -> &Fit {
        &self.fit
    }

    /// Standard uncertainty of coefficient, exponent or offset, for `j` of 0, 1 or 2, by the formula of the
    /// [`Weighting`]; `None` if it is fixed, at a bound or not determined.
    pub fn standard_uncertainty(&self, j: usize) -> Option<f64> {
        Some(self.unit_deviation()? * self.fit.unit_covariance(j, j)?.sqrt())
    }

    /// Share of the scatter of the observations that the law explains, about their mean or, without offset, about zero;
    /// `None` if there is no scatter.
    pub fn r_squared(&self) -> Option<f64> {
        self.total.map(|total| 1.0 - self.fit.sum_of_squares() / total)
    }

    /// The value of the law at `x`.
    pub fn value(&self, x: f64) -> f64 {
        self.coefficient() * x.powf(self.exponent()) + self.offset()
    }

    /// The prediction at `x`, not negative; `None` if the law has no value there, a parameter is not determined, or
    /// without a degree of freedom to tell s.
    pub fn predict(&self, x: f64) -> Option<Prediction> {
        let gradient = gradient(x, self.fit.values());
        let deviation = self.unit_deviation()?;
        let variance = deviation * deviation * self.fit.unit_variance(&gradient)?;
        let freedom = if self.is_absolute { f64::INFINITY } else { self.fit.degrees_of_freedom() as f64 };
        Prediction::new(self.value(x), variance, deviation, self.fit.rank(), freedom)
    }

    fn unit_deviation(&self) -> Option<f64> {
        if self.is_absolute { Some(1.0) } else { self.fit.residual_standard_deviation() }
    }
}

impl fmt::Display for PowerLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.fit.fmt(f)
    }
}

/// ∂ŷ/∂(a, b, c).
fn gradient(x: f64, p: &[f64]) -> [f64; 3] {
    let power = x.powf(p[1]);
    // x ln x vanishes with x.
    let logarithm = if x > 0.0 { x.ln() } else { 0.0 };
    [power, p[0] * power * logarithm, 1.0]
}

struct Problem<'a> {
    x: &'a [f64],
    y: &'a [f64],
    factors: Option<Vec<f64>>,
    parameters: [Parameter; 3],
}

impl Problem<'_> {
    fn factor(&self, i: usize) -> f64 {
        self.factors.as_ref().map_or(1.0, |factors| factors[i])
    }
}

impl Residuals for Problem<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn len(&self) -> usize {
        self.y.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (i, ((r, x), y)) in residuals.iter_mut().zip(self.x).zip(self.y).enumerate() {
            *r = (p[0] * x.powf(p[1]) + p[2] - y) * self.factor(i);
        }
        if let Some(jacobian) = jacobian {
            let count = self.len();
            for (i, x) in self.x.iter().enumerate() {
                for (j, derivative) in gradient(*x, p).into_iter().enumerate() {
                    jacobian[j * count + i] = derivative * self.factor(i);
                }
            }
        }
        Ok(())
    }

    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

/// The best starts: for each of some exponents the coefficient and the offset that a linear regression gives.
fn starts(x: &[f64], y: &[f64], weighting: Weighting<'_>, bounds: &[Bounds; 3]) -> Result<Vec<[f64; 3]>, FitError> {
    let negative = EXPONENTS.iter().rev().map(|b| -b);
    let mut exponents: Vec<f64> = negative.chain(EXPONENTS).map(|exponent| bounds[1].clamp(exponent)).collect();
    exponents.dedup();
    let ones = vec![1.0; x.len()];
    let mut found: Vec<(f64, [f64; 3])> = Vec::new();
    for exponent in exponents {
        let power: Vec<f64> = x.iter().map(|x| x.powf(exponent)).collect();
        if !power.iter().all(|power| power.is_finite()) {
            continue;
        }
        let regression = if bounds[2].is_fixed() {
            let rest: Vec<f64> = y.iter().map(|y| y - bounds[2].lower()).collect();
            LinearRegression::fit(&[("a", &power)], &rest, weighting)?
        } else {
            LinearRegression::fit(&[("a", &power), ("c", &ones)], y, weighting)?
        };
        let offset = regression.coefficients().get(1).copied().unwrap_or_else(|| bounds[2].lower());
        let start = [bounds[0].clamp(regression.coefficients()[0]), exponent, bounds[2].clamp(offset)];
        found.push((regression.sum_of_squares(), start));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(STARTS);
    Ok(found.into_iter().map(|(_, start)| start).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::model_comparison::f_test;

    /// Thesis, Table 4: peak velocity (m/s) and coefficient of friction by the mean and by the linear damping (1).
    const VELOCITY: [f64; 15] =
        [0.086, 0.100, 0.114, 0.128, 0.141, 0.155, 0.168, 0.182, 0.196, 0.209, 0.223, 0.237, 0.251, 0.265, 0.280];
    const MEAN: [f64; 15] =
        [0.217, 0.224, 0.228, 0.231, 0.235, 0.239, 0.247, 0.248, 0.252, 0.254, 0.261, 0.265, 0.264, 0.265, 0.267];
    const LINEAR: [f64; 15] =
        [0.217, 0.225, 0.228, 0.232, 0.236, 0.244, 0.247, 0.248, 0.252, 0.254, 0.261, 0.265, 0.264, 0.265, 0.267];

    /// The thesis prints a = 0.311, b = 0.2116, c = 0.03148 without uncertainties. They lie on the ridge of the
    /// minimum: the sum of squares is 1 % above it, and each coefficient is uncertain by half of itself and more.
    #[test]
    fn equation_7_2_does_not_determine_its_coefficients() {
        let law = PowerLaw::fit(&VELOCITY, &MEAN, Weighting::Equal).unwrap();
        let found = law.as_fit();
        assert!(found.outcome().is_success());
        assert!((found.sum_of_squares() / 5.267_038_732e-5 - 1.0).abs() < 1e-9, "S = {:e}", found.sum_of_squares());
        let printed: f64 =
            VELOCITY.iter().zip(MEAN).map(|(v, mu)| (0.311 * v.powf(0.2116) + 0.03148 - mu).powi(2)).sum();
        assert!((printed - 5.315e-5).abs() < 5e-9, "S of the printed coefficients {printed:e}");
        // Minimum and uncertainties by Gauss-Newton steps of 40 digits in mpmath.
        let expected =
            [(0.294_158_441_7, 0.149_543_728), (0.234_871_506_2, 0.207_332_749_7), (0.051_280_372_67, 0.169_229_168_1)];
        for (j, (value, uncertainty)) in expected.into_iter().enumerate() {
            let u = law.standard_uncertainty(j).unwrap();
            assert!((found.values()[j] / value - 1.0).abs() < 1e-8, "parameter {j}: {}", found.values()[j]);
            assert!((u / uncertainty - 1.0).abs() < 1e-7, "u of parameter {j}: {u}");
            assert!(u > 0.5 * value, "parameter {j} is uncertain by {u}");
            // The printed value is well within.
            assert!(([0.311, 0.2116, 0.03148][j] - value).abs() < 0.2 * u);
        }
        assert!((law.r_squared().unwrap() - 0.986).abs() < 1e-3);
        // The curve itself is known to a relative 1 %.
        let middle = law.predict(0.18).unwrap();
        assert!(middle.standard_uncertainty() < 0.01 * middle.value());
    }

    #[test]
    fn the_offset_is_not_needed() {
        let with = PowerLaw::fit(&VELOCITY, &MEAN, Weighting::Equal).unwrap();
        let without = PowerLaw::fit_without_offset(&VELOCITY, &MEAN, Weighting::Equal).unwrap();
        assert!((without.coefficient() - 0.3408).abs() < 5e-5, "a = {}", without.coefficient());
        assert!((without.exponent() - 0.1853).abs() < 5e-5, "b = {}", without.exponent());
        assert!((without.as_fit().sum_of_squares() - 5.294e-5).abs() < 5e-9);
        assert!(without.standard_uncertainty(0).unwrap() < 0.03 * without.coefficient());
        // About zero nearly everything is explained.
        assert!(without.r_squared().unwrap() > 0.9999, "R² = {:?}", without.r_squared());
        assert_eq!((without.offset(), without.standard_uncertainty(2)), (0.0, None));
        let test = f_test(without.as_fit(), with.as_fit()).unwrap();
        assert!(test.p_value > 0.8, "p = {}", test.p_value);
    }

    #[test]
    fn the_other_damping_gives_quite_other_coefficients() {
        let law = PowerLaw::fit(&VELOCITY, &LINEAR, Weighting::Equal).unwrap();
        assert!((law.as_fit().sum_of_squares() / 4.667_515_03e-5 - 1.0).abs() < 1e-9);
        // By mpmath again; the coefficients themselves are uncertain by 1.22, 0.20 and 1.24.
        for (value, expected) in law.as_fit().values().iter().zip([0.612_843_139_5, 0.084_051_761_44, -0.281_766_301_1])
        {
            assert!((value / expected - 1.0).abs() < 1e-8, "{value} instead of {expected}");
        }
    }

    #[test]
    fn exact_data_are_found_from_every_side() {
        let x: Vec<f64> = (1..=12).map(|i| 0.3 * f64::from(i)).collect();
        for (a, b, c) in [(2.0, 0.5, 1.0), (-3.0, 1.7, 0.0), (0.4, -1.2, 5.0), (1e-3, 3.0, -2e4), (7.0, -0.2, -7.0)] {
            let y: Vec<f64> = x.iter().map(|x| a * x.powf(b) + c).collect();
            let law = PowerLaw::fit(&x, &y, Weighting::Equal).unwrap();
            // The offset of −2e4 leaves eight digits of a term of 1e-3 and less.
            let tolerance = if c < -1e4 { 1e-5 } else { 1e-8 };
            assert!((law.exponent() / b - 1.0).abs() < tolerance, "b = {} instead of {b}", law.exponent());
            assert!((law.coefficient() / a - 1.0).abs() < 10.0 * tolerance, "a = {} for {a}", law.coefficient());
        }
    }

    #[test]
    fn zero_is_an_abscissa_and_bounds_hold() {
        let x = [0.0, 1.0, 2.0, 3.0, 4.0];
        let y = x.map(|x: f64| 0.5 * x * x + 1.0);
        let law = PowerLaw::fit(&x, &y, Weighting::Equal).unwrap();
        assert!((law.exponent() - 2.0).abs() < 1e-9);
        assert!((law.predict(0.0).unwrap().value() - 1.0).abs() < 1e-9);
        let bounds = [Bounds::UNBOUNDED, Bounds::new(0.0, 1.5).unwrap(), Bounds::UNBOUNDED];
        let bounded = PowerLaw::fit_within(&x, &y, Weighting::Equal, bounds).unwrap();
        assert_eq!(bounded.exponent(), 1.5);
        let error = PowerLaw::fit(&[-1.0, 1.0, 2.0], &[1.0; 3], Weighting::Equal).unwrap_err();
        assert!(error.to_string().contains("value 0 of x is -1"), "{error}");
        let error = PowerLaw::fit(&[1.0, 1.0, 2.0], &[1.0; 3], Weighting::Equal).unwrap_err();
        assert!(error.to_string().contains("2 different"), "{error}");
    }

    #[test]
    fn known_uncertainties_are_taken_as_they_are() {
        let u = [0.002; 15];
        let absolute = PowerLaw::fit_without_offset(&VELOCITY, &MEAN, Weighting::Absolute(&u)).unwrap();
        let equal = PowerLaw::fit_without_offset(&VELOCITY, &MEAN, Weighting::Equal).unwrap();
        let s = equal.as_fit().residual_standard_deviation().unwrap();
        let ratio = absolute.standard_uncertainty(1).unwrap() / equal.standard_uncertainty(1).unwrap();
        assert!((ratio / (0.002 / s) - 1.0).abs() < 1e-8, "ratio {ratio}");
    }
}
