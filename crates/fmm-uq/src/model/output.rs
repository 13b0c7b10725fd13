//! Output of a model: the types it may return.

use std::error::Error;

use fmm_model::Scalar;

use crate::model::taylor::Taylor;

/// Result of a model: a number, an array or a vector of them, or a `Result` of one of these.
///
/// `D` is the number type: `f64` for a Monte Carlo and for differences, [`Taylor`] for exact derivatives. Thus the same
/// formula, generic in `D: Scalar`, serves them all.
///
/// ```
/// use fmm_uq::ModelOutput;
///
/// let mut values = Vec::new();
/// assert!(Ok::<_, String>([1.0, 2.0]).append_to(&mut values).is_ok());
/// assert_eq!(values, [1.0, 2.0]);
/// assert!(Err::<f64, _>("no root").append_to(&mut values).is_err());
/// ```
pub trait ModelOutput<D> {
    /// Appends the outputs in their order, or gives the reason why there are none.
    ///
    /// # Errors
    /// The model's own.
    fn append_to(self, outputs: &mut Vec<D>) -> Result<(), Box<dyn Error + Send + Sync>>;
}

impl ModelOutput<Self> for f64 {
    #[inline]
    fn append_to(self, outputs: &mut Vec<Self>) -> Result<(), Box<dyn Error + Send + Sync>> {
        outputs.push(self);
        Ok(())
    }
}

impl ModelOutput<Self> for Taylor {
    #[inline]
    fn append_to(self, outputs: &mut Vec<Self>) -> Result<(), Box<dyn Error + Send + Sync>> {
        outputs.push(self);
        Ok(())
    }
}

impl<D, const N: usize> ModelOutput<D> for [D; N] {
    #[inline]
    fn append_to(self, outputs: &mut Vec<D>) -> Result<(), Box<dyn Error + Send + Sync>> {
        outputs.extend(self);
        Ok(())
    }
}

impl<D> ModelOutput<D> for Vec<D> {
    #[inline]
    fn append_to(self, outputs: &mut Vec<D>) -> Result<(), Box<dyn Error + Send + Sync>> {
        outputs.extend(self);
        Ok(())
    }
}

impl<D, T: ModelOutput<D>, E: Into<Box<dyn Error + Send + Sync>>> ModelOutput<D> for Result<T, E> {
    #[inline]
    fn append_to(self, outputs: &mut Vec<D>) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.map_err(Into::into)?.append_to(outputs)
    }
}

impl Taylor {
    /// The model over plain numbers of a model over [`Taylor`] numbers, with the same bits: for trials of a closure
    /// that [`propagate`](crate::propagate) takes.
    ///
    /// A closure has one number type, so that one that is written for derivatives cannot be called with plain numbers.
    /// A function generic in `D: Scalar` can, and its trials cost a tenth of these, which carry derivatives of zero
    /// along.
    ///
    /// ```
    /// use fmm_uq::{Input, Inputs, MonteCarlo, Scalar, Taylor, propagate};
    ///
    /// let inputs = Inputs::new([Input::new("length", 0.5, 1e-3, "m")?, Input::new("angle", 0.2, 2e-3, "rad")?])?;
    /// let offset = 0.01;
    /// let height = |x: &[Taylor]| 2.0 * x[0] * x[1].sin() + offset;
    /// let budget = propagate(&inputs, height)?;
    /// let trials = MonteCarlo::new(&inputs, 20_000)?.run(Taylor::at_values(height))?;
    /// let ratio = trials.standard_uncertainty(0)? / budget.standard_uncertainty();
    /// assert!((ratio - 1.0).abs() < 0.02);
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    pub fn at_values<R: ModelOutput<Self>>(
        model: impl Fn(&[Self]) -> R,
    ) -> impl Fn(&[f64]) -> Result<Vec<f64>, Box<dyn Error + Send + Sync>> {
        move |values| {
            let numbers: Vec<Self> = values.iter().map(|value| Self::from(*value)).collect();
            let mut outputs = Vec::new();
            model(&numbers).append_to(&mut outputs)?;
            Ok(outputs.into_iter().map(Scalar::value).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula<D: Scalar>(x: &[D]) -> Result<[D; 2], &'static str> {
        if x[0] < 0.0 {
            return Err("below zero");
        }
        let mut sum = x[0].sqrt() + x[1].powi(-3) + x[1].powf(0.3) - (x[0] * 0.1).tan();
        sum *= x[1].log10() / x[0].atan();
        sum -= x[0].cos();
        Ok([sum, x[0] / x[1]])
    }

    #[test]
    fn bits_and_failures_are_those_of_plain_numbers() {
        let through = Taylor::at_values(formula::<Taylor>);
        for i in 1..200 {
            let x = [0.037 * f64::from(i), 0.11 + 1.0 / f64::from(i)];
            assert_eq!(through(&x).unwrap(), formula(&x).unwrap());
        }
        assert_eq!(through(&[-1.0, 1.0]).unwrap_err().to_string(), "below zero");
    }
}
