//! Repeated observations, the evaluation of type A.

use crate::error::UncertaintyError;
use crate::moments::Moments;

/// Repeated independent observations of one quantity (JCGM 100:2008, 4.2).
///
/// ```text
/// q̄ = Σ q/n,   s² = Σ (q − q̄)²/(n − 1),   u(q̄) = s/√n,   ν = n − 1        (JCGM 100:2008, Eq. 3 to 5)
/// r₁ = Σ (q_i − q̄)(q_{i+1} − q̄)/Σ (q − q̄)²
/// ```
///
/// u(q̄) holds for independent observations only; [`Observations::lag_one_autocorrelation`] far outside ±2/√n says that
/// they are not.
///
/// ```
/// use fmm_uq::Observations;
///
/// let voltages = Observations::new(&[5.007, 4.994, 5.005, 4.990, 4.999])?;
/// assert!((voltages.mean() - 4.999).abs() < 1e-15);
/// assert!((voltages.standard_uncertainty() - 0.003_209_36).abs() < 1e-8);
/// assert_eq!(voltages.degrees_of_freedom(), 4.0);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    values: Vec<f64>,
    moments: Moments,
    standard_deviation: f64,
}

impl Observations {
    /// Observations of at least two finite values.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for fewer than two values, or if a value or the squares are not finite;
    /// [`UncertaintyError::NoAnswer`] if the values differ by so little that their squares are lost.
    pub fn new(values: &[f64]) -> Result<Self, UncertaintyError> {
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(UncertaintyError::observation_not_finite(index, values[index]));
        }
        let too_few = || UncertaintyError::too_few_observations(values.len(), 2);
        if values.len() < 2 {
            return Err(too_few());
        }
        let overflow = || UncertaintyError::observation_not_finite(0, values[0]);
        let moments = Moments::of_values(values).if_finite().ok_or_else(overflow)?;
        moments.require_squares(values, "the observations")?;
        let standard_deviation = moments.standard_deviation().ok_or_else(too_few)?;
        Ok(Self { values: values.to_vec(), moments, standard_deviation })
    }

    /// q̄, mean (unit of the observations).
    pub const fn mean(&self) -> f64 {
        self.moments.mean()
    }

    /// s, standard deviation of a single observation (unit of the observations).
    pub const fn standard_deviation(&self) -> f64 {
        self.standard_deviation
    }

    /// u(q̄) = s/√n, standard uncertainty of the mean (unit of the observations).
    pub fn standard_uncertainty(&self) -> f64 {
        self.standard_deviation / (self.values.len() as f64).sqrt()
    }

    /// ν = n − 1 (1).
    pub fn degrees_of_freedom(&self) -> f64 {
        (self.values.len() - 1) as f64
    }

    /// The observations in their order (their unit).
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// r₁, correlation of each observation with the next (1); 0 if all are equal.
    pub fn lag_one_autocorrelation(&self) -> f64 {
        let mean = self.mean();
        let products: Vec<f64> = self.values.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).collect();
        let all = self.moments.sum_of_squares();
        if all == 0.0 { 0.0 } else { products.iter().sum::<f64>() / all }
    }

    /// r, correlation coefficient with simultaneous observations of another quantity (1); 0 if one of the two does
    /// not vary.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] if the numbers of observations differ.
    pub fn correlation(&self, other: &Self) -> Result<f64, UncertaintyError> {
        let (first, second) = (self.values.len(), other.values.len());
        if first != second {
            let what = format!("simultaneous observations come in equal numbers, but there are {first} and {second}");
            return Err(UncertaintyError::invalid(what));
        }
        let scale = self.standard_deviation * other.standard_deviation * (first - 1) as f64;
        if scale == 0.0 {
            return Ok(0.0);
        }
        let pairs = self.values.iter().zip(&other.values);
        let products: f64 = pairs.map(|(a, b)| (a - self.mean()) * (b - other.mean())).sum();
        // Rounding must not carry a perfect correlation beyond 1.
        Ok((products / scale).clamp(-1.0, 1.0))
    }
}
