//! Comparison of two nested models: value of a further parameter.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::error::FitError;
use crate::result::fit::Fit;

impl Fit {
    /// Akaike's information criterion with the correction for few residuals; the smaller the better.
    ///
    /// ```text
    /// AICc = n ln(S/n) + 2 k + 2 k (k + 1)/(n − k − 1),     k = rank + 1
    /// ```
    ///
    /// k counts the directions that the residuals determine, as a reparametrised model is the same model, and one
    /// for the variance. Only differences between fits to the same data mean anything; a difference of 10 is
    /// strong. `None` if n ≤ k + 1 or if the residuals are all zero.
    ///
    /// # References
    /// C. M. Hurvich, C.-L. Tsai, "Regression and time series model selection in small samples", Biometrika 76
    /// (1989) 297, <https://doi.org/10.1093/biomet/76.2.297>.
    pub fn corrected_akaike(&self) -> Option<f64> {
        let (n, k) = (self.residuals().len() as f64, self.rank() as f64 + 1.0);
        let sum = self.sum_of_squares();
        (n > k + 1.0 && sum > 0.0).then(|| n * (sum / n).ln() + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0))
    }
}

/// A comparison of a fit with a restricted one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FTest {
    /// F, reduction of the sum of squares per parameter added, over the variance of the full fit (1).
    pub f: f64,
    /// Probability of an F at least as large if the restricted model is right (1).
    pub p_value: f64,
    /// Number of parameters added, and degrees of freedom of the full fit.
    pub degrees_of_freedom: (usize, usize),
}

impl FTest {
    /// Tests a `restricted` fit against a `full` one that has it as a special case, on the same data.
    ///
    /// ```text
    /// F = ((S_r − S_f)/(ν_r − ν_f)) / (S_f/ν_f)
    /// ```
    ///
    /// Exact for linear models with independent normal residuals, good for smooth ones. A parameter of the full fit
    /// that ends at a bound adds nothing to its rank.
    ///
    /// ```
    /// use fmm_fit::{FTest, curve_fit};
    ///
    /// let (x, y) = ([0.0, 1.0, 2.0, 3.0, 4.0], [0.1, 0.9, 2.1, 2.9, 4.1]);
    /// let line = curve_fit(&x, &y, [("offset", 0.0), ("slope", 1.0)], |x, [a, b]| a + b * x)?;
    /// let mean = curve_fit(&x, &y, [("offset", 0.0)], |_, [a]| a)?;
    /// let test = FTest::of(&mean, &line)?;
    /// assert!(test.p_value < 1e-3);
    /// # Ok::<(), fmm_fit::FitError>(())
    /// ```
    ///
    /// # Errors
    /// [`FitError`] if the fits do not allow the comparison.
    pub fn of(restricted: &Fit, full: &Fit) -> Result<Self, FitError> {
        let (n_r, n_f) = (restricted.residuals().len(), full.residuals().len());
        if n_r != n_f {
            return Err(FitError::count(format!(
                "the restricted fit has {n_r} residuals and the full one {n_f}; they must be the same data"
            )));
        }
        if full.rank() <= restricted.rank() {
            let (full, restricted) = (full.rank(), restricted.rank());
            return Err(FitError::undetermined(format!(
                "the full fit has rank {full} and the restricted one {restricted}; it must determine more"
            )));
        }
        let (added, freedom) = (full.rank() - restricted.rank(), full.degrees_of_freedom());
        let (s_r, s_f) = (restricted.sum_of_squares(), full.sum_of_squares());
        if freedom == 0 || s_f == 0.0 {
            return Err(no_variance());
        }
        // Two fits at the same minimum differ by rounding and by the tolerance of the search.
        if s_f > s_r * (1.0 + 1e-9) {
            return Err(FitError::no_minimum(
                "the full fit has the larger sum of squares: it is not at its minimum, or the models are not nested",
            ));
        }
        let f = ((s_r - s_f).max(0.0) / added as f64) / (s_f / freedom as f64);
        let p_value = Self::tail(f, added as f64, freedom as f64).ok_or_else(no_variance)?;
        Ok(Self { f, p_value, degrees_of_freedom: (added, freedom) })
    }

    /// Probability that a ratio F of two variances with `added` and `freedom` degrees of freedom is at least `f` by
    /// chance (1); none for degrees of freedom that are not positive, or an `f` that is not a number.
    ///
    /// ```
    /// // The square of Student's t of 2.228 with ten degrees of freedom, which 5 % exceed.
    /// let p = fmm_fit::FTest::tail(2.228_138_852f64.powi(2), 1.0, 10.0).unwrap();
    /// assert!((p - 0.05).abs() < 1e-9);
    /// ```
    pub fn tail(f: f64, added: f64, freedom: f64) -> Option<f64> {
        /// Degrees of freedom from which on the variance below is as good as known.
        const MANY: f64 = 1e6;
        if f.is_nan() {
            return None;
        }
        let distribution = FisherSnedecor::new(added, freedom.min(MANY)).ok()?;
        Some(distribution.sf(f.max(0.0)))
    }
}

fn no_variance() -> FitError {
    FitError::undetermined("the full fit reproduces its data exactly, so it has no variance to compare with")
}
