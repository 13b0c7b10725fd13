//! The straight line through points that are uncertain in both directions.

use std::fmt;

use fmm_model::Rounded;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::error::FitError;
use crate::problem::weighted::bad_uncertainty;
use crate::regression::weighting::{check_finite, too_few_observations};

/// A point with standard uncertainties in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UncertainPoint {
    x: f64,
    y: f64,
    u_x: f64,
    u_y: f64,
    correlation: f64,
}

impl UncertainPoint {
    /// A point at `x`, `y` with standard uncertainties `u_x` and `u_y` of independent errors. One of them may be zero.
    pub const fn new(x: f64, y: f64, u_x: f64, u_y: f64) -> Self {
        Self { x, y, u_x, u_y, correlation: 0.0 }
    }

    /// The same point with the correlation coefficient of its two errors, between −1 and 1.
    #[must_use]
    pub const fn with_correlation(mut self, correlation: f64) -> Self {
        self.correlation = correlation;
        self
    }

    /// The same point with an independent error of this `variance` more in y.
    pub(crate) fn widened(self, variance: f64) -> Self {
        let u_y = (self.u_y * self.u_y + variance).sqrt();
        let correlation = if u_y > 0.0 { self.correlation * (self.u_y / u_y) } else { 0.0 };
        Self { u_y, correlation, ..self }
    }

    /// Variance of y − b x, the inverse of the weight W.
    fn variance(&self, slope: f64) -> f64 {
        let Self { u_x, u_y, correlation: r, .. } = *self;
        // (b uₓ − r u_y)² + (1 − r²) u_y² does not cancel.
        (slope * u_x - r * u_y).powi(2) + (1.0 - r * r) * u_y * u_y
    }
}

/// The straight line that is the most probable for points with normal errors in both directions.
///
/// ```text
/// y = a + b x,     b = Σ Wᵢ βᵢ Vᵢ/Σ Wᵢ βᵢ Uᵢ,     a = Ȳ − b X̄                                (13b, 13a)
/// Wᵢ = 1/(b² u²(Xᵢ) + u²(Yᵢ) − 2 b rᵢ u(Xᵢ) u(Yᵢ)),   X̄ = Σ Wᵢ Xᵢ/Σ Wᵢ,   Uᵢ = Xᵢ − X̄,   Vᵢ = Yᵢ − Ȳ
/// βᵢ = Wᵢ (Uᵢ u²(Yᵢ) + b Vᵢ u²(Xᵢ) − (b Uᵢ + Vᵢ) rᵢ u(Xᵢ) u(Yᵢ)),   xᵢ = X̄ + βᵢ
/// u²(b) = 1/Σ Wᵢ (xᵢ − x̄)²,     u²(a) = 1/Σ Wᵢ + x̄² u²(b)                                   (13d, 13c)
/// ```
///
/// The numbers are those of the paper, written with variances instead of weights, so that an uncertainty may be zero.
/// The slope is iterated from that of y on x and from that of x on y, and the line with the smaller S is kept.
///
/// ```
/// use fmm_fit::{UncertainPoint, YorkLine};
///
/// // Without uncertainty in x this is the weighted regression of y on x.
/// let points = [(1.0, 2.1), (2.0, 3.9), (3.0, 6.2), (4.0, 7.8)].map(|(x, y)| UncertainPoint::new(x, y, 0.0, 0.1));
/// let line = YorkLine::fit(&points)?;
/// assert!((line.slope() - 1.94).abs() < 1e-13);
/// assert!((line.slope_uncertainty() - 0.1 / 5f64.sqrt()).abs() < 1e-13);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// # References
/// D. York, N. M. Evensen, M. López Martínez, J. De Basabe Delgado, "Unified equations for the slope, intercept, and
/// standard errors of the best straight line", Am. J. Phys. 72 (2004) 367, <https://doi.org/10.1119/1.1632486>.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YorkLine {
    slope: f64,
    intercept: f64,
    slope_uncertainty: f64,
    intercept_uncertainty: f64,
    covariance: f64,
    sum_of_squares: f64,
    count: usize,
    iterations: usize,
    is_converged: bool,
}

/// Iterations allowed; each usually wins a digit.
const ITERATIONS: usize = 500;

/// Change of the slope, relative to the slope or to its uncertainty, that ends the iteration.
const TOLERANCE: f64 = 8.0 * f64::EPSILON;

