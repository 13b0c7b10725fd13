//! A problem with one parameter held.

use fmm_model::{Bounds, Parameter};

use crate::{Block, EvaluationError, Residuals};

/// A problem whose parameter at `index` is held at a value.
#[derive(Debug)]
pub(crate) struct Held<'a, P: ?Sized> {
    problem: &'a P,
    parameters: Vec<Parameter>,
}

impl<'a, P: Residuals + ?Sized> Held<'a, P> {
    /// None if the value is not finite.
    pub(crate) fn new(problem: &'a P, index: usize, value: f64) -> Option<Self> {
        let held = Bounds::new(value, value).ok()?;
        let mut parameters = problem.parameters().to_vec();
        let parameter = parameters.get_mut(index)?;
        *parameter = parameter.clone().bounded(held);
        Some(Self { problem, parameters })
    }
}

impl<P: Residuals + ?Sized> Residuals for Held<'_, P> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.problem.len()
    }
    fn residuals(&self, p: &[f64], residuals: &mut [f64]) -> Result<(), EvaluationError> {
        self.problem.residuals(p, residuals)
    }
    fn jacobian(&self, p: &[f64], jacobian: &mut [f64]) -> Result<bool, EvaluationError> {
        self.problem.jacobian(p, jacobian)
    }
    fn residuals_and_jacobian(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<bool, EvaluationError> {
        self.problem.residuals_and_jacobian(p, residuals, jacobian)
    }
    fn is_cheaper_combined(&self) -> bool {
        self.problem.is_cheaper_combined()
    }
    fn blocks(&self) -> &[Block] {
        self.problem.blocks()
    }
    fn block_residuals(&self, block: usize, p: &[f64], residuals: &mut [f64]) -> Result<bool, EvaluationError> {
        self.problem.block_residuals(block, p, residuals)
    }
    fn fills_fixed_columns(&self) -> bool {
        self.problem.fills_fixed_columns()
    }
}
