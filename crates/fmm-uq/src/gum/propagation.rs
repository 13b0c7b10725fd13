//! Several results of the same inputs, with their covariance.

use fmm_model::coverage_factor;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

use crate::error::UncertaintyError;
use crate::gum::budget::Budget;
use crate::region::Region;

/// The budgets of all outputs of a model, and how the outputs are correlated (JCGM 102:2011, 6.2).
#[derive(Debug, Clone, PartialEq)]
pub struct Propagation {
    budgets: Vec<Budget>,
}

impl Propagation {
    pub(crate) const fn new(budgets: Vec<Budget>) -> Self {
        Self { budgets }
    }

    /// The budgets in the order of the outputs.
    pub fn outputs(&self) -> &[Budget] {
        &self.budgets
    }

    /// The budget of the only output.
    ///
    /// # Errors
    /// [`UncertaintyError::Model`] if there are more.
    pub fn single(mut self) -> Result<Budget, UncertaintyError> {
        let found = self.budgets.len();
        match (self.budgets.pop(), found) {
            (Some(budget), 1) => Ok(budget),
            _ => Err(output_count(found)),
        }
    }

    /// u(y_i, y_j), covariance of two outputs (product of their units); 0 if there is no such output.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        match (self.budgets.get(i), self.budgets.get(j)) {
            (Some(first), Some(second)) => first.covariance_with(second).unwrap_or(0.0),
            _ => 0.0,
        }
    }

    /// Correlation coefficient of two outputs (1); 0 if one of them has no uncertainty.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        let u = |output: usize| self.budgets.get(output).map_or(0.0, Budget::standard_uncertainty);
        let is_uncertain = u(i) > 0.0 && u(j) > 0.0;
        if is_uncertain { (self.covariance(i, j) / u(i) / u(j)).clamp(-1.0, 1.0) } else { 0.0 }
    }

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
    /// [`UncertaintyError::Invalid`] unless 0 < p < 1; [`UncertaintyError::NoAnswer`] as for [`Budget::expanded`],
    /// and if the outputs are fully correlated or one is certain.
    pub fn ellipsoid(&self, level: f64) -> Result<Region, UncertaintyError> {
        let (mut region, nu) = self.region(level)?;
        region.root()?;
        let m = self.budgets.len() as f64;
        let square = if self.budgets.len() == 1 {
            coverage_factor(level, nu).map(|k| k * k)
        } else if nu.is_infinite() {
            ChiSquared::new(m).ok().map(|chi| chi.inverse_cdf(level))
        } else {
            FisherSnedecor::new(m, nu).ok().map(|f| m * f.inverse_cdf(level))
        };
        region.coverage_factor = square.ok_or_else(|| UncertaintyError::level(level))?.sqrt();
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
        let factor = coverage_factor(1.0 - (1.0 - level) / self.budgets.len() as f64, nu);
        region.coverage_factor = factor.ok_or_else(|| UncertaintyError::level(level))?;
        Ok(region)
    }

    /// The region without its factor, and the smallest ν_eff.
    fn region(&self, level: f64) -> Result<(Region, f64), UncertaintyError> {
        let mut nu = f64::INFINITY;
        for output in &self.budgets {
            nu = nu.min(output.expanded(level)?.degrees_of_freedom);
        }
        let centre = self.budgets.iter().map(Budget::estimate).collect();
        let uncertainties = self.budgets.iter().map(Budget::standard_uncertainty).collect();
        Ok((Region::new(centre, uncertainties, |i, j| Ok(self.covariance(i, j)), level)?, nu))
    }
}

/// Error of another number of outputs than one.
pub(super) fn output_count(found: usize) -> UncertaintyError {
    UncertaintyError::model(format!("the model must give 1 outputs, but gives {found}"))
}