impl YorkLine {
    /// Fits the line to at least two points.
    ///
    /// # Errors
    /// [`FitError`] if a number is not finite, an uncertainty negative, a correlation not between −1 and 1, both
    /// uncertainties of a point zero, if there are fewer than two points, or if no slope describes them.
    pub fn fit(points: &[UncertainPoint]) -> Result<Self, FitError> {
        check(points)?;
        let of = |f: fn(&UncertainPoint) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
        let (mean_x, mean_y) = (of(|point| point.x), of(|point| point.y));
        let moment = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
            points.iter().map(|point| f(point.x - mean_x, point.y - mean_y)).sum()
        };
        let (xx, xy, yy) = (moment(&|x, _| x * x), moment(&|x, y| x * y), moment(&|_, y| y * y));
        let lines = [xy / xx, yy / xy].map(|start| iterate(points, start));
        let [first, second] = lines;
        match (first, second) {
            (Ok(first), Ok(second)) => {
                let is_better = (second.is_converged, -second.sum_of_squares * (1.0 + 1e-9))
                    > (first.is_converged, -first.sum_of_squares);
                Ok(if is_better { second } else { first })
            }
            (Ok(line), Err(_)) | (Err(_), Ok(line)) => Ok(line),
            (Err(error), Err(_)) => Err(error),
        }
    }

    /// b, change of y with x.
    pub fn slope(&self) -> f64 {
        self.slope
    }

    /// a, value of y at x = 0.
    pub fn intercept(&self) -> f64 {
        self.intercept
    }

    /// u(b), from the uncertainties of the points alone.
    pub fn slope_uncertainty(&self) -> f64 {
        self.slope_uncertainty
    }

    /// u(a), from the uncertainties of the points alone.
    pub fn intercept_uncertainty(&self) -> f64 {
        self.intercept_uncertainty
    }

    /// Covariance of slope and intercept, −x̄ u²(b).
    pub fn covariance(&self) -> f64 {
        self.covariance
    }

    /// S = Σᵢ Wᵢ (Yᵢ − a − b Xᵢ)².
    pub fn sum_of_squares(&self) -> f64 {
        self.sum_of_squares
    }

    /// n − 2.
    pub fn degrees_of_freedom(&self) -> usize {
        self.count - 2
    }

    /// √(S/(n − 2)), about 1 if line and uncertainties are right. If the uncertainties are known only up to a factor,
    /// this is the factor, and multiplies u(a) and u(b). `None` for two points.
    pub fn scale(&self) -> Option<f64> {
        let freedom = self.degrees_of_freedom();
        (freedom > 0).then(|| (self.sum_of_squares / freedom as f64).sqrt())
    }

    /// Probability of an S at least as large if line and uncertainties are right; `None` for two points.
    pub fn p_value(&self) -> Option<f64> {
        let freedom = self.degrees_of_freedom();
        if freedom == 0 { None } else { Some(ChiSquared::new(freedom as f64).ok()?.sf(self.sum_of_squares)) }
    }

    /// The value of the line at `x`.
    pub fn value(&self, x: f64) -> f64 {
        self.intercept + self.slope * x
    }

    /// Standard uncertainty of the value of the line at an exactly known `x`.
    pub fn standard_uncertainty(&self, x: f64) -> f64 {
        let variance = self.intercept_uncertainty.powi(2) + 2.0 * x * self.covariance;
        (variance + (x * self.slope_uncertainty).powi(2)).max(0.0).sqrt()
    }

    /// True if the slope no longer changed when the iteration ended. Otherwise the points hardly lie along a line.
    pub fn is_converged(&self) -> bool {
        self.is_converged
    }
}

impl fmt::Display for YorkLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[[line]] {} points uncertain in both variables", self.count)?;
        writeln!(f, "  slope     = {}", Rounded::new(self.slope, Some(self.slope_uncertainty)))?;
        writeln!(f, "  intercept = {}", Rounded::new(self.intercept, Some(self.intercept_uncertainty)))?;
        write!(f, "  weighted sum of squares {:.4}", self.sum_of_squares)?;
        if let (Some(scale), Some(p)) = (self.scale(), self.p_value()) {
            write!(f, ", scatter {scale:.3} times what the uncertainties say (p = {p:.3})")?;
        }
        writeln!(f)?;
        if !self.is_converged {
            writeln!(f, "  not converged after {} iterations: the points hardly lie along a line", self.iterations)?;
        }
        Ok(())
    }
}

