//! The result of a fit.

use fmm_model::{Parameter, coverage_factor};

use crate::algebra::spectrum::Spectrum;
use crate::algebra::triangle::Triangle;
use crate::error::FitError;
use crate::problem::residuals::Residuals;
use crate::result::estimate::{Estimate, EstimateStatus};
use crate::result::null_direction::{NullDirection, null_directions};
use crate::solver::evaluation::Scheme;
use crate::solver::jacobian_check::JacobianMismatch;
use crate::solver::minimizer::{Minimizer, Phase};
use crate::solver::outcome::{NonFinite, Outcome};

/// The result of a fit: estimates, their uncertainty, and what the residuals could not tell.
///
/// ```text
/// s² = S/ν,    ν = n − rank,    V = s² (Jᵀ J)⁺         on the parameters that are neither fixed nor at a bound
/// ```
///
/// | symbol | method | meaning |
/// |---|---|---|
/// | S | [`sum_of_squares`](Self::sum_of_squares) | Σᵢ rᵢ² |
/// | n | `residuals().len()` | number of residuals |
/// | rank | [`rank`](Self::rank) | number of independent directions that the residuals determine |
/// | ν | [`degrees_of_freedom`](Self::degrees_of_freedom) | residuals left over |
/// | s | [`residual_standard_deviation`](Self::residual_standard_deviation) | |
/// | V | [`covariance`](Self::covariance) | none where a parameter is not determined |
///
/// The covariance holds for independent residuals of equal variance and a model that is straight within a few
/// standard uncertainties. Residuals that are sampled fast are seldom independent: see
/// [`effective_count`](crate::effective_count).
///
/// `Display` gives the report.
#[derive(Debug, Clone)]
pub struct Fit {
    outcome: Outcome,
    estimates: Vec<Estimate>,
    values: Vec<f64>,
    residuals: Vec<f64>,
    sum_of_squares: f64,
    free_count: usize,
    rank: usize,
    singular_values: Vec<f64>,
    null_directions: Vec<NullDirection>,
    unit_covariance: Vec<Option<f64>>,
    relaxed_unit_covariance: Option<Vec<Option<f64>>>,
    iterations: usize,
    residual_evaluations: usize,
    jacobian_evaluations: usize,
    has_exact_jacobian: bool,
    non_finite: Option<NonFinite>,
    jacobian_mismatches: Vec<JacobianMismatch>,
}

impl Minimizer {
    /// The result with uncertainties and rank; a fit that was interrupted counts as cancelled.
    ///
    /// # Errors
    /// [`FitError::NotStarted`] before the first fit.
    pub fn fit(&self) -> Result<Fit, FitError> {
        if matches!(self.phase, Phase::Idle) {
            return Err(FitError::NotStarted);
        }
        Ok(Fit::new(self, self.current.residuals.clone()))
    }

    pub(crate) fn into_fit(mut self) -> Fit {
        let residuals = std::mem::take(&mut self.current.residuals);
        Fit::new(&self, residuals)
    }
}

impl Fit {
    pub(crate) fn new(minimizer: &Minimizer, residuals: Vec<f64>) -> Self {
        let mut estimates = estimates(minimizer);
        let values = minimizer.values().to_vec();
        let free = minimizer.free();
        let inside: Vec<usize> = (0..free.len()).filter(|&c| !estimates[free[c]].status.is_at_bound()).collect();
        let columns: Vec<usize> = inside.iter().map(|&column| free[column]).collect();
        let spectrum_of = |columns: &[usize]| {
            let (whole, mut triangle) = (minimizer.factor_of_jacobian(), Triangle::default());
            triangle.select(whole, columns, |row| whole.q(row), &mut Vec::new());
            Spectrum::of(&triangle)
        };
        let spectrum = spectrum_of(&inside);
        let threshold = minimizer.scheme().rank_threshold(residuals.len());
        let rank = spectrum.rank(threshold);
        let noise = threshold.sqrt().max(1e-6);
        let names: Vec<&str> = estimates.iter().map(Estimate::name).collect();
        let null = &spectrum.right[rank..];
        let null_directions = null_directions(null, &columns, &spectrum.scales, &values, &names, noise);
        for (i, &j) in columns.iter().enumerate() {
            let share = null.iter().map(|vector| vector[i] * vector[i]).sum::<f64>().sqrt();
            if share > noise {
                estimates[j].status = EstimateStatus::Undetermined;
            }
        }
        let sum_of_squares = minimizer.sum_of_squares();
        let unit_covariance = self::unit_covariance(&spectrum, rank, &columns, estimates.len(), |j| {
            estimates[j].status == EstimateStatus::Determined
        });
        let relaxed_unit_covariance = if inside.len() == free.len() {
            None
        } else {
            let spectrum = spectrum_of(&(0..free.len()).collect::<Vec<_>>());
            let rank = spectrum.rank(threshold);
            (rank == free.len()).then(|| self::unit_covariance(&spectrum, rank, free, estimates.len(), |_| true))
        };
        let mut fit = Self {
            outcome: minimizer.outcome().unwrap_or(Outcome::Cancelled),
            estimates,
            values,
            residuals,
            sum_of_squares,
            free_count: free.len(),
            rank,
            singular_values: spectrum.singular,
            null_directions,
            unit_covariance,
            relaxed_unit_covariance,
            iterations: minimizer.iterations(),
            residual_evaluations: minimizer.residual_evaluations(),
            jacobian_evaluations: minimizer.jacobian_evaluations(),
            has_exact_jacobian: minimizer.scheme() == Scheme::Exact,
            non_finite: minimizer.non_finite().cloned(),
            jacobian_mismatches: minimizer.mismatches.clone(),
        };
        for j in 0..fit.estimates.len() {
            fit.estimates[j].standard_uncertainty = fit.covariance(j, j).map(f64::sqrt);
        }
        fit
    }

