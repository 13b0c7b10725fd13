//! Coverage regions of several outputs from the linear approximation.

use nalgebra::{Cholesky, DMatrix};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

use crate::{Budget, Propagation, Region, UncertaintyError, coverage_factor};

impl Propagation {
    /// The ellipsoid that holds the outputs with probability p, if they are normal or, where inputs have finite degrees
    /// of freedom, multivariate t (JCGM 102:2011, 6.5).
    ///
    /// ```text
    /// k² = χ²_m(p) for infinite ν,   k² = m F_{m, ν}(p) otherwise
    /// ```
    ///
    /// for m outputs and the smallest ν_eff of them, truncated to a whole number. The second holds exactly where all
    /// uncertainties come from one ensemble of ν degrees of freedom each (the multivariate t of a Monte Carlo).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless 0 < p < 1; [`UncertaintyError::NoAnswer`] as for [`Budget::expanded`],
    /// and if the outputs are fully correlated or one is certain.
    pub fn ellipsoid(&self, level: f64) -> Result<Region, UncertaintyError> {
        let (mut region, nu) = self.region(level)?;
        let (u, m) = (&region.standard_uncertainties, self.outputs().len());
        let scaled = DMatrix::from_fn(m, m, |i, j| region.covariance[i][j] / u[i] / u[j]);
        let rounding = 1e-12 * m as f64;
        let root = Cholesky::new(scaled).map(Cholesky::unpack).ok_or_else(UncertaintyError::singular_covariance)?;
        if root.diagonal().iter().any(|&pivot| !(pivot * pivot > rounding)) {
            return Err(UncertaintyError::singular_covariance());
        }
        let dimensions = m as f64;
        let undefined = |_| UncertaintyError::degrees_of_freedom_undefined();
        let out_of_range = || UncertaintyError::level_out_of_range(level);
        let square = if m == 1 {
            coverage_factor(level, nu).ok_or_else(out_of_range)?.powi(2)
        } else if nu.is_infinite() {
            ChiSquared::new(dimensions)
                .map_err(|_| UncertaintyError::degrees_of_freedom_undefined())?
                .inverse_cdf(level)
        } else {
            dimensions * FisherSnedecor::new(dimensions, nu).map_err(undefined)?.inverse_cdf(level)
        };
        region.coverage_factor = square.sqrt();
        Ok(region)
    }

    /// The rectangle y_j ± k u_j that holds the outputs with at least probability p, however they are correlated
    /// (JCGM 102:2011, 6.5): the intervals of its sides have the coverage probability 1 − (1 − p)/m.
    ///
    /// Student's t is taken at the smallest ν_eff of the outputs, truncated to a whole number.
    ///
    /// # Errors
    /// Those of [`Propagation::ellipsoid`]; outputs may be fully correlated here.
    pub fn rectangle(&self, level: f64) -> Result<Region, UncertaintyError> {
        let (mut region, nu) = self.region(level)?;
        let of_side = 1.0 - (1.0 - level) / self.outputs().len() as f64;
        region.coverage_factor =
            coverage_factor(of_side, nu).ok_or_else(|| UncertaintyError::level_out_of_range(of_side))?;
        Ok(region)
    }

    /// The region without its factor, and the smallest ν_eff.
    fn region(&self, level: f64) -> Result<(Region, f64), UncertaintyError> {
        let (level, outputs) = (UncertaintyError::require_level(level)?, self.outputs());
        let mut nu = f64::INFINITY;
        for output in outputs {
            nu = nu.min(output.expanded(level)?.degrees_of_freedom);
        }
        let standard_uncertainties: Vec<f64> = outputs.iter().map(Budget::standard_uncertainty).collect();
        if standard_uncertainties.contains(&0.0) {
            return Err(UncertaintyError::singular_covariance());
        }
        let row = |i: usize| (0..outputs.len()).map(|j| self.covariance(i.max(j), i.min(j))).collect();
        let covariance = (0..outputs.len()).map(row).collect();
        let centre = outputs.iter().map(Budget::estimate).collect();
        Ok((Region { centre, standard_uncertainties, covariance, coverage_factor: 0.0, level }, nu))
    }
}
