//! A problem whose residuals have different uncertainties.

use fmm_model::Parameter;

use crate::error::FitError;
use crate::problem::block::{Block, scale_rows};
use crate::problem::residuals::{EvaluationError, Residuals, forward_shape};

/// A problem whose residuals are divided by their standard uncertainties.
///
/// ```text
/// r̃ᵢ = rᵢ/uᵢ
/// ```
///
/// With uncertainties that are known, the covariance of the estimates is [`Fit::unit_covariance`] and S should be
/// about its degrees of freedom. With uncertainties known up to a common factor it is [`Fit::covariance`], which
/// takes that factor from the residuals.
///
/// [`Fit::unit_covariance`]: crate::Fit::unit_covariance
/// [`Fit::covariance`]: crate::Fit::covariance
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Options, Residuals, Weighted, solve};
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
/// // Two readings, 10.0 ± 0.1 and 10.5 ± 0.2.
/// let mean = Mean(&[10.0, 10.5], [Parameter::new("length", "l", "mm")]);
/// let fit = solve(&Weighted::new(mean, vec![0.1, 0.2])?, &[10.0], &Options::default())?;
/// assert!((fit.values()[0] - 10.1).abs() < 1e-9);
/// // 1/u² = 1/0.1² + 1/0.2² = 125.
/// assert!((fit.unit_covariance(0, 0).unwrap() - 1.0 / 125.0).abs() < 1e-12);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Weighted<P> {
    problem: P,
    uncertainties: Vec<f64>,
}

impl<P: Residuals> Weighted<P> {
    /// Gives the residuals of `problem` the standard `uncertainties`, one each, in the unit of the residuals.
    ///
    /// # Errors
    /// [`FitError::Count`] unless there is one per residual; [`FitError::OutOfRange`] unless all are
    /// positive and finite.
    pub fn new(problem: P, uncertainties: Vec<f64>) -> Result<Self, FitError> {
        if uncertainties.len() != problem.len() {
            let (uncertainties, residuals) = (uncertainties.len(), problem.len());
            return Err(FitError::count(format!(
                "{uncertainties} standard uncertainties were given for {residuals} residuals; give one for each"
            )));
        }
        // The inverse of a subnormal number overflows.
        let bad = uncertainties.iter().position(|u| !(*u > 0.0 && u.is_finite() && u.recip().is_finite()));
        match bad {
            Some(index) => Err(bad_uncertainty("residual", index, uncertainties[index])),
            None => Ok(Self { problem, uncertainties }),
        }
    }

    /// Divides residuals, the first of which is that of `row`.
    fn divide(&self, row: usize, residuals: &mut [f64]) {
        for (residual, uncertainty) in residuals.iter_mut().zip(&self.uncertainties[row..]) {
            *residual /= uncertainty;
        }
    }
}

/// The standard uncertainty of the `index`-th residual or observation cannot be divided by.
pub(crate) fn bad_uncertainty(of: &str, index: usize, value: f64) -> FitError {
    FitError::option(&format!("the standard uncertainty of {of} {index}"), "positive and finite", value)
}

impl<P: Residuals> Residuals for Weighted<P> {
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
        self.divide(0, residuals);
        if let Some(jacobian) = jacobian {
            let factors: Vec<f64> = self.uncertainties.iter().map(|uncertainty| uncertainty.recip()).collect();
            scale_rows(&self.problem, jacobian, &factors);
        }
        Ok(())
    }
    fn block_residuals(&self, block: usize, p: &[f64], residuals: &mut [f64]) -> Result<bool, EvaluationError> {
        let has_blocks = self.problem.block_residuals(block, p, residuals)?;
        if has_blocks {
            self.divide(self.blocks()[..block].iter().map(Block::rows).sum(), residuals);
        }
        Ok(has_blocks)
    }
}
