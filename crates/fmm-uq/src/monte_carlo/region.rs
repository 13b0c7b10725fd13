//! Covariance and coverage regions of a sample of outputs.

use nalgebra::DVector;

use crate::error::UncertaintyError;
use crate::moments::Moments;
use crate::monte_carlo::order_statistics::ranked;
use crate::monte_carlo::output_sample::OutputSample;
use crate::region::Region;

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
    /// [`UncertaintyError::Invalid`]; [`UncertaintyError::TooFewTrials`];
    /// [`UncertaintyError::NoAnswer`] if the outputs are fully correlated or one does not vary.
    pub fn ellipsoid(&self, level: f64) -> Result<Region, UncertaintyError> {
        let mut region = self.region(level)?;
        let (root, outputs) = (region.root()?, self.outputs());
        let mut distance = DVector::zeros(outputs);
        let squares = self.distances(|row| {
            for (j, d) in distance.iter_mut().enumerate() {
                *d = (row[j] - region.centre[j]) / region.standard_uncertainties[j];
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
        let indices = 0..self.outputs();
        let centre = indices.clone().map(|j| self.estimate(j)).collect::<Result<Vec<_>, _>>()?;
        let uncertainties = indices.map(|j| self.standard_uncertainty(j)).collect::<Result<Vec<_>, _>>()?;
        Region::new(centre, uncertainties, |i, j| self.covariance(i, j), level)
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