    /// The end of the fit.
    pub fn outcome(&self) -> Outcome {
        self.outcome
    }

    /// One estimate per parameter, in the order of the problem.
    pub fn estimates(&self) -> &[Estimate] {
        &self.estimates
    }

    /// Element (i, j) of a matrix with a row and a column for each parameter.
    pub(crate) fn element(&self, matrix: &[Option<f64>], i: usize, j: usize) -> Option<f64> {
        let count = self.estimates.len();
        if i < count && j < count { matrix[i * count + j] } else { None }
    }

    /// An error unless this fit has the size of one of `problem`.
    pub(crate) fn require_of<P: Residuals + ?Sized>(&self, problem: &P) -> Result<(), FitError> {
        let sizes = ((self.residuals.len(), self.values.len()), (problem.len(), problem.parameters().len()));
        if sizes.0 == sizes.1 {
            return Ok(());
        }
        let (fit, problem) = sizes;
        let what = format!(
            "the fit has {fit:?} residuals and parameters, but the problem {problem:?}; it must be that of the problem"
        );
        Err(FitError::OtherFit { what })
    }

    pub(crate) fn estimates_mut(&mut self) -> &mut [Estimate] {
        &mut self.estimates
    }

    /// The estimate of the parameter called `name`.
    pub fn estimate(&self, name: &str) -> Option<&Estimate> {
        self.estimates.iter().find(|estimate| estimate.name() == name)
    }

    /// The values found, one per parameter, each in the unit of the parameter.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The residuals at these values.
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// S = Σᵢ rᵢ².
    pub fn sum_of_squares(&self) -> f64 {
        self.sum_of_squares
    }

    /// ν = n − rank. Fixed parameters, parameters at a bound and directions that the residuals do not determine
    /// cost no degree of freedom.
    pub fn degrees_of_freedom(&self) -> usize {
        self.residuals.len() - self.rank
    }

    /// s = √(S/ν), standard deviation of a residual; `None` without a degree of freedom.
    pub fn residual_standard_deviation(&self) -> Option<f64> {
        let freedom = self.degrees_of_freedom();
        (freedom > 0).then(|| (self.sum_of_squares / freedom as f64).sqrt())
    }

    /// Number of parameters that are not fixed.
    pub fn free_count(&self) -> usize {
        self.free_count
    }

    /// Number of independent directions that the residuals determine, of the parameters neither fixed nor at a bound.
    ///
    /// A direction counts if its singular value exceeds the largest by a factor of n ε, or of the error of the
    /// differences, 1e-6 or 1e-9, if the problem gives no derivatives.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Singular values, descending, of the Jacobian with its columns scaled to unit length, over the parameters
    /// neither fixed nor at a bound.
    pub fn singular_values(&self) -> &[f64] {
        &self.singular_values
    }

    /// The directions that the residuals do not see; empty if all is determined.
    pub fn null_directions(&self) -> &[NullDirection] {
        &self.null_directions
    }

    /// Covariance of the estimates of parameters `i` and `j`, in the product of their units; `None` if either is
    /// fixed, at a bound or not determined, or without a degree of freedom.
    pub fn covariance(&self, i: usize, j: usize) -> Option<f64> {
        Some(self.residual_standard_deviation()?.powi(2) * self.unit_covariance(i, j)?)
    }

    /// [`covariance`](Self::covariance) for residuals of variance 1, ((Jᵀ J)⁺)ᵢⱼ: what holds if each residual was
    /// divided by its standard uncertainty, and a factor in the response of the estimates to any other change of the
    /// residuals. Needs no degree of freedom.
    pub fn unit_covariance(&self, i: usize, j: usize) -> Option<f64> {
        self.element(&self.unit_covariance, i, j)
    }

