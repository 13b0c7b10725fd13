//! The straight line through results that differ by more than their uncertainties.

use fmm_model::coverage_factor;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::error::FitError;
use crate::regression::weighting::too_few_observations;
use crate::regression::york::{UncertainPoint, YorkLine};

/// The straight line through results with uncertainties, each of which may have an effect of its own beside the line: a
/// random-effects meta-regression on one covariate.
///
/// ```text
/// y_i = a + b x_i + b_i + e_i,     var b_i = τ²,  var e_i = u²(y_i)
/// S(τ²) = n − 2                                            which gives τ², or 0 if S(0) is less
/// u² = max(1, S(τ²)/(n − 2)) u²_York(τ²),   a ± t(n − 2) u(a),   b ± t(n − 2) u(b)
/// ```
///
/// S and u_York are those of [`YorkLine`] with u²(y) + τ² in place of u²(y), so that the x may be uncertain too. The
/// estimate of τ² is that of Mandel and Paule with a covariate (DerSimonian and Kacker 2007), the intervals are those
/// of Knapp and Hartung (2003). For a mean in place of a line there is `Consensus` of fmm-uq.
///
/// ```
/// use fmm_fit::{RandomEffectsLine, UncertainPoint, YorkLine};
///
/// // Four runs that scatter by 0.2 about a line of slope 2, each known to 0.01.
/// let points = [(1.0, 2.2), (2.0, 3.8), (3.0, 6.2), (4.0, 7.8)].map(|(x, y)| UncertainPoint::new(x, y, 0.0, 0.01));
/// let line = RandomEffectsLine::fit(&points)?;
/// assert!((line.between() - 0.253).abs() < 0.001);
/// // A line that takes the runs to be alike claims to know the slope 25 times better.
/// assert!(line.slope_uncertainty() > 25.0 * YorkLine::fit(&points)?.slope_uncertainty());
/// assert!(line.intercept_p_value() > 0.05 && line.slope_p_value() < 0.01);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// # References
/// - G. Knapp, J. Hartung, Statistics in Medicine 22 (2003) 2693, <https://doi.org/10.1002/sim.1482>.
/// - R. DerSimonian, R. Kacker, Contemporary Clinical Trials 28 (2007) 105,
///   <https://doi.org/10.1016/j.cct.2006.04.004>.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomEffectsLine {
    line: YorkLine,
    variance: f64,
    /// √(max(1, S/(n − 2))).
    factor: f64,
    homogeneity: f64,
}

/// Doublings of τ² that reach from the smallest f64 to the largest.
const DOUBLINGS: usize = 2100;
/// Halvings of the interval in which τ² lies: one for each bit of an f64, and those between its ends.
const HALVINGS: usize = 60;

