//! Inputs of which too little is known for a result to have moments.

use crate::distributions::Shape;
use crate::{Input, Inputs, UncertaintyError};

/// The t-distributed input of the fewest degrees of freedom, if it has no variance: ν ≤ 2, from two or three
/// observations.
///
/// The sample of its trials has a standard deviation, which is another one with every seed and grows with their number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HeavyTail {
    input: String,
    degrees_of_freedom: f64,
}

impl HeavyTail {
    pub(crate) fn of(inputs: &Inputs) -> Option<Self> {
        let nu = |input: &Input| match input.distribution().shape {
            Shape::StudentT { degrees_of_freedom, .. } => degrees_of_freedom,
            _ => f64::INFINITY,
        };
        let fewest = inputs.as_slice().iter().min_by(|a, b| nu(a).total_cmp(&nu(b)))?;
        (nu(fewest) <= 2.0).then(|| Self { input: fewest.name().to_owned(), degrees_of_freedom: nu(fewest) })
    }

    /// Refuses a mean: there is none for ν = 1.
    pub(crate) fn require_mean(this: Option<&Self>) -> Result<(), UncertaintyError> {
        match this {
            Some(Self { input, degrees_of_freedom }) if *degrees_of_freedom <= 1.0 => {
                Err(UncertaintyError::no_mean(input, *degrees_of_freedom))
            }
            _ => Ok(()),
        }
    }

    /// Refuses a variance.
    pub(crate) fn require_variance(this: Option<&Self>) -> Result<(), UncertaintyError> {
        match this {
            Some(Self { input, degrees_of_freedom }) => Err(UncertaintyError::no_variance(input, *degrees_of_freedom)),
            None => Ok(()),
        }
    }
}