fn check(points: &[UncertainPoint]) -> Result<(), FitError> {
    let count = points.len();
    check_finite("x", &points.iter().map(|point| point.x).collect::<Vec<f64>>(), count)?;
    check_finite("y", &points.iter().map(|point| point.y).collect::<Vec<f64>>(), count)?;
    for (index, point) in points.iter().enumerate() {
        if let Some(value) = [point.u_x, point.u_y].into_iter().find(|u| !(*u >= 0.0 && u.is_finite())) {
            return Err(bad_uncertainty("observation", index, value));
        }
        if !(point.correlation.abs() < 1.0) {
            let name = format!("the correlation of the errors of point {index}");
            let expected = "between -1 and 1, both excluded,";
            let what = format!("{name} must lie {expected} but is {}", Rounded::every_digit(point.correlation));
            return Err(FitError::out_of_range(what, point.correlation));
        }
        if point.u_x == 0.0 && point.u_y == 0.0 {
            return Err(no_uncertainty(index));
        }
    }
    if count < 2 {
        return Err(too_few_observations(count, 2));
    }
    Ok(())
}

fn no_uncertainty(index: usize) -> FitError {
    let what =
        format!("point {index} has no uncertainty that counts at this slope; give it an uncertainty in x and in y");
    FitError::out_of_range(what, 0.0)
}

fn no_slope() -> FitError {
    FitError::no_minimum(
        "no slope minimises the sum of squares: the points show a vertical line or none; exchange x and y",
    )
}

/// Sums that belong to one slope.
struct State {
    next: f64,
    mean_x: f64,
    mean_y: f64,
    weight: f64,
    /// x̄ and Σ W (x − x̄)² of the adjusted abscissae.
    adjusted: f64,
    spread: f64,
}

fn iterate(points: &[UncertainPoint], start: f64) -> Result<YorkLine, FitError> {
    if !start.is_finite() {
        return Err(no_slope());
    }
    let mut slope = start;
    let mut iterations = 0;
    let mut is_converged = false;
    let mut state = State::at(points, slope)?;
    while !is_converged && iterations < ITERATIONS {
        iterations += 1;
        let change = (state.next - slope).abs();
        slope = state.next;
        state = State::at(points, slope)?;
        is_converged = change <= TOLERANCE * slope.abs().max(1.0 / state.spread.sqrt());
    }
    let slope_variance = 1.0 / state.spread;
    let intercept = state.mean_y - slope * state.mean_x;
    let square = |point: &UncertainPoint| {
        let distance = (point.y - state.mean_y) - slope * (point.x - state.mean_x);
        distance * distance / point.variance(slope)
    };
    Ok(YorkLine {
        slope,
        intercept,
        slope_uncertainty: slope_variance.sqrt(),
        intercept_uncertainty: (1.0 / state.weight + state.adjusted.powi(2) * slope_variance).sqrt(),
        covariance: -state.adjusted * slope_variance,
        sum_of_squares: points.iter().map(square).sum(),
        count: points.len(),
        iterations,
        is_converged,
    })
}

