//! Source of the derivatives of a model.

use fmm_model::Rounded;

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

impl Expansion {
    /// The same with the output in another unit.
    pub(crate) fn in_units_of(self, unit: f64) -> Self {
        let Self { a, aa, aaa, ab, aab, abb } = self;
        Self { a: a / unit, aa: aa / unit, aaa: aaa / unit, ab: ab / unit, aab: aab / unit, abb: abb / unit }
    }
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
    /// The outputs for any values of the inputs; `None` where the model fails.
    fn outputs_at(&self, x: &[f64]) -> Option<Vec<f64>>;
    /// Derivatives up to the third order along two directions, for every output; along the first alone if there is
    /// no second.
    fn expand(&self, first: &[f64], second: Option<&[f64]>) -> Result<Vec<Expansion>, UncertaintyError>;
}

/// "V = 4.999 V, I = 0.019661 A": where the model was evaluated.
pub(crate) fn place(inputs: &Inputs, at: impl Iterator<Item = f64>) -> String {
    let value = |(input, x): (&Input, f64)| format!("{} = {} {}", input.name(), Rounded::every_digit(x), input.unit());
    inputs.as_slice().iter().zip(at).map(value).collect::<Vec<_>>().join(", ")
}
