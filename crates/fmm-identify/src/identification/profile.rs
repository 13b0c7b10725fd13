//! Profiles of the fitted quantities: how far value ± k u is the truth about each.

use fmm_fit::{EstimateStatus, FitError, Options, ProfileEnd, ProfileInterval, ResidualVariance};
use fmm_model::Parameter;

use crate::error::IdentifyError;
use crate::experiment::Experiment;
use crate::identification::Identification;
use crate::problem::Problem;

/// The sum of squares along one fitted quantity, all others fitted anew, beside what its standard uncertainty says of
/// it.
///
/// Both speak of the residuals alone, with the noise that they show, and not of what else makes the
/// [finding](crate::Finding) uncertain: gains, inputs, other laws.
#[derive(Debug, Clone)]
pub struct Profile {
    parameter: Parameter,
    value: f64,
    /// V, by the residuals.
    variance: f64,
    interval: ProfileInterval,
    curve: Vec<(f64, f64)>,
}

/// Difference of the profile from value ± k u, as a share of the half width of the interval, from which on a quantity
/// counts as bent (1).
const BENT: f64 = 0.1;
/// Steps of a curve on either side of the estimate.
const STEPS: usize = 8;
/// Evaluations of the motion for all profiles of one identification together, those with derivatives included.
const MOST_EVALUATIONS: usize = 2000;

impl Profile {
    /// Name, symbol and unit.
    pub fn parameter(&self) -> &Parameter {
        &self.parameter
    }

    /// The estimate, in the unit of the parameter.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The interval by the profile, in the unit of the parameter.
    pub fn interval(&self) -> &ProfileInterval {
        &self.interval
    }

    /// The interval value ± k u, in the unit of the parameter, as far as its bounds allow.
    pub fn straight(&self) -> (f64, f64) {
        let (reach, bounds) = (self.reach(), self.parameter.bounds());
        (bounds.clamp(self.value - reach), bounds.clamp(self.value + reach))
    }

    /// k u.
    fn reach(&self) -> f64 {
        (self.interval.threshold() * self.variance).sqrt()
    }

    /// The share of k u by which the end that differs most does so (1); infinite if a side ends at a bound, at the edge
    /// of the model, or not at all.
    pub fn bend(&self) -> f64 {
        let of_end = |end: ProfileEnd| match end {
            ProfileEnd::At(value) => ((value - self.value).abs() / self.reach() - 1.0).abs(),
            _ => f64::INFINITY,
        };
        of_end(self.interval.lower()).max(of_end(self.interval.upper()))
    }

    /// True if value ± k u misleads: the [bend](Self::bend) is above [`Profiles::BENT`].
    pub fn is_bent(&self) -> bool {
        !(self.bend() <= BENT)
    }

    /// The profile to be drawn: values of the parameter, ascending, and the rise (S_k − S_min)/s² of the sum of squares
    /// there (1), which is [`ProfileInterval::threshold`] at the ends. Empty where nothing is bent.
    pub fn curve(&self) -> &[(f64, f64)] {
        &self.curve
    }

    /// The same rise by value ± k u: (θ − θ̂)²/V (1).
    pub fn parabola(&self, value: f64) -> f64 {
        (value - self.value).powi(2) / self.variance
    }
}

/// The profiles of one identification.
#[derive(Debug)]
pub struct Profiles {
    computed: Vec<Profile>,
    left_out: Vec<(Parameter, FitError)>,
    residual_evaluations: usize,
}

impl Profiles {
    /// The bend from which on a curve is computed (1).
    pub const BENT: f64 = BENT;
    /// After so many evaluations of the motion the profiles that are left are left out.
    pub const MOST_EVALUATIONS: usize = MOST_EVALUATIONS;

    /// One for each quantity that all records share and that has a variance, as if its bound were not there.
    pub fn profiles(&self) -> &[Profile] {
        &self.computed
    }

