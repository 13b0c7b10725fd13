//! A choice of smoothing.

use crate::calculus::integral::central_differences;
use crate::{EndRule, Record, RecordError, moving_average, savitzky_golay, savitzky_golay_derivative};

/// Smoothing of a record, if any.
///
/// ```
/// use fmm_record::{EndRule, Smoothing};
///
/// let mean = Smoothing::MovingAverage { span: 5, ends: EndRule::Shrinking };
/// // A fifth of the power of white noise remains.
/// assert!((mean.noise_gain()? - 0.2f64.sqrt()).abs() < 1e-12);
/// assert_eq!(Smoothing::None.noise_gain()?, 1.0);
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Smoothing {
    /// Not at all.
    #[default]
    None,
    /// A [`moving_average`].
    MovingAverage {
        /// Samples averaged; odd.
        span: usize,
        /// Rule at the ends.
        ends: EndRule,
    },
    /// A [`savitzky_golay`] filter.
    SavitzkyGolay {
        /// Samples that a polynomial is fitted to; odd.
        span: usize,
        /// Degree of the polynomial.
        degree: usize,
    },
}

impl Smoothing {
    /// The smoothed `values`.
    ///
    /// # Errors
    /// As for [`moving_average`] and [`savitzky_golay`].
    pub fn apply(&self, values: &[f64]) -> Result<Vec<f64>, RecordError> {
        match *self {
            Self::None => Ok(values.to_vec()),
            Self::MovingAverage { span, ends } => moving_average(values, span, ends),
            Self::SavitzkyGolay { span, degree } => savitzky_golay(values, span, degree),
        }
    }

    /// Samples that one smoothed sample is made of.
    pub fn span(&self) -> usize {
        match *self {
            Self::None => 1,
            Self::MovingAverage { span, .. } | Self::SavitzkyGolay { span, .. } => span,
        }
    }

    /// The derivative of the smoothed `values` per sample; divide by the sampling interval. Averages are differentiated
    /// by central differences, polynomials as such.
    ///
    /// # Errors
    /// As for [`Smoothing::apply`], and [`RecordError::TooShort`] below three values.
    pub fn slope(&self, values: &[f64]) -> Result<Vec<f64>, RecordError> {
        if let Self::SavitzkyGolay { span, degree } = *self {
            return savitzky_golay_derivative(values, span, degree);
        }
        central_differences(&self.apply(values)?)
    }

    /// Standard deviation that white noise of standard deviation 1 is left with away from the ends.
    ///
    /// # Errors
    /// As for [`Smoothing::apply`].
    pub fn noise_gain(&self) -> Result<f64, RecordError> {
        Ok(norm(&self.apply(&self.impulse())?))
    }

    /// Standard deviation of the [`slope`](Self::slope) of white noise of standard deviation 1.
    ///
    /// # Errors
    /// As for [`Smoothing::apply`].
    pub fn slope_noise_gain(&self) -> Result<f64, RecordError> {
        Ok(norm(&self.slope(&self.impulse())?))
    }

    /// A unit impulse, so far from both ends that nothing one-sided there sees it.
    fn impulse(&self) -> Vec<f64> {
        let reach = self.span() + 3;
        let mut impulse = vec![0.0; 2 * reach + 1];
        impulse[reach] = 1.0;
        impulse
    }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

impl Record {
    /// The record after `smoothing`.
    ///
    /// # Errors
    /// As for [`Smoothing::apply`].
    pub fn smoothed_by(&self, smoothing: &Smoothing) -> Result<Self, RecordError> {
        Ok(self.derived(self.start(), smoothing.apply(self.values())?))
    }

    /// The derivative in time after `smoothing`: as [`Record::differentiate`] with [`Smoothing::slope`].
    ///
    /// # Errors
    /// As for [`Record::differentiate`] and [`Smoothing::apply`].
    pub fn differentiate_smoothed_by(&self, smoothing: &Smoothing) -> Result<Self, RecordError> {
        self.quantity().derivative()?;
        let slope = smoothing.slope(self.values())?;
        self.with_derivative(slope.into_iter().map(|slope| slope / self.interval()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_are_those_of_the_weights() {
        let mean = Smoothing::MovingAverage { span: 5, ends: EndRule::Truncated };
        assert!((mean.noise_gain().unwrap().powi(2) - 0.2).abs() < 1e-15);
        // A difference of two averages over five keeps two samples at either end: 4 · (0.2/2)².
        assert!((mean.slope_noise_gain().unwrap().powi(2) - 0.04).abs() < 1e-15);
        assert!((Smoothing::None.slope_noise_gain().unwrap().powi(2) - 0.5).abs() < 1e-15);
        let polynomial = Smoothing::SavitzkyGolay { span: 5, degree: 2 };
        // The squared weights of a projection sum to its centre weight, 17/35; (4 + 1 + 1 + 4)/100.
        assert!((polynomial.noise_gain().unwrap().powi(2) - 17.0 / 35.0).abs() < 1e-12);
        assert!((polynomial.slope_noise_gain().unwrap().powi(2) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn slopes_make_a_record_of_the_derivative() {
        let values = (0..30).map(|i| 0.5 * f64::from(i)).collect();
        let record = Record::new(1.0, 0.5, values, crate::Quantity::Velocity, "m/s").unwrap();
        for smoothing in [Smoothing::None, Smoothing::SavitzkyGolay { span: 7, degree: 3 }] {
            let slope = record.differentiate_smoothed_by(&smoothing).unwrap();
            assert_eq!((slope.quantity(), slope.unit()), (crate::Quantity::Acceleration, "m/s²"));
            assert!(slope.values().iter().all(|slope| (slope - 1.0).abs() < 1e-12), "{slope:?}");
        }
        assert_eq!(record.differentiate_smoothed_by(&Smoothing::None).unwrap(), record.differentiate().unwrap());
        let force = record.with_quantity(crate::Quantity::Force);
        assert!(force.differentiate_smoothed_by(&Smoothing::None).is_err());
    }

    #[test]
    fn a_record_keeps_what_it_is() {
        let record = Record::new(1.0, 0.5, vec![3.0, 6.0, 0.0], crate::Quantity::Velocity, "m/s").unwrap();
        assert_eq!(record.smoothed_by(&Smoothing::None).unwrap(), record);
        let mean = Smoothing::MovingAverage { span: 3, ends: EndRule::Shrinking };
        assert_eq!(record.smoothed_by(&mean).unwrap().values(), [3.0, 3.0, 0.0]);
        assert!(record.smoothed_by(&Smoothing::SavitzkyGolay { span: 5, degree: 3 }).is_err());
    }
}