impl State {
    fn at(points: &[UncertainPoint], slope: f64) -> Result<Self, FitError> {
        let weights: Vec<f64> = points.iter().map(|point| 1.0 / point.variance(slope)).collect();
        if let Some(index) = weights.iter().position(|weight| *weight == f64::INFINITY) {
            return Err(no_uncertainty(index));
        }
        let weight: f64 = weights.iter().sum();
        let mean = |f: &dyn Fn(usize) -> f64| -> f64 {
            weights.iter().enumerate().map(|(i, weight)| weight * f(i)).sum::<f64>() / weight
        };
        let (mean_x, mean_y) = (mean(&|i| points[i].x), mean(&|i| points[i].y));
        let beta = |i: usize| {
            let UncertainPoint { x, y, u_x, u_y, correlation } = points[i];
            let (u, v) = (x - mean_x, y - mean_y);
            weights[i] * (u * u_y * u_y + slope * v * u_x * u_x - (slope * u + v) * correlation * u_x * u_y)
        };
        let over = mean(&|i| beta(i) * (points[i].y - mean_y));
        let under = mean(&|i| beta(i) * (points[i].x - mean_x));
        let adjusted = mean(&beta);
        let spread = weight * mean(&|i| (beta(i) - adjusted).powi(2));
        let next = over / under;
        if next.is_finite() && weight.is_finite() && spread > 0.0 {
            Ok(Self { next, mean_x, mean_y, weight, adjusted: mean_x + adjusted, spread })
        } else {
            Err(no_slope())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pearson's points with York's weights 1/u².
    fn pearson() -> Vec<UncertainPoint> {
        let x = [0.0, 0.9, 1.8, 2.6, 3.3, 4.4, 5.2, 6.1, 6.5, 7.4];
        let y = [5.9, 5.4, 4.4, 4.6, 3.5, 3.7, 2.8, 2.8, 2.4, 1.5];
        let w_x = [1000.0, 1000.0, 500.0, 800.0, 200.0, 80.0, 60.0, 20.0, 1.8, 1.0];
        let w_y = [1.0, 1.8, 4.0, 8.0, 20.0, 20.0, 70.0, 70.0, 100.0, 500.0];
        let point = |i: usize| UncertainPoint::new(x[i], y[i], 1.0 / f64::sqrt(w_x[i]), 1.0 / f64::sqrt(w_y[i]));
        (0..10).map(point).collect()
    }

    fn assert_close(value: f64, expected: f64, tolerance: f64, what: &str) {
        assert!((value / expected - 1.0).abs() < tolerance, "{what} = {value} instead of {expected}");
    }

    #[test]
    fn pearsons_data_with_yorks_weights() {
        let line = YorkLine::fit(&pearson()).unwrap();
        assert!(line.is_converged(), "after {} iterations", line.iterations);
        // Slope and intercept as published for these data; S/(n − 2) and the uncertainties as the R package bfsl and
        // LinearFitXYerrors.jl, which implement the same equations, test them.
        assert_close(line.slope(), -0.480_533_407, 2e-9, "slope");
        assert_close(line.intercept(), 5.479_910_22, 2e-9, "intercept");
        assert_close(line.scale().unwrap().powi(2), 1.483_294_149, 1e-9, "S/(n − 2)");
        assert_close(line.slope_uncertainty(), 0.057_985_009_0, 1e-8, "u(b)");
        assert_close(line.intercept_uncertainty(), 0.294_970_735, 2e-9, "u(a)");
        let scale = line.scale().unwrap();
        assert_close(scale * line.slope_uncertainty(), 0.070_620_269_528_771, 1e-12, "scaled u(b)");
        assert_close(scale * line.intercept_uncertainty(), 0.359_246_522_551_112, 1e-12, "scaled u(a)");
        // 1 − χ²₈(11.866): scipy.stats.chi2.sf(8·1.4832941492576808, 8).
        assert_close(line.p_value().unwrap(), 0.157_267_228_691_258_45, 1e-9, "p");
    }

    #[test]
    fn correlated_errors() {
        // S. Amen, thesis (2012), Table 3.1, as tested by LinearFitXYerrors.jl: x, y, variances and covariance.
        let data = [
            [23.371, 5.992, 0.106, 0.323, 0.170],
            [24.462, 8.899, 1.692, 10.195, 3.887],
            [22.414, 5.361, 0.124, 0.460, 0.207],
            [27.628, 10.271, 1.088, 1.460, 1.255],
            [23.802, 7.114, 0.107, 0.496, 0.191],
            [23.092, 7.975, 0.281, 1.651, 0.582],
            [23.263, 7.486, 0.316, 1.695, 0.661],
            [20.843, 4.169, 0.389, 0.335, 0.357],
            [24.421, 5.645, 0.381, 0.716, 0.507],
            [23.716, 9.220, 0.733, 3.656, 1.401],
            [22.032, 5.358, 0.094, 0.268, 0.106],
            [21.448, 3.166, 0.167, 0.170, 0.001],
            [21.631, 4.002, 0.127, 0.106, 0.082],
            [19.947, 2.073, 0.015, 0.015, 0.001],
            [20.652, 3.338, 0.040, 0.104, 0.021],
            [20.588, 2.028, 0.007, 0.011, 0.002],
            [20.745, 1.978, 0.010, 0.010, -0.001],
            [21.658, 2.526, 0.009, 0.058, -0.003],
            [19.539, 2.043, 0.044, 0.070, -0.039],
            [21.638, 3.361, 1.909, 3.961, -2.557],
            [19.863, 2.452, 0.014, 0.019, -0.010],
            [18.398, 2.199, 0.042, 0.051, -0.037],
            [20.729, 1.725, 0.013, 0.026, 0.003],
            [20.511, 1.906, 0.003, 0.010, 0.001],
            [22.140, 3.372, 0.047, 0.108, 0.062],
            [20.510, 2.130, 0.004, 0.020, 0.002],
            [20.141, 1.897, 0.006, 0.011, -0.005],
        ];
        let points = data.map(|[x, y, xx, yy, xy]| {
            UncertainPoint::new(x, y, f64::sqrt(xx), f64::sqrt(yy)).with_correlation(xy / f64::sqrt(xx * yy))
        });
        let line = YorkLine::fit(&points).unwrap();
        let scale = line.scale().unwrap();
        // Six digits: that implementation ends its iteration early.
        assert_close(line.intercept(), -21.955_330_904_550_8, 1e-6, "intercept");
        assert_close(line.slope(), 1.176_228_880_668_2, 1e-6, "slope");
        assert_close(scale, 3.488_553_930_864_3, 1e-6, "√(S/(n − 2))");
        assert_close(scale * line.slope_uncertainty(), 0.057_826_039_440_8, 1e-6, "scaled u(b)");
        assert_close(scale * line.intercept_uncertainty(), 1.284_610_171_108, 1e-6, "scaled u(a)");
    }

    #[test]
    fn a_common_factor_of_the_uncertainties_and_units_scale_as_they_should() {
        let line = YorkLine::fit(&pearson()).unwrap();
        let other =
            pearson().into_iter().map(|p| UncertainPoint::new(1e3 * p.x, 1e-3 * p.y, 3e3 * p.u_x, 3e-3 * p.u_y));
        let other = YorkLine::fit(&other.collect::<Vec<_>>()).unwrap();
        assert_close(other.slope(), 1e-6 * line.slope(), 1e-13, "slope");
        assert_close(other.intercept(), 1e-3 * line.intercept(), 1e-13, "intercept");
        assert_close(other.slope_uncertainty(), 3e-6 * line.slope_uncertainty(), 1e-13, "u(b)");
        assert_close(other.sum_of_squares(), line.sum_of_squares() / 9.0, 1e-13, "S");
    }

    #[test]
    fn exchanging_the_axes_inverts_the_slope() {
        let line = YorkLine::fit(&pearson()).unwrap();
        let turned = pearson().into_iter().map(|p| UncertainPoint::new(p.y, p.x, p.u_y, p.u_x)).collect::<Vec<_>>();
        let turned = YorkLine::fit(&turned).unwrap();
        assert_close(turned.slope(), 1.0 / line.slope(), 1e-13, "slope");
        assert_close(turned.intercept(), -line.intercept() / line.slope(), 1e-13, "intercept");
        // The uncertainty of −a/b by propagation is that of the intercept of the turned line.
        let at_zero = line.standard_uncertainty(turned.intercept()) / line.slope().abs();
        assert_close(turned.intercept_uncertainty(), at_zero, 1e-12, "u(x at y = 0)");
    }

    #[test]
    fn bad_points_are_named() {
        let text = |points: &[UncertainPoint]| YorkLine::fit(points).unwrap_err().to_string();
        let good = UncertainPoint::new(0.0, 1.0, 0.1, 0.1);
        assert!(text(&[good]).contains("1 observations"));
        assert!(text(&[good, UncertainPoint::new(1.0, f64::NAN, 0.1, 0.1)]).contains("value 1 of y"));
        assert!(text(&[good, UncertainPoint::new(1.0, 2.0, -0.1, 0.1)]).contains("but is -0.1"));
        assert!(text(&[good, UncertainPoint::new(1.0, 2.0, 0.0, 0.0)]).contains("point 1"));
        assert!(text(&[good, good.with_correlation(1.0)]).contains("point 1"));
        let vertical = [good, UncertainPoint::new(0.0, 2.0, 0.1, 0.1), UncertainPoint::new(0.0, 3.0, 0.1, 0.1)];
        assert!(text(&vertical).contains("vertical"), "{}", text(&vertical));
    }
}
