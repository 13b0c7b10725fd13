//! Changes of the residuals that the parameters of a fit can follow.

use fmm_fit::Fit;

use crate::linear_algebra::Span;
use crate::problem::Problem;

/// The derivatives of all residuals by the parameters that a fit determines, those on a bound included.
#[derive(Debug, Clone)]
pub(crate) struct Tangent {
    /// Places of these parameters among all.
    known: Vec<usize>,
    pub(crate) span: Span,
}

impl Tangent {
    /// Tangent of a `fit` to `problem`; `None` if the derivatives cannot be had.
    pub(crate) fn of(problem: &Problem<'_>, fit: &Fit) -> Option<Self> {
        let known: Vec<usize> = (0..fit.values().len()).filter(|i| fit.relaxed_covariance(*i, *i).is_some()).collect();
        let span = Span::of(problem.columns(fit.values(), &known).ok()?);
        Some(Self { known, span })
    }

    /// Change of the parameter at place `index` among all, 0 if the fit does not determine it.
    pub(crate) fn step(&self, index: usize, direction: &[f64]) -> f64 {
        let place = self.known.iter().position(|known| *known == index);
        place.map_or(0.0, |place| self.span.steps(direction)[place])
    }
}
