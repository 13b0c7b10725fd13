//! Robust fits and the covariance of their estimates.

use std::time::Instant;

use fmm_model::coverage_factor;

use crate::error::FitError;
use crate::fitting::solve::solve;
use crate::problem::residuals::Residuals;
use crate::result::fit::Fit;
use crate::robust::loss::Loss;
use crate::robust::m_covariance::m_covariance;
use crate::robust::problem::Robust;
use crate::solver::options::Options;

/// The median of |r| of normal residuals of unit variance is 1/1.4826.
const NORMAL: f64 = 1.482_602_218_505_602;
/// A residual this many robust standard deviations from zero is called an outlier.
const OUTLYING: f64 = 3.5;
/// Repetitions of fit and scale; they converge like a bisection or faster.
const REPETITIONS: usize = 50;

/// 1.4826 times the median of the magnitudes of the residuals, the standard deviation of their good ones if these
/// are normal; as `fitted` parameters make about as many residuals small, that many of the smallest are left out.
///
/// `None` if there are not more residuals than that.
///
/// # References
/// P. J. Rousseeuw, C. Croux, J. Am. Stat. Assoc. 88 (1993) 1273, <https://doi.org/10.1080/01621459.1993.10476408>.
pub fn median_deviation(residuals: &[f64], fitted: usize) -> Option<f64> {
    let mut magnitudes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
    magnitudes.sort_by(f64::total_cmp);
    let rest = magnitudes.get(fitted..).filter(|rest| !rest.is_empty())?;
    let (lower, upper) = (rest[(rest.len() - 1) / 2], rest[rest.len() / 2]);
    Some(NORMAL * (0.5 * lower + 0.5 * upper))
}

/// Fits `problem` by `loss` instead of squares, from `start`.
///
/// The `scale`, in the unit of the residuals, is up to about which size a residual counts as in least squares. Without
/// one it comes from the residuals: [`Loss::efficient_scale`] times their [`median_deviation`], with fit and scale
/// repeated until they agree. Residuals that are nearly all zero have no scale, which is an error.
///
/// A loss that forgets large residuals has no use for a start at which all are large. For `Cauchy`, `Arctan` and
/// `Tukey` a fit by `SoftL1`, of the same or of its own estimated scale, therefore goes first. The limits of the
/// options on iterations and evaluations hold for each fit, the one on time for all.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Loss, Options, Residuals, RobustFit, solve_robust};
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
/// // Readings of one length, in mm; the fifth was read wrongly.
/// let readings = [10.02, 9.98, 10.01, 9.97, 12.00, 10.03, 9.99];
/// let mean = Mean(&readings, [Parameter::new("length", "l", "mm")]);
/// let robust: RobustFit = solve_robust(&mean, &[10.0], Loss::Tukey, None, &Options::default())?;
/// assert_eq!(robust.outliers(), [4]);
/// assert_eq!(robust.weights()[4], 0.0);
/// let (lower, upper) = robust.interval("length", 0.95).unwrap();
/// assert!(lower < 10.0 && 10.0 < upper && upper - lower < 0.06);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// # Errors
/// [`FitError`] if the start, the problem, the options or the scale do not allow a fit to begin.
pub fn solve_robust<P: Residuals + ?Sized>(
    problem: &P,
    start: &[f64],
    loss: Loss,
    scale: Option<f64>,
    options: &Options,
) -> Result<RobustFit, FitError> {
    let search = Search { problem, options, began: Instant::now() };
    let forgets = matches!(loss, Loss::Cauchy | Loss::Arctan | Loss::Tukey);
    let mut fit = match scale {
        Some(scale) if forgets => {
            let first = search.once(start, Loss::SoftL1, scale)?;
            search.once(first.fit.values(), loss, scale)?
        }
        Some(scale) => search.once(start, loss, scale)?,
        None => {
            let mut residuals = vec![0.0; problem.len()];
            // A start without values is refused by name when the fit begins.
            let first =
                problem.evaluate(start, &mut residuals, None).ok().and_then(|()| median_deviation(&residuals, 0));
            let first = first.filter(|deviation| *deviation > 0.0 && deviation.is_finite()).unwrap_or(1.0);
            let convex = if forgets { Loss::SoftL1 } else { loss };
            let mut fit = search.repeated(start, convex, first)?;
            if forgets {
                fit = search.repeated(&fit.values, loss, fit.deviation)?;
            }
            search.once(&fit.values, loss, loss.efficient_scale() * fit.deviation)?
        }
    };
    for (estimate, value) in fit.fit.estimates_mut().iter_mut().zip(start) {
        estimate.start = *value;
    }
    Ok(fit)
}

struct Search<'a, P: ?Sized> {
    problem: &'a P,
    options: &'a Options,
    began: Instant,
}

/// End of the repetition of fit and scale.
struct Agreement {
    values: Vec<f64>,
    deviation: f64,
}

impl<P: Residuals + ?Sized> Search<'_, P> {
    fn once(&self, start: &[f64], loss: Loss, scale: f64) -> Result<RobustFit, FitError> {
        let robust = Robust::new(self.problem, loss, scale)?;
        let fit = solve(&robust, start, &self.options.remaining(self.began))?;
        RobustFit::new(&robust, fit)
    }

    /// Fits and scales in turn until the scale stands.
    fn repeated(&self, start: &[f64], loss: Loss, deviation: f64) -> Result<Agreement, FitError> {
        let mut agreement = Agreement { values: start.to_vec(), deviation };
        for _ in 0..REPETITIONS {
            let fit = self.once(&agreement.values, loss, loss.efficient_scale() * agreement.deviation)?;
            let deviation = median_deviation(&fit.residuals, fit.fit.rank()).unwrap_or(0.0);
            let change = (deviation / agreement.deviation - 1.0).abs();
            agreement = Agreement { values: fit.fit.values().to_vec(), deviation };
            let is_over = !fit.fit.outcome().is_success();
            if is_over || !(change > 1e-9) {
                break;
            }
        }
        Ok(agreement)
    }
}