    /// The quantities of which there is none, and why.
    pub fn left_out(&self) -> &[(Parameter, FitError)] {
        &self.left_out
    }

    /// Evaluations of the motion that all of them took.
    pub fn residual_evaluations(&self) -> usize {
        self.residual_evaluations
    }
}

impl Identification {
    /// The profiles of what was fitted to `decays`, which must be those of the identification, for intervals that cover
    /// with probability `level`. None without noise.
    ///
    /// A profile costs about thirty evaluations of the motion with its derivatives, and as many again if it is bent.
    /// After [`Profiles::MOST_EVALUATIONS`] the rest is left out.
    ///
    /// Where residuals are correlated the sum of squares counts for as much as the standard uncertainty says: its rise
    /// is divided by V/C, the variance V of the quantity over that by residuals of unit variance.
    ///
    /// # Errors
    /// [`IdentifyError::WrongRecord`] for other records than those of the identification.
    ///
    /// # References
    /// R. E. Chandler, S. Bate, "Inference for clustered data using the independence loglikelihood", Biometrika 94
    /// (2007) 167, <https://doi.org/10.1093/biomet/asm015>; D. M. Bates, D. G. Watts, "Nonlinear Regression Analysis
    /// and Its Applications", Wiley (1988), ch. 6.
    pub fn profiles(&self, decays: &[Experiment], level: f64) -> Result<Profiles, IdentifyError> {
        let decays = self.experiments(decays)?;
        let problem = self.problem(&decays)?;
        let mut found = Profiles { computed: Vec::new(), left_out: Vec::new(), residual_evaluations: 0 };
        if !self.structure.is_noisy() {
            return Ok(found);
        }
        for (index, estimate) in self.fit().estimates().iter().enumerate().take(problem.table.shared) {
            // Beside what is not determined a value on its bound has no variance either.
            let is_known = self.covariance.relaxed(index).is_some();
            if !is_known || matches!(estimate.status(), EstimateStatus::Fixed | EstimateStatus::Undetermined) {
                continue;
            }
            let parameter = estimate.parameter().clone();
            match self.profile(&problem, index, level, &mut found.residual_evaluations) {
                Ok(profile) => found.computed.push(profile),
                Err(error) => found.left_out.push((parameter, error)),
            }
        }
        Ok(found)
    }

    /// Profile of the parameter at `index`; counts its evaluations.
    fn profile(
        &self,
        problem: &Problem<'_>,
        index: usize,
        level: f64,
        evaluations: &mut usize,
    ) -> Result<Profile, FitError> {
        let fit = self.fit();
        let estimate = &fit.estimates()[index];
        let variance = self.covariance.relaxed(index).ok_or_else(no_variance)?;
        let plain = fit.relaxed_covariance(index, index).or_else(|| fit.covariance(index, index));
        let (plain, deviation) = (plain.zip(fit.residual_standard_deviation())).ok_or_else(no_variance)?;
        let degrees_of_freedom = self.covariance.degrees_of_freedom(index);
        let residuals =
            ResidualVariance::Effective { variance: variance / plain * deviation * deviation, degrees_of_freedom };
        let left = |used: usize| Options::default().with_max_evaluations(MOST_EVALUATIONS.saturating_sub(used));
        let interval = ProfileInterval::of(problem, fit, estimate.name(), level, residuals, &left(*evaluations))?;
        *evaluations += interval.residual_evaluations();
        let parameter = estimate.parameter().clone();
        let mut profile = Profile { parameter, value: estimate.value(), variance, interval, curve: Vec::new() };
        if profile.is_bent() {
            profile.curve = profile.interval.curve(problem, fit, STEPS, &left(*evaluations))?;
        }
        Ok(profile)
    }
}

fn no_variance() -> FitError {
    let what = "the fit leaves no residual or no degree of freedom, so the variance cannot be estimated from it";
    FitError::Undetermined { what: what.to_owned() }
}
