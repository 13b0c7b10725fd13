//! Changes of the residuals that the parameters of a fit can follow.

use fmm_fit::Fit;

use crate::linear_algebra::Span;
use crate::problem::Problem;

/// The derivatives of all residuals by the parameters that a fit determines, those on a bound included.
#[derive(Debug, Clone)]
pub(crate) struct Tangent {
    /// Places of these parameters among all.
    known: Vec<usize>,
    /// Number of all.
    parameters: usize,
    pub(crate) span: Span,
}

impl Tangent {
    /// Tangent of a `fit` to `problem`; `None` if the derivatives cannot be had.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit) -> Option<Self> {
        let known: Vec<usize> = (0..fit.values().len()).filter(|i| fit.relaxed_covariance(*i, *i).is_some()).collect();
        let span = Span::of(problem.columns(fit.values(), &known).ok()?);
        Some(Self { known, parameters: fit.values().len(), span })
    }

    /// Changes of all parameters along the `direction`, 0 for those that the fit does not determine.
    pub(crate) fn all_steps(&self, direction: &[f64]) -> Vec<f64> {
        let mut steps = vec![0.0; self.parameters];
        for (known, step) in self.known.iter().zip(self.span.steps(direction)) {
            steps[*known] = step;
        }
        steps
    }

    /// Change of the parameter at place `index` among all, 0 if the fit does not determine it.
    pub(crate) fn step(&self, index: usize, direction: &[f64]) -> f64 {
        self.all_steps(direction)[index]
    }
}
