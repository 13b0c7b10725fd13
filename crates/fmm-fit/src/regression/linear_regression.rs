//! Regression on given columns.

use std::fmt;

use fmm_model::{Rounded, coverage_factor};

use crate::error::FitError;
use crate::regression::double_double::DoubleDouble;
use crate::regression::refined_least_squares::refined_least_squares;
use crate::regression::weighting::{Weighting, check_finite, no_column, overflow, too_few_observations};
use crate::result::null_direction::{NullDirection, null_directions};
use crate::result::prediction::Prediction;

/// Regression of observations on given columns.
///
/// ```text
/// minimise  S = Σᵢ rᵢ²,     rᵢ = (yᵢ − Σⱼ xᵢⱼ βⱼ)/uᵢ
/// ```
///
/// | symbol | method | meaning |
/// |---|---|---|
/// | β | [`coefficients`](Self::coefficients) | each in the unit of y over that of its column |
/// | r | [`residuals`](Self::residuals) | data minus model, over the standard uncertainty if there is one |
/// | ν | [`degrees_of_freedom`](Self::degrees_of_freedom) | n − rank |
/// | s | [`residual_standard_deviation`](Self::residual_standard_deviation) | √(S/ν) |
/// | R² | [`r_squared`](Self::r_squared) | share of the scatter of y that the columns explain |
///
/// The solution is refined with residuals in twice the precision, so that it is right for the columns as they are given
/// to about the last digit, whatever their condition. Columns that are not independent are reported by
/// [`null_directions`](Self::null_directions); the coefficients concerned have no uncertainty then.
///
/// ```
/// use fmm_fit::{LinearRegression, Weighting};
///
/// let (ones, x) = ([1.0; 4], [0.0, 1.0, 2.0, 3.0]);
/// let y = [1.1, 2.9, 5.2, 6.8];
/// let line = LinearRegression::fit(&[("intercept", &ones), ("slope", &x)], &y, Weighting::Equal)?;
/// assert!((line.coefficients()[1] - 1.94).abs() < 1e-14);
/// assert!((line.standard_uncertainty(1).unwrap() - 0.090_554).abs() < 1e-6);
/// assert!((line.r_squared().unwrap() - 0.995_661).abs() < 1e-6);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LinearRegression {
    pub(crate) names: Vec<String>,
    pub(crate) coefficients: Vec<f64>,
    /// Vectors w with (Xᵀ U⁻² X)⁺ = Σ w wᵀ.
    pub(crate) roots: Vec<Vec<f64>>,
    is_determined: Vec<bool>,
    null_directions: Vec<NullDirection>,
    singular_values: Vec<f64>,
    residuals: Vec<f64>,
    sum_of_squares: f64,
    total: f64,
    is_absolute: bool,
}

impl LinearRegression {
    /// Fits `y` by the `columns`, each with its name and one value per observation.
    ///
    /// # Errors
    /// [`FitError`] if lengths differ, a value is not finite, an uncertainty not positive, or if there are fewer
    /// observations than columns.
    pub fn fit(columns: &[(&str, &[f64])], y: &[f64], weighting: Weighting<'_>) -> Result<Self, FitError> {
        for (name, column) in columns {
            check_finite(name, column, y.len())?;
        }
        let is_constant = |column: &[f64]| column.first().is_some_and(|first| *first != 0.0 && all_equal(column));
        let has_constant = columns.iter().any(|(_, column)| is_constant(column));
        let names = columns.iter().map(|(name, _)| (*name).to_owned()).collect();
        let twofold =
            columns.iter().map(|(_, column)| column.iter().map(|x| DoubleDouble::from(*x)).collect()).collect();
        Self::of(names, twofold, y, weighting, has_constant).map(|(regression, _)| regression)
    }