    /// Covariance of the estimates of parameters `i` and `j` as if the bounds that values lie on were not there.
    ///
    /// A parameter that ends on its bound is not known to be there: it could be off it by its own uncertainty and
    /// take the others along. [`covariance`](Self::covariance) is that of the others for the bound itself; this is the
    /// larger one to state for them. The two are the same if no value is at a bound; none also if the directions are
    /// then not all determined.
    pub fn relaxed_covariance(&self, i: usize, j: usize) -> Option<f64> {
        let Some(relaxed) = &self.relaxed_unit_covariance else { return self.covariance(i, j) };
        Some(self.residual_standard_deviation()?.powi(2) * self.element(relaxed, i, j)?)
    }

    /// Correlation coefficient of the estimates of parameters `i` and `j`; `None` where there is no covariance or no
    /// variance.
    pub fn correlation(&self, i: usize, j: usize) -> Option<f64> {
        let variances = self.covariance(i, i)? * self.covariance(j, j)?;
        (variances > 0.0).then_some(self.covariance(i, j)? / variances.sqrt())
    }

    /// The interval that covers the parameter called `name` with probability `level`, by Student's t.
    ///
    /// ```text
    /// θ ± t_{(1 + level)/2, ν} u(θ)
    /// ```
    ///
    /// `None` for an unknown name, a level outside (0, 1), or an estimate without an uncertainty. The bounds of the
    /// parameter do not cut the interval.
    pub fn interval(&self, name: &str, level: f64) -> Option<(f64, f64)> {
        self.estimates.iter().position(|estimate| estimate.name() == name).and_then(|j| self.interval_of(j, level))
    }

    /// [`interval`](Self::interval) for the parameter at `index`.
    pub fn interval_of(&self, index: usize, level: f64) -> Option<(f64, f64)> {
        let estimate = self.estimates.get(index)?;
        let uncertainty = estimate.standard_uncertainty?;
        let reach = coverage_factor(level, self.degrees_of_freedom() as f64)? * uncertainty;
        Some((estimate.value - reach, estimate.value + reach))
    }

    /// Trial steps taken, accepted or not.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Evaluations of the residuals, those for differences included.
    pub fn residual_evaluations(&self) -> usize {
        self.residual_evaluations
    }

    /// Evaluations of the Jacobian by the problem itself.
    pub fn jacobian_evaluations(&self) -> usize {
        self.jacobian_evaluations
    }

    /// True if the problem gave its derivatives; otherwise differences were taken.
    pub fn has_exact_jacobian(&self) -> bool {
        self.has_exact_jacobian
    }

    /// Derivatives of the problem that disagree with differences at the start, if that was
    /// [looked at](crate::Options::with_jacobian_check).
    pub fn jacobian_mismatches(&self) -> &[JacobianMismatch] {
        &self.jacobian_mismatches
    }

    /// The number that was not finite at the last trial point that was given up for this; `None` if all were. It ended
    /// a fit with [`Outcome::NonFinite`].
    pub fn non_finite(&self) -> Option<&NonFinite> {
        self.non_finite.as_ref()
    }
}

fn estimates(minimizer: &Minimizer) -> Vec<Estimate> {
    let estimate = |(j, parameter): (usize, &Parameter)| {
        let (value, bounds) = (minimizer.values()[j], parameter.bounds());
        let status = if bounds.is_fixed() {
            EstimateStatus::Fixed
        } else if value == bounds.lower() {
            EstimateStatus::AtLowerBound
        } else if value == bounds.upper() {
            EstimateStatus::AtUpperBound
        } else {
            EstimateStatus::Determined
        };
        let column = minimizer.free().iter().position(|&free| free == j);
        Estimate {
            parameter: parameter.clone(),
            value,
            start: minimizer.start()[j],
            status,
            standard_uncertainty: None,
            multiplier: column.filter(|_| status.is_at_bound()).map(|c| minimizer.factor_of_jacobian().gradient(c)),
        }
    };
    minimizer.parameters().iter().enumerate().map(estimate).collect()
}

/// `S⁻¹ V Σ⁻² Vᵀ S⁻¹` over the determined ones among `columns`, as a square matrix over all `count` parameters.
fn unit_covariance(
    spectrum: &Spectrum,
    rank: usize,
    columns: &[usize],
    count: usize,
    is_determined: impl Fn(usize) -> bool,
) -> Vec<Option<f64>> {
    let mut matrix = vec![None; count * count];
    for (a, &i) in columns.iter().enumerate().filter(|(_, i)| is_determined(**i)) {
        for (b, &j) in columns.iter().enumerate().filter(|(_, j)| is_determined(**j)) {
            let along = spectrum.right.iter().zip(&spectrum.singular).take(rank);
            let sum: f64 = along.map(|(v, singular)| (v[a] / singular) * (v[b] / singular)).sum();
            matrix[i * count + j] = Some(sum / (spectrum.scales[a] * spectrum.scales[b]));
        }
    }
    matrix
}
