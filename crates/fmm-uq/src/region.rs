//! Coverage region of several outputs.

use nalgebra::{Cholesky, DMatrix};

use crate::error::UncertaintyError;

/// A region of given coverage probability for all outputs together (JCGM 102:2011, 7.7).
///
/// ```text
/// ellipsoid  (η − y)ᵀ U⁻¹ (η − y) ≤ k²,      rectangle  |η_j − y_j| ≤ k u_j for all j
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Region {
    /// y, estimates of the outputs (their units).
    pub centre: Vec<f64>,
    /// u_j, standard uncertainties (units of the outputs).
    pub standard_uncertainties: Vec<f64>,
    /// U, covariance matrix of the outputs row by row (products of their units).
    pub covariance: Vec<Vec<f64>>,
    /// k, coverage factor (1).
    pub coverage_factor: f64,
    /// p, coverage probability (1).
    pub level: f64,
}

impl Region {
    /// The region with a coverage factor of 0, for a covariance of each pair i ≥ j.
    pub(crate) fn new(
        centre: Vec<f64>,
        standard_uncertainties: Vec<f64>,
        covariance: impl Fn(usize, usize) -> Result<f64, UncertaintyError>,
        level: f64,
    ) -> Result<Self, UncertaintyError> {
        let level = UncertaintyError::require_level(level)?;
        if standard_uncertainties.contains(&0.0) {
            return Err(singular());
        }
        // Each pair once, so that the matrix is symmetric to the last bit.
        let row = |i: usize| (0..centre.len()).map(|j| covariance(i.max(j), i.min(j))).collect();
        let covariance = (0..centre.len()).map(row).collect::<Result<Vec<Vec<f64>>, _>>()?;
        Ok(Self { centre, standard_uncertainties, covariance, coverage_factor: 0.0, level })
    }

    /// The Cholesky factor of the covariance in units of the uncertainties, so that outputs of very different size do
    /// not look singular.
    pub(crate) fn root(&self) -> Result<DMatrix<f64>, UncertaintyError> {
        let (u, m) = (&self.standard_uncertainties, self.centre.len());
        let scaled = DMatrix::from_fn(m, m, |i, j| self.covariance[i][j] / u[i] / u[j]);
        let rounding = 1e-12 * m as f64;
        let root = Cholesky::new(scaled).map(Cholesky::unpack).ok_or_else(singular)?;
        if root.diagonal().iter().all(|&pivot| pivot * pivot > rounding) { Ok(root) } else { Err(singular()) }
    }
}

/// Error of a covariance matrix without an inverse.
fn singular() -> UncertaintyError {
    UncertaintyError::no_answer(
        "the outputs are fully correlated or constant, so that their coverage region has no extent in some direction",
    )
}
