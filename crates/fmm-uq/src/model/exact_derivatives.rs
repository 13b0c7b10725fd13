//! Derivatives that carry no error of a step.

use std::cell::RefCell;

use fmm_model::Scalar;

use crate::model::derivatives::{Derivatives, Expansion, Slopes, place};
use crate::{Inputs, ModelOutput, Taylor, UncertaintyError};

/// A model that is evaluated in Taylor numbers.
pub(crate) struct Exact<'a, F> {
    inputs: &'a Inputs,
    model: F,
    values: RefCell<Option<Vec<f64>>>,
}

impl<'a, F, R> Exact<'a, F>
where
    F: Fn(&[Taylor]) -> R,
    R: ModelOutput<Taylor>,
{
    pub(crate) fn new(inputs: &'a Inputs, model: F) -> Self {
        Self { inputs, model, values: RefCell::new(None) }
    }

    fn here(&self) -> String {
        place(self.inputs, self.inputs.as_slice().iter().map(crate::Input::value))
    }

    fn evaluate(&self, x: &[Taylor]) -> Result<Vec<Taylor>, UncertaintyError> {
        let mut outputs = Vec::new();
        (self.model)(x)
            .append_to(&mut outputs)
            .map_err(|source| UncertaintyError::model_failed(&self.here(), source))?;
        let values: Vec<f64> = outputs.iter().map(|y| y.value()).collect();
        if let Some(&result) = values.iter().find(|value| !value.is_finite()) {
            return Err(UncertaintyError::result_not_finite(result, &self.here()));
        }
        let mut known = self.values.borrow_mut();
        let known = known.get_or_insert_with(|| values.clone());
        if known.len() != values.len() {
            return Err(UncertaintyError::output_count_changed(known.len(), values.len()));
        }
        if let Some((&first, &again)) = known.iter().zip(&values).find(|(first, again)| first != again) {
            return Err(UncertaintyError::model_not_repeatable(first, again, &self.here()));
        }
        Ok(outputs)
    }
}

impl<F, R> Derivatives for Exact<'_, F>
where
    F: Fn(&[Taylor]) -> R,
    R: ModelOutput<Taylor>,
{
    fn slopes(&self) -> Result<Slopes, UncertaintyError> {
        let inputs = self.inputs.as_slice();
        let mut x: Vec<Taylor> = inputs.iter().map(|input| Taylor::from(input.value())).collect();
        let mut slopes = Slopes { values: Vec::new(), sensitivities: Vec::new() };
        // Two inputs at a time: a Taylor number carries two directions.
        for pair in (0..inputs.len()).collect::<Vec<_>>().chunks(2) {
            for (direction, &i) in pair.iter().enumerate() {
                x[i] = Taylor::variable(inputs[i].value(), direction);
            }
            let outputs = self.evaluate(&x)?;
            slopes.sensitivities.resize(outputs.len(), Vec::new());
            for (direction, &i) in pair.iter().enumerate() {
                for (row, y) in slopes.sensitivities.iter_mut().zip(&outputs) {
                    row.push(y.partial(direction));
                }
                x[i] = Taylor::from(inputs[i].value());
            }
            slopes.values = outputs.iter().map(|y| y.value()).collect();
        }
        Ok(slopes)
    }

    fn outputs_at(&self, x: &[f64]) -> Option<Vec<f64>> {
        let x: Vec<Taylor> = x.iter().map(|&value| Taylor::from(value)).collect();
        let mut outputs = Vec::new();
        (self.model)(&x).append_to(&mut outputs).ok()?;
        Some(outputs.iter().map(|y| y.value()).collect())
    }

    fn expand(&self, first: &[f64], second: Option<&[f64]>) -> Result<Vec<Expansion>, UncertaintyError> {
        let step = |i: usize| second.map_or(0.0, |second| second[i]);
        let inputs = self.inputs.as_slice().iter().enumerate();
        let x: Vec<Taylor> = inputs.map(|(i, input)| Taylor::along(input.value(), first[i], step(i))).collect();
        let expansion = |y: &Taylor| Expansion {
            a: y.partial(0),
            aa: 2.0 * y.coefficient(2, 0),
            aaa: 6.0 * y.coefficient(3, 0),
            ab: y.coefficient(1, 1),
            aab: 2.0 * y.coefficient(2, 1),
            abb: 2.0 * y.coefficient(1, 2),
        };
        Ok(self.evaluate(&x)?.iter().map(expansion).collect())
    }
}
