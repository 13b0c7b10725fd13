//! Coverage regions of several outputs.

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::monte_carlo::order_statistics::ranked;
use crate::{Moments, OutputSample, UncertaintyError};

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

impl OutputSample {
    /// u(y_i, y_j), covariance of two outputs (product of their units).
    ///
    /// # Errors
    /// Those of [`OutputSample::standard_uncertainty`].
    pub fn covariance(&self, i: usize, j: usize) -> Result<f64, UncertaintyError> {
        let own = self.standard_uncertainty(i)?.powi(2);
        if i == j {
            return Ok(own);
        }
        let (a, b) = (self.estimate(i)?, self.estimate(j)?);
        let pairs = self.values(i)?.iter().zip(self.values(j)?);
        let products: Vec<f64> = pairs.map(|(x, y)| (x - a) * (y - b)).collect();
        let n = products.len() as f64;
        Ok(Moments::of_values(&products).mean() * (n / (n - 1.0)))
    }

    /// Correlation coefficient of two outputs (1); 0 if one of them does not vary.
    ///
    /// # Errors
    /// Those of [`OutputSample::covariance`].
    pub fn correlation(&self, i: usize, j: usize) -> Result<f64, UncertaintyError> {
        let (u, v) = (self.standard_uncertainty(i)?, self.standard_uncertainty(j)?);
        if u == 0.0 || v == 0.0 {
            return Ok(0.0);
        }
        Ok((self.covariance(i, j)? / u / v).clamp(-1.0, 1.0))
    }

    /// The ellipsoid of the covariance matrix that holds a share p of the trials (JCGM 102:2011, 7.7.2).
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`]; [`UncertaintyError::TooFewTrials`];
    /// [`UncertaintyError::NoAnswer`] if the outputs are fully correlated or one does not vary.
    pub fn ellipsoid(&self, level: f64) -> Result<Region, UncertaintyError> {
        let mut region = self.region(level)?;
        let (u, outputs) = (&region.standard_uncertainties, self.outputs());
        // In units of the uncertainties, so that outputs of very different size do not look singular.
        let scaled = DMatrix::from_fn(outputs, outputs, |i, j| region.covariance[i][j] / u[i] / u[j]);
        let rounding = 1e-12 * outputs as f64;
        let root = Cholesky::new(scaled).map(Cholesky::unpack).ok_or_else(UncertaintyError::singular_covariance)?;
        if root.diagonal().iter().any(|&pivot| !(pivot * pivot > rounding)) {
            return Err(UncertaintyError::singular_covariance());
        }
        let mut distance = DVector::zeros(outputs);
        let squares = self.distances(|row| {
            for (j, d) in distance.iter_mut().enumerate() {
                *d = (row[j] - region.centre[j]) / u[j];
            }
            root.solve_lower_triangular_mut(&mut distance);
            distance.norm_squared()
        })?;
        region.coverage_factor = rank_of(&squares, level)?.sqrt();
        Ok(region)
    }

    /// The rectangle in proportion to the standard uncertainties that holds a share p of the trials (JCGM 102:2011,
    /// 7.7.3).
    ///
    /// # Errors
    /// Those of [`OutputSample::ellipsoid`]; the covariance is singular here only if an output does not vary.
    pub fn rectangle(&self, level: f64) -> Result<Region, UncertaintyError> {
        let mut region = self.region(level)?;
        let largest = self.distances(|row| {
            let scaled = row.iter().zip(region.centre.iter().zip(&region.standard_uncertainties));
            scaled.map(|(x, (y, u))| ((x - y) / u).abs()).fold(0.0, f64::max)
        })?;
        region.coverage_factor = rank_of(&largest, level)?;
        Ok(region)
    }

    fn region(&self, level: f64) -> Result<Region, UncertaintyError> {
        let level = UncertaintyError::require_level(level)?;
        let indices = 0..self.outputs();
        let centre = indices.clone().map(|j| self.estimate(j)).collect::<Result<Vec<_>, _>>()?;
        let standard_uncertainties = indices.map(|j| self.standard_uncertainty(j)).collect::<Result<Vec<_>, _>>()?;
        if standard_uncertainties.contains(&0.0) {
            return Err(UncertaintyError::singular_covariance());
        }
        // Each pair once, so that the matrix is symmetric to the last bit.
        let row = |i: usize| (0..self.outputs()).map(move |j| self.covariance(i.max(j), i.min(j))).collect();
        let covariance = (0..self.outputs()).map(row).collect::<Result<Vec<Vec<f64>>, _>>()?;
        Ok(Region { centre, standard_uncertainties, covariance, coverage_factor: 0.0, level })
    }

    /// A figure of every trial.
    fn distances(&self, mut of: impl FnMut(&[f64]) -> f64) -> Result<Vec<f64>, UncertaintyError> {
        let columns = (0..self.outputs()).map(|j| self.values(j)).collect::<Result<Vec<_>, _>>()?;
        let mut row = vec![0.0; columns.len()];
        let trials = columns.first().map_or(0, |column| column.len());
        let figure = |trial: usize| {
            for (x, column) in row.iter_mut().zip(&columns) {
                *x = column[trial];
            }
            of(&row)
        };
        Ok((0..trials).map(figure).collect())
    }
}

/// The smallest figure that a share `level` of the trials does not exceed.
fn rank_of(figures: &[f64], level: f64) -> Result<f64, UncertaintyError> {
    let rank = (level * figures.len() as f64).ceil() as usize;
    if rank == 0 || rank >= figures.len() {
        let needed = (2.0 / (1.0 - level)).ceil() as usize;
        return Err(UncertaintyError::too_few_trials(figures.len(), level, needed));
    }
    Ok(ranked(figures, rank))
}