    /// The regression, and its coefficients in twice the precision.
    pub(crate) fn of(
        names: Vec<String>,
        mut columns: Vec<Vec<DoubleDouble>>,
        y: &[f64],
        weighting: Weighting<'_>,
        has_constant: bool,
    ) -> Result<(Self, Vec<DoubleDouble>), FitError> {
        check_finite("y", y, y.len())?;
        let (order, count) = (columns.len(), y.len());
        if order == 0 {
            return Err(no_column());
        }
        let factors = weighting.factors(count)?;
        if count < order {
            return Err(too_few_observations(count, order));
        }
        let mut weighted: Vec<DoubleDouble> = y.iter().map(|y| DoubleDouble::from(*y)).collect();
        if let Some(factors) = &factors {
            for column in columns.iter_mut().chain(std::iter::once(&mut weighted)) {
                for (element, factor) in column.iter_mut().zip(factors) {
                    *element = *element * DoubleDouble::from(*factor);
                }
            }
        }
        let found = refined_least_squares(columns, &weighted).ok_or_else(overflow)?;
        let (spectrum, rank) = (&found.spectrum, found.rank);
        let noise = (count as f64 * f64::EPSILON).sqrt().max(1e-6);
        let null = &spectrum.right[rank..];
        let coefficients: Vec<f64> = found.solution.iter().map(|value| value.value()).collect();
        let all: Vec<usize> = (0..order).collect();
        let words: Vec<&str> = names.iter().map(String::as_str).collect();
        let is_determined = |j: usize| null.iter().map(|vector| vector[j] * vector[j]).sum::<f64>().sqrt() <= noise;
        let root = |(right, singular): (&Vec<f64>, &f64)| -> Vec<f64> {
            right.iter().zip(&spectrum.scales).map(|(v, scale)| v / singular / scale).collect()
        };
        let regression = Self {
            null_directions: null_directions(null, &all, &spectrum.scales, &coefficients, &words, noise),
            is_determined: all.iter().map(|&j| is_determined(j)).collect(),
            roots: spectrum.right.iter().zip(&spectrum.singular).take(rank).map(root).collect(),
            singular_values: spectrum.singular.clone(),
            sum_of_squares: found.residuals.iter().map(|r| r * r).sum(),
            total: total(y, factors.as_deref(), has_constant),
            residuals: found.residuals,
            is_absolute: weighting.is_absolute(),
            names,
            coefficients,
        };
        let is_finite = regression.sum_of_squares.is_finite() && regression.total.is_finite();
        if is_finite { Ok((regression, found.solution)) } else { Err(overflow()) }
    }

    /// βⱼ, one per column; of those that explain the data equally well the shortest, in columns of unit length.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Standard uncertainty of the coefficient of column `j`; `None` if it is not determined, or without a degree of
    /// freedom to tell s.
    pub fn standard_uncertainty(&self, j: usize) -> Option<f64> {
        self.covariance(j, j).map(f64::sqrt)
    }

    /// Covariance of the coefficients of columns `i` and `j`, by the formula of the [`Weighting`]; `None` if either is
    /// not determined, or without a degree of freedom to tell s.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        if !(*self.is_determined.get(i)? && *self.is_determined.get(j)?) {
            return None;
        }
        Some(self.unit_deviation()?.powi(2) * self.roots.iter().map(|root| root[i] * root[j]).sum::<f64>())
    }

    /// The interval that holds the coefficient of column `j` with probability `level`, by Student's t or, with absolute
    /// uncertainties, the normal distribution.
    pub fn interval_of(&self, j: usize, level: f64) -> Option<(f64, f64)> {
        let reach = coverage_factor(level, self.effective_freedom())? * self.standard_uncertainty(j)?;
        Some((self.coefficients[j] - reach, self.coefficients[j] + reach))
    }

    /// rᵢ, data minus model, divided by the standard uncertainty if there is one.
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// S = Σᵢ rᵢ².
    pub fn sum_of_squares(&self) -> f64 {
        self.sum_of_squares
    }

    /// ν = n − rank.
    pub fn degrees_of_freedom(&self) -> usize {
        self.residuals.len() - self.rank()
    }

    /// s = √(S/ν); `None` without a degree of freedom.
    pub fn residual_standard_deviation(&self) -> Option<f64> {
        let freedom = self.degrees_of_freedom();
        (freedom > 0).then(|| (self.sum_of_squares / freedom as f64).sqrt())
    }

    /// Share of the scatter of the observations that the columns explain; `None` if there is no scatter.
    ///
    /// ```text
    /// R² = 1 − S/Σᵢ ((yᵢ − ȳ)/uᵢ)²        with a constant among the columns, ȳ the weighted mean
    /// R² = 1 − S/Σᵢ (yᵢ/uᵢ)²              without
    /// ```
    ///
    /// The two cannot be compared with each other: scatter about zero is easily explained.
    pub fn r_squared(&self) -> Option<f64> {
        (self.total > 0.0).then(|| 1.0 - self.sum_of_squares / self.total)
    }

    /// Number of independent columns: singular values above n ε times the largest.
    pub fn rank(&self) -> usize {
        self.roots.len()
    }

    /// Singular values, descending, of the weighted columns scaled to unit length.
    pub fn singular_values(&self) -> &[f64] {
        &self.singular_values
    }

    /// Combinations of columns that are zero; empty if the columns are independent.
    pub fn null_directions(&self) -> &[NullDirection] {
        &self.null_directions
    }

    /// The prediction where the columns have the values `row`; `None` if the row has not one value per column, if it
    /// has a part that the data do not determine, or without a degree of freedom to tell s.
    pub fn predict(&self, row: &[f64]) -> Option<Prediction> {
        if row.len() != self.coefficients.len() {
            return None;
        }
        let is_lost = |(x, is_determined): (&f64, &bool)| *x != 0.0 && !is_determined;
        if row.iter().zip(&self.is_determined).any(is_lost) {
            return None;
        }
        self.predict_by(&self.coefficients, &self.roots, row)
    }

    /// The prediction for a row of columns with other coefficients and roots, such as those of another basis.
    pub(crate) fn predict_by(&self, coefficients: &[f64], roots: &[Vec<f64>], row: &[f64]) -> Option<Prediction> {
        let along = |vector: &[f64]| vector.iter().zip(row).map(|(v, x)| v * x).sum::<f64>();
        let unit = roots.iter().map(|root| along(root).powi(2)).sum::<f64>();
        let deviation = self.unit_deviation()?;
        let variance = deviation * deviation * unit;
        Prediction::new(along(coefficients), variance, deviation, self.rank(), self.effective_freedom())
    }

    /// 1 if the uncertainties of the observations are known, otherwise s.
    fn unit_deviation(&self) -> Option<f64> {
        if self.is_absolute { Some(1.0) } else { self.residual_standard_deviation() }
    }

    fn effective_freedom(&self) -> f64 {
        if self.is_absolute { f64::INFINITY } else { self.degrees_of_freedom() as f64 }
    }
}

