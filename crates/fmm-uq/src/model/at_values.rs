//! One closure for derivatives and for trials.

use std::error::Error;

use fmm_model::Scalar;

use crate::{ModelOutput, Taylor};

/// A model over [`Taylor`] numbers as one over plain numbers, with the same bits: what a Monte Carlo, a Sobol' analysis
/// or a difference wants of a closure that [`propagate`](crate::propagate) takes.
///
/// A closure has one number type, so that one that is written for derivatives cannot be called with plain numbers. A
/// function generic in `D: Scalar` can, and its trials cost a tenth of these, which carry derivatives of zero along.
///
/// ```
/// use fmm_uq::{Input, Inputs, MonteCarlo, Scalar, Taylor, at_values, propagate};
///
/// let inputs = Inputs::new([Input::new("length", 0.5, 1e-3, "m")?, Input::new("angle", 0.2, 2e-3, "rad")?])?;
/// let offset = 0.01;
/// let height = |x: &[Taylor]| 2.0 * x[0] * x[1].sin() + offset;
/// let budget = propagate(&inputs, height)?;
/// let trials = MonteCarlo::new(&inputs, 20_000)?.run(at_values(height))?;
/// let ratio = trials.standard_uncertainty(0)? / budget.standard_uncertainty();
/// assert!((ratio - 1.0).abs() < 0.02);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
pub fn at_values<R: ModelOutput<Taylor>>(
    model: impl Fn(&[Taylor]) -> R,
) -> impl Fn(&[f64]) -> Result<Vec<f64>, Box<dyn Error + Send + Sync>> {
    move |values| {
        let numbers: Vec<Taylor> = values.iter().map(|value| Taylor::from(*value)).collect();
        let mut outputs = Vec::new();
        model(&numbers).append_to(&mut outputs)?;
        Ok(outputs.into_iter().map(Scalar::value).collect())
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
        let through = at_values(formula::<Taylor>);
        for i in 1..200 {
            let x = [0.037 * f64::from(i), 0.11 + 1.0 / f64::from(i)];
            assert_eq!(through(&x).unwrap(), formula(&x).unwrap());
        }
        assert_eq!(through(&[-1.0, 1.0]).unwrap_err().to_string(), "below zero");
    }
}