impl RandomEffectsLine {
    /// Fits the line to at least three points.
    ///
    /// # Errors
    /// [`FitError::Undetermined`] for fewer, and those of [`YorkLine::fit`].
    pub fn fit(points: &[UncertainPoint]) -> Result<Self, FitError> {
        if points.len() < 3 {
            return Err(too_few_observations(points.len(), 3));
        }
        let widened = |variance: f64| -> Result<YorkLine, FitError> {
            let points: Vec<UncertainPoint> = points.iter().map(|point| point.widened(variance)).collect();
            YorkLine::fit(&points)
        };
        let plain = YorkLine::fit(points)?;
        let homogeneity = plain.p_value().unwrap_or(1.0);
        let freedom = plain.degrees_of_freedom() as f64;
        let (mut line, mut variance) = (plain, 0.0);
        if plain.sum_of_squares() > freedom {
            // Of one point of the usual uncertainty as much as it is too far off; the solution is found from there.
            let (mut low, mut high) = (0.0, (freedom.sqrt() * plain.intercept_uncertainty()).powi(2));
            for _ in 0..DOUBLINGS {
                line = widened(high)?;
                if line.sum_of_squares() <= freedom {
                    break;
                }
                (low, high) = (high, 2.0 * high);
            }
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if widened(middle)?.sum_of_squares() > freedom { low = middle } else { high = middle }
            }
            variance = high;
            line = widened(variance)?;
        }
        let factor = (line.sum_of_squares() / freedom).max(1.0).sqrt();
        Ok(Self { line, variance, factor, homogeneity })
    }

    /// b, change of y with x.
    pub fn slope(&self) -> f64 {
        self.line.slope()
    }

    /// a, value of y at x = 0.
    pub fn intercept(&self) -> f64 {
        self.line.intercept()
    }

    /// u(b), with what the results differ by beside the line.
    pub fn slope_uncertainty(&self) -> f64 {
        self.factor * self.line.slope_uncertainty()
    }

    /// u(a), with what the results differ by beside the line.
    pub fn intercept_uncertainty(&self) -> f64 {
        self.factor * self.line.intercept_uncertainty()
    }

    /// τ, standard deviation of the results beside the line beyond their uncertainties (unit of y).
    pub fn between(&self) -> f64 {
        self.variance.sqrt()
    }

    /// n − 2.
    pub fn degrees_of_freedom(&self) -> usize {
        self.line.degrees_of_freedom()
    }

    /// Probability of a scatter about the line as large if the results differed from it by their uncertainties only
    /// (1).
    pub fn homogeneity_p_value(&self) -> f64 {
        self.homogeneity
    }

    /// Probability of a slope as far from zero if y did not depend on x (1).
    pub fn slope_p_value(&self) -> f64 {
        self.p_value(self.slope(), self.slope_uncertainty())
    }

    /// Probability of an intercept as far from zero if the line passed through the origin (1).
    pub fn intercept_p_value(&self) -> f64 {
        self.p_value(self.intercept(), self.intercept_uncertainty())
    }

    /// The interval that covers the slope with probability `level`; `None` unless 0 < level < 1.
    pub fn slope_interval(&self, level: f64) -> Option<(f64, f64)> {
        self.interval(self.slope(), self.slope_uncertainty(), level)
    }

    /// The interval that covers the intercept with probability `level`; `None` unless 0 < level < 1.
    pub fn intercept_interval(&self, level: f64) -> Option<(f64, f64)> {
        self.interval(self.intercept(), self.intercept_uncertainty(), level)
    }

    /// The value of the line at `x`.
    pub fn value(&self, x: f64) -> f64 {
        self.line.value(x)
    }

    /// Standard uncertainty of the value of the line at an exactly known `x`.
    pub fn standard_uncertainty(&self, x: f64) -> f64 {
        self.factor * self.line.standard_uncertainty(x)
    }

    /// The interval that covers the value of the line at `x` with probability `level`; `None` unless 0 < level < 1.
    pub fn value_interval(&self, x: f64, level: f64) -> Option<(f64, f64)> {
        self.interval(self.value(x), self.standard_uncertainty(x), level)
    }

    fn freedom(&self) -> f64 {
        self.degrees_of_freedom() as f64
    }

    fn interval(&self, value: f64, u: f64, level: f64) -> Option<(f64, f64)> {
        let reach = coverage_factor(level, self.freedom())? * u;
        Some((value - reach, value + reach))
    }

    fn p_value(&self, value: f64, u: f64) -> f64 {
        StudentsT::new(0.0, 1.0, self.freedom()).map_or(1.0, |student| 2.0 * student.sf((value / u).abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::regression::polynomial::StraightLine;
    use crate::regression::weighting::Weighting;

    const X: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 6.0, 9.0];
    const Y: [f64; 6] = [2.2, 2.8, 3.6, 4.9, 6.1, 9.7];

    fn points(u: f64) -> Vec<UncertainPoint> {
        X.iter().zip(Y).map(|(x, y)| UncertainPoint::new(*x, y, 0.0, u)).collect()
    }

    /// Equal uncertainties: τ² and u² are together the variance that ordinary least squares finds, of which statsmodels
    /// holds the neighbouring file's line.
    #[test]
    fn with_equal_uncertainties_it_is_ordinary_least_squares() {
        let ordinary = StraightLine::fit(&X, &Y, Weighting::Equal).unwrap();
        let s = ordinary.regression().residual_standard_deviation().unwrap();
        let line = RandomEffectsLine::fit(&points(0.1 * s)).unwrap();
        assert!((line.between().hypot(0.1 * s) / s - 1.0).abs() < 1e-12, "{} {s}", line.between());
        for (found, expected) in [
            (line.slope(), ordinary.slope()),
            (line.intercept(), ordinary.intercept()),
            (line.slope_uncertainty(), ordinary.slope_uncertainty().unwrap()),
            (line.intercept_uncertainty(), ordinary.intercept_uncertainty().unwrap()),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} instead of {expected}");
        }
        let (low, high) = line.slope_interval(0.95).unwrap();
        let expected = ordinary.regression().interval_of(1, 0.95).unwrap();
        assert!((low / expected.0 - 1.0).abs() < 1e-11 && (high / expected.1 - 1.0).abs() < 1e-11);
        let at = ordinary.predict(2.7).unwrap();
        assert!((line.standard_uncertainty(2.7) / at.standard_uncertainty() - 1.0).abs() < 1e-12);
    }

    /// Uncertainties that explain the scatter: nothing is added, and a lucky scatter does not narrow the line.
    #[test]
    fn without_effects_it_is_the_line_of_york() {
        let (line, york) = (RandomEffectsLine::fit(&points(1.0)).unwrap(), YorkLine::fit(&points(1.0)).unwrap());
        assert_eq!((line.between(), line.slope(), line.intercept()), (0.0, york.slope(), york.intercept()));
        assert_eq!(line.slope_uncertainty(), york.slope_uncertainty());
        assert_eq!(line.homogeneity_p_value(), york.p_value().unwrap());
    }

    /// The intervals hold for runs of unequal uncertainties and a spread between them, those of a line without effects
    /// do not.
    #[test]
    fn intervals_hold_where_the_runs_differ() {
        use rand_chacha::ChaCha8Rng;
        use rand_chacha::rand_core::{Rng, SeedableRng};
        const TRIALS: usize = 2000;
        let mut random = ChaCha8Rng::seed_from_u64(5);
        // The sum of twelve uniform numbers is normal but for tails beyond 3 standard deviations.
        let mut normal = || (0..12).map(|_| (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64).sum::<f64>() - 6.0;
        let (mut held, mut plain) = (0, 0);
        for _ in 0..TRIALS {
            let points: Vec<UncertainPoint> = (0..9)
                .map(|i| {
                    let (x, u) = (f64::from(1 + i / 3), 0.05 * f64::from(1 + i % 3));
                    UncertainPoint::new(x, 0.5 + 2.0 * x + 0.3 * normal() + u * normal(), 0.0, u)
                })
                .collect();
            let (line, york) = (RandomEffectsLine::fit(&points).unwrap(), YorkLine::fit(&points).unwrap());
            let (low, high) = line.intercept_interval(0.95).unwrap();
            held += usize::from((low..high).contains(&0.5));
            plain += usize::from((york.intercept() - 0.5).abs() < 1.96 * york.intercept_uncertainty());
        }
        // Three standard deviations of a share of 0.95 among as many trials are 0.015; max(1, q) makes the intervals
        // wider at most.
        let [held, plain] = [held, plain].map(|count| count as f64 / TRIALS as f64);
        assert!((0.935..0.975).contains(&held) && plain < 0.7, "{held}, {plain}");
    }

    #[test]
    fn bad_input_is_named() {
        let two = RandomEffectsLine::fit(&points(0.1)[..2]).unwrap_err().to_string();
        assert!(two.contains("2 observations"), "{two}");
        let upright: Vec<UncertainPoint> = Y.iter().map(|y| UncertainPoint::new(1.0, *y, 0.0, 0.1)).collect();
        assert!(RandomEffectsLine::fit(&upright).is_err());
    }
}