fn all_equal(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[0] == pair[1])
}

/// Sum of squares of the weighted observations, about their weighted mean if a constant is among the columns.
fn total(y: &[f64], factors: Option<&[f64]>, has_constant: bool) -> f64 {
    let weight = |i: usize| factors.map_or(1.0, |factors| factors[i]);
    // Weights relative to the largest: their squares would overflow before those of the residuals do.
    let largest = (0..y.len()).map(weight).fold(0.0, f64::max);
    let share = |i: usize| (weight(i) / largest).powi(2);
    let mean = if has_constant {
        let sum: f64 = y.iter().enumerate().map(|(i, y)| share(i) * y).sum();
        sum / (0..y.len()).map(share).sum::<f64>()
    } else {
        0.0
    };
    y.iter().enumerate().map(|(i, y)| (weight(i) * (y - mean)).powi(2)).sum()
}

impl fmt::Display for LinearRegression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (count, freedom) = (self.residuals.len(), self.degrees_of_freedom());
        writeln!(f, "[[regression]] {count} observations, rank {}, {freedom} degrees of freedom", self.rank())?;
        write!(f, "  sum of squares {:.6e}", self.sum_of_squares)?;
        if let Some(deviation) = self.residual_standard_deviation() {
            write!(f, ", standard deviation of a residual {deviation:.6e}")?;
        }
        if let Some(r_squared) = self.r_squared() {
            write!(f, ", R² {r_squared:.6}")?;
        }
        writeln!(f)?;
        let width = self.names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        for (j, (name, value)) in self.names.iter().zip(&self.coefficients).enumerate() {
            write!(f, "  {name:<width$} = {}", Rounded::new(*value, self.standard_uncertainty(j)))?;
            writeln!(f, "{}", if self.is_determined[j] { "" } else { " (not determined)" })?;
        }
        for direction in &self.null_directions {
            writeln!(f, "  {direction}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 5.0];
    const Y: [f64; 5] = [2.2, 2.8, 3.6, 4.5, 5.1];

    #[test]
    fn weights_follow_the_closed_form() {
        let u = [0.1, 0.2, 0.1, 0.3, 0.2];
        let ones = [1.0; 5];
        let columns: [(&str, &[f64]); 2] = [("a", &ones), ("b", &X)];
        let absolute = LinearRegression::fit(&columns, &Y, Weighting::Absolute(&u)).unwrap();
        let relative = LinearRegression::fit(&columns, &Y, Weighting::Relative(&u)).unwrap();
        let sum = |f: &dyn Fn(usize) -> f64| (0..5).map(|i| f(i) / (u[i] * u[i])).sum::<f64>();
        let (s, sx, sy) = (sum(&|_| 1.0), sum(&|i| X[i]), sum(&|i| Y[i]));
        let (sxx, sxy) = (sum(&|i| X[i] * X[i]), sum(&|i| X[i] * Y[i]));
        let determinant = s * sxx - sx * sx;
        let slope = (s * sxy - sx * sy) / determinant;
        // The closed form cancels two digits.
        assert!((absolute.coefficients()[1] / slope - 1.0).abs() < 1e-13);
        assert!((absolute.standard_uncertainty(1).unwrap() / (s / determinant).sqrt() - 1.0).abs() < 1e-13);
        assert!((absolute.covariance(0, 1).unwrap() / (-sx / determinant) - 1.0).abs() < 1e-13);
        let factor = relative.residual_standard_deviation().unwrap();
        let ratio = relative.standard_uncertainty(0).unwrap() / absolute.standard_uncertainty(0).unwrap();
        assert!((ratio / factor - 1.0).abs() < 1e-14);
        assert_eq!(relative.coefficients(), absolute.coefficients());
        // A common factor of the uncertainties changes nothing but S if they are relative.
        let doubled = u.map(|u| 2.0 * u);
        let other = LinearRegression::fit(&columns, &Y, Weighting::Relative(&doubled)).unwrap();
        assert_eq!(other.standard_uncertainty(1), relative.standard_uncertainty(1));
    }

    #[test]
    fn dependent_columns_are_named() {
        let ones = [1.0; 5];
        let both: Vec<f64> = X.iter().map(|x| 2.0 * x + 3.0).collect();
        let squares = X.map(|x| x * x);
        let columns: [(&str, &[f64]); 4] = [("one", &ones), ("x", &X), ("both", &both), ("square", &squares)];
        let regression = LinearRegression::fit(&columns, &Y, Weighting::Equal).unwrap();
        assert_eq!((regression.rank(), regression.degrees_of_freedom()), (3, 2));
        assert_eq!(regression.null_directions().len(), 1);
        assert_eq!(regression.standard_uncertainty(0), None);
        assert!(regression.standard_uncertainty(3).is_some(), "the square is determined");
        let text = regression.to_string();
        assert!(text.contains("not determined") && text.contains("change together"), "{text}");
        assert!(regression.predict(&[1.0, 0.0, 0.0, 0.0]).is_none());
        // The fit itself is that of the parabola.
        let three: [(&str, &[f64]); 3] = [("one", &ones), ("x", &X), ("square", &squares)];
        let parabola = LinearRegression::fit(&three, &Y, Weighting::Equal).unwrap();
        let (a, b) = (regression.sum_of_squares(), parabola.sum_of_squares());
        assert!((a / b - 1.0).abs() < 1e-10, "{a} against {b}");
    }

    #[test]
    fn bands_are_those_of_a_straight_line() {
        let ones = [1.0; 5];
        let line = LinearRegression::fit(&[("a", &ones), ("b", &X)], &Y, Weighting::Equal).unwrap();
        let at = line.predict(&[1.0, 6.0]).unwrap();
        let s = line.residual_standard_deviation().unwrap();
        // u² = s² (1/n + (x − x̄)²/Σ(x − x̄)²)
        let u = s * (0.2 + 9.0 / 10.0f64).sqrt();
        assert!((at.standard_uncertainty() / u - 1.0).abs() < 1e-13);
        let t = coverage_factor(0.95, 3.0).unwrap();
        let (lower, upper) = at.observation(0.95, 1.0).unwrap();
        assert!(((upper - lower) / (2.0 * t * u.hypot(s)) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn bad_input_is_named() {
        let fit = |columns: &[(&str, &[f64])], y: &[f64], weighting| {
            LinearRegression::fit(columns, y, weighting).unwrap_err().to_string()
        };
        assert!(fit(&[("a", &[1.0])], &Y, Weighting::Equal).contains("a has 1 values for 5"));
        let bad = [1.0, f64::NAN, 1.0, 1.0, 1.0];
        assert!(fit(&[("a", &bad)], &Y, Weighting::Equal).contains("value 1 of a must be finite"));
        assert!(fit(&[("a", &X)], &bad, Weighting::Equal).contains("value 1 of y"));
        assert!(fit(&[("a", &X)], &Y, Weighting::Relative(&[1.0; 4])).contains("4 values"));
        let negative = [1.0, 1.0, -1.0, 1.0, 1.0];
        assert!(fit(&[("a", &X)], &Y, Weighting::Absolute(&negative)).contains("observation 2"));
        assert!(fit(&[], &Y, Weighting::Equal).contains("at least one column"));
        let one: [f64; 1] = [1.0];
        assert!(fit(&[("a", &one), ("b", &one)], &one, Weighting::Equal).contains("1 observations cannot"));
    }
}
