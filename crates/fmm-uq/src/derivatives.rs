//! Where the derivatives of a model come from.

use crate::{Input, Inputs, UncertaintyError};

/// Derivatives of one output along two directions, each taken over a whole step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Expansion {
    pub(crate) a: f64,
    pub(crate) aa: f64,
    pub(crate) aaa: f64,
    pub(crate) ab: f64,
    pub(crate) aab: f64,
    pub(crate) abb: f64,
}

/// Values of the outputs, and the sensitivities of each to every input.
pub(crate) struct Slopes {
    pub(crate) values: Vec<f64>,
    pub(crate) sensitivities: Vec<Vec<f64>>,
}

/// A model that can be differentiated at the estimates of its inputs.
pub(crate) trait Derivatives {
    /// First derivatives with respect to every input.
    fn slopes(&self) -> Result<Slopes, UncertaintyError>;
    /// Derivatives up to the third order along two directions, for every output; along the first alone if there is
    /// no second.
    fn expand(&self, first: &[f64], second: Option<&[f64]>) -> Result<Vec<Expansion>, UncertaintyError>;
}

/// "V = 4.999 V, I = 0.019661 A": where the model was evaluated.
pub(crate) fn place(inputs: &Inputs, at: impl Iterator<Item = f64>) -> String {
    let value = |(input, x): (&Input, f64)| format!("{} = {x} {}", input.name(), input.unit());
    inputs.as_slice().iter().zip(at).map(value).collect::<Vec<_>>().join(", ")
}
