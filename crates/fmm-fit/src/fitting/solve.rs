//! Fit of a problem in one call.

use std::ops::ControlFlow;

use crate::error::FitError;
use crate::problem::residuals::Residuals;
use crate::result::fit::Fit;
use crate::solver::jacobian_check::check_jacobian;
use crate::solver::minimizer::Minimizer;
use crate::solver::options::Options;

/// Fits `problem` from `start`, one value per parameter within its bounds.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Options, Residuals, solve};
/// use fmm_model::{Bounds, Parameter};
///
/// # struct Decay { t: Vec<f64>, y: Vec<f64>, parameters: [Parameter; 2] }
/// # impl Residuals for Decay {
/// #     fn parameters(&self) -> &[Parameter] { &self.parameters }
/// #     fn len(&self) -> usize { self.t.len() }
/// #     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
/// #         for ((r, t), y) in residuals.iter_mut().zip(&self.t).zip(&self.y) {
/// #             *r = p[0] * (-p[1] * t).exp() - y;
/// #         }
/// #         Ok(())
/// #     }
/// # }
/// let t: Vec<f64> = (0..50).map(|i| 0.1 * f64::from(i)).collect();
/// let y = t.iter().map(|t| 2.0 * (-0.8 * t).exp()).collect();
/// let amplitude = Parameter::new("amplitude", "a", "m").bounded(Bounds::NOT_NEGATIVE);
/// let problem = Decay { t, y, parameters: [amplitude, Parameter::new("rate", "b", "1/s")] };
///
/// let fit = solve(&problem, &[1.0, 0.1], &Options::default())?;
/// assert!(fit.outcome().is_success());
/// assert!((fit.estimate("rate").unwrap().value() - 0.8).abs() < 1e-9);
/// assert_eq!(fit.rank(), 2);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// # Errors
/// [`FitError`] if the start, the problem or the options do not allow a fit to begin.
pub fn solve<P: Residuals + ?Sized>(problem: &P, start: &[f64], options: &Options) -> Result<Fit, FitError> {
    solve_observed(problem, start, options, |_| ControlFlow::Continue(()))
}

/// [`solve`] with an `observer` that gets the solver after every trial step; `Break` ends the fit as
/// [`Outcome::Cancelled`](crate::Outcome::Cancelled) with the best values so far.
///
/// # Errors
/// Those of [`solve`].
pub fn solve_observed<P: Residuals + ?Sized>(
    problem: &P,
    start: &[f64],
    options: &Options,
    mut observer: impl FnMut(&Minimizer) -> ControlFlow<()>,
) -> Result<Fit, FitError> {
    let mut minimizer = Minimizer::new(options.clone());
    // Before the fit has its own buffers.
    let mismatches = if options.jacobian_check { check_jacobian(problem, start)? } else { Vec::new() };
    minimizer.begin(problem, start)?;
    minimizer.mismatches = mismatches;
    let mut outcome = minimizer.outcome();
    while outcome.is_none() {
        outcome = minimizer.iterate(problem);
        if observer(&minimizer).is_break() && outcome.is_none() {
            outcome = Some(minimizer.cancel(problem));
        }
    }
    Ok(minimizer.into_fit())
}