/// The result of a robust fit.
///
/// | symbol | method | meaning |
/// |---|---|---|
/// | r | [`residuals`](Self::residuals) | residuals of the problem, not replaced |
/// | s | [`scale`](Self::scale) | scale of the loss |
/// | ρ′(r²/s²) | [`weights`](Self::weights) | how much of a residual counts, 0 to 1 |
/// | ½ s² Σ ρ | [`cost`](Self::cost) | half of the sum that was minimised |
/// | V | [`covariance`](Self::covariance) | covariance of the estimates |
///
/// # Uncertainty
/// ```text
/// V = B⁻¹ C B⁻¹,     B = Σ ψ′ᵢ Jᵢ Jᵢᵀ,     C = Σ (ψᵢ/(1 − hᵢ))² Jᵢ Jᵢᵀ
/// ψ = r ρ′(z),     z = r²/s²,     hᵢ = ψ′ᵢ Jᵢᵀ B⁻¹ Jᵢ
/// ```
///
/// This is the covariance of an M-estimate from the scatter of the residuals themselves; it asks of them
/// independence and symmetry but neither equal variance nor a normal distribution. The leverages hᵢ make it that of
/// the jackknife to first order. It does not know the curvature of the model and takes the scale as given. The
/// covariance of [`fit`](Self::fit), which treats the replaced residuals as a normal sample, is not the one to state:
/// it depends on how much the outliers are cut, not on what they do to the estimates.
///
/// Residuals that are outliers for a reason, all on one side, also shift the estimates; no covariance tells that.
///
/// # References
/// P. J. Huber, Proc. Fifth Berkeley Symp. 1 (1967) 221; J. G. MacKinnon, H. White, J. Econometrics 29 (1985) 305,
/// <https://doi.org/10.1016/0304-4076(85)90158-7> (leverages).
#[derive(Debug, Clone)]
pub struct RobustFit {
    fit: Fit,
    loss: Loss,
    scale: f64,
    residuals: Vec<f64>,
    weights: Vec<f64>,
    covariance: Vec<Option<f64>>,
}

impl RobustFit {
    fn new<P: Residuals>(problem: &Robust<P>, fit: Fit) -> Result<Self, FitError> {
        let mut residuals = vec![0.0; problem.len()];
        let asked = problem.problem().evaluate(fit.values(), &mut residuals, None);
        asked.map_err(|error| FitError::model_failed(error.into_boxed()))?;
        let weights = residuals.iter().map(|r| problem.loss().weight(problem.square(*r))).collect();
        let covariance = m_covariance(problem, &fit);
        Ok(Self { loss: problem.loss(), scale: problem.scale(), residuals, weights, covariance, fit })
    }

    /// The fit of the replaced residuals: values, outcome, rank. Not its covariance, see [above](Self#uncertainty).
    pub fn fit(&self) -> &Fit {
        &self.fit
    }

    /// The values found, one per parameter, each in the unit of the parameter.
    pub fn values(&self) -> &[f64] {
        self.fit.values()
    }

    /// The loss.
    pub fn loss(&self) -> Loss {
        self.loss
    }

    /// The scale of the loss, given or found, in the unit of the residuals.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// ½ s² Σ ρ(rᵢ²/s²), the cost as SciPy's `least_squares` states it.
    pub fn cost(&self) -> f64 {
        0.5 * self.fit.sum_of_squares()
    }

    /// The residuals of the problem itself.
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// The weight of each residual, 0 to 1: least squares with these weights has the same minimum.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The robust standard deviation of the residuals, see [`median_deviation`].
    pub fn deviation(&self) -> Option<f64> {
        median_deviation(&self.residuals, self.fit.rank())
    }

    /// Indices of the residuals further than 3.5 robust standard deviations from zero.
    ///
    /// Of a thousand normal residuals half a one is that far out.
    pub fn outliers(&self) -> Vec<usize> {
        let limit = self.deviation().map_or(f64::INFINITY, |deviation| OUTLYING * deviation);
        (0..self.residuals.len()).filter(|&i| self.residuals[i].abs() > limit).collect()
    }

    /// Covariance of the estimates of parameters `i` and `j`, in the product of their units; `None` where a parameter
    /// is fixed, at a bound or not determined, without a degree of freedom, where the slopes ψ′ show no minimum, or
    /// where the fit would go elsewhere without one of the residuals (hᵢ ≥ 1), which happens in small samples to losses
    /// that forget.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        self.fit.element(&self.covariance, i, j)
    }

    /// Standard uncertainty of the estimate of parameter `i`, in its unit.
    pub fn standard_uncertainty(&self, i: usize) -> Option<f64> {
        self.covariance(i, i).map(f64::sqrt)
    }

    /// The interval that covers the parameter called `name` with probability `level`, by Student's t with n − rank
    /// degrees of freedom; `None` for an unknown name, a level outside (0, 1) or an estimate without an uncertainty.
    pub fn interval(&self, name: &str, level: f64) -> Option<(f64, f64)> {
        let index = self.fit.estimates().iter().position(|estimate| estimate.name() == name)?;
        let uncertainty = self.standard_uncertainty(index)?;
        let reach = coverage_factor(level, self.fit.degrees_of_freedom() as f64)? * uncertainty;
        let value = self.fit.values()[index];
        Some((value - reach, value + reach))
    }
}
