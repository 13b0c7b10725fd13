//! A problem whose large residuals count less than their squares.

use fmm_model::Parameter;

use crate::error::FitError;
use crate::problem::block::scale_rows;
use crate::problem::residuals::{EvaluationError, Residuals, forward_shape};
use crate::robust::loss::Loss;

/// Residuals this many scales away and more count alike, so that their squares stay finite.
const FAR: f64 = 1e150;

/// A problem whose residuals are replaced so that the plain sum of squares is the robust cost.
///
/// ```text
/// r̃ = r √(ρ(z)/z),     z = (r/s)²,     Σ r̃² = s² Σ ρ(z)
/// ∂r̃/∂r = ρ′(z)/√(ρ(z)/z)
/// ```
///
/// Nothing is approximated, and everything that takes a problem takes this one: bounds, observers, multi-start,
/// argmin. SciPy's `least_squares` states half of the sum as its cost.
///
/// The covariance of a fit to it is *not* that of the estimates: `Fit::covariance` would be right if the replaced
/// residuals were a normal sample, which they are not. [`solve_robust`](crate::solve_robust)
/// fits and states the covariance that holds.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Loss, Options, Residuals, Robust, solve};
/// # use fmm_model::Parameter;
///
/// # struct Mean<'a>(&'a [f64], [Parameter; 1]);
/// # impl Residuals for Mean<'_> {
/// #     fn parameters(&self) -> &[Parameter] { &self.1 }
/// #     fn len(&self) -> usize { self.0.len() }
/// #     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
/// #         residuals.iter_mut().zip(self.0).for_each(|(r, y)| *r = p[0] - y);
/// #         Ok(())
/// #     }
/// # }
/// // The mean of five readings, one of them wrong.
/// let mean = Mean(&[1.0, 1.1, 0.9, 1.05, 8.0], [Parameter::new("mean", "a", "1")]);
/// let robust = Robust::new(mean, Loss::Tukey, 1.0)?;
/// let fit = solve(&robust, &[1.5], &Options::default())?;
/// assert!((fit.values()[0] - 1.0125).abs() < 1e-3);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Robust<P> {
    problem: P,
    loss: Loss,
    scale: f64,
}

impl<P: Residuals> Robust<P> {
    /// Lets the residuals of `problem` count by `loss`, whose `scale` has their unit.
    ///
    /// # Errors
    /// [`FitError::OutOfRange`] unless the scale is positive and finite.
    pub fn new(problem: P, loss: Loss, scale: f64) -> Result<Self, FitError> {
        if scale > 0.0 && scale.is_finite() {
            Ok(Self { problem, loss, scale })
        } else {
            Err(FitError::option("the option scale of the loss", "positive and finite", scale))
        }
    }

    /// The problem with its own residuals.
    pub fn problem(&self) -> &P {
        &self.problem
    }

    /// The loss.
    pub fn loss(&self) -> Loss {
        self.loss
    }

    /// The scale s, in the unit of the residuals.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// z = (r/s)².
    pub(crate) fn square(&self, residual: f64) -> f64 {
        (residual / self.scale).clamp(-FAR, FAR).powi(2)
    }

    fn replaced(&self, residual: f64) -> f64 {
        // Residuals that are not finite pass unchanged: clamping would hide them.
        if !residual.is_finite() || self.loss == Loss::Squares {
            return residual;
        }
        self.scale * (residual / self.scale).clamp(-FAR, FAR) * self.loss.share(self.square(residual)).sqrt()
    }

    /// Replaces `residuals` and scales the rows of `jacobian` accordingly.
    pub(crate) fn replace(&self, residuals: &mut [f64], jacobian: Option<&mut [f64]>) {
        if let Some(jacobian) = jacobian
            && !residuals.is_empty()
        {
            let factors: Vec<f64> = residuals.iter().map(|r| self.factor(*r)).collect();
            scale_rows(&self.problem, jacobian, &factors);
        }
        for r in residuals {
            *r = self.replaced(*r);
        }
    }

    /// `∂r̃/∂r`.
    fn factor(&self, residual: f64) -> f64 {
        let z = self.square(residual);
        self.loss.weight(z) / self.loss.share(z).sqrt()
    }
}

impl<P: Residuals> Residuals for Robust<P> {
    forward_shape!(self => self.problem);
    fn parameters(&self) -> &[Parameter] {
        self.problem.parameters()
    }
    fn evaluate(
        &self,
        p: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) -> Result<(), EvaluationError> {
        self.problem.evaluate(p, residuals, jacobian.as_deref_mut())?;
        self.replace(residuals, jacobian);
        Ok(())
    }
    fn block_residuals(&self, block: usize, p: &[f64], residuals: &mut [f64]) -> Result<bool, EvaluationError> {
        let has_blocks = self.problem.block_residuals(block, p, residuals)?;
        if has_blocks {
            self.replace(residuals, None);
        }
        Ok(has_blocks)
    }
}
