//! Repeatability and reproducibility.

use fmm_model::coverage_factor;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::distributions::Distribution;
use crate::error::UncertaintyError;
use crate::groups::analysis_of_variance::{AnalysisOfVariance, tail_of_f};
use crate::moments::Moments;

/// Precision of a method by observations in groups (laboratories, operators, days, releases), after ISO 5725-2:1994,
/// clause 7.4.
///
/// ```text
/// s_r² = Σ (n_i − 1) s_i²/Σ (n_i − 1)                    repeatability
/// s_L² = (s_d² − s_r²)/n̄,   s_d² = Σ n_i (ȳ_i − ȳ)²/(p − 1)
/// n̄ = (Σ n_i − Σ n_i²/Σ n_i)/(p − 1)                     between groups, 0 if negative
/// s_R² = s_r² + s_L²                                     reproducibility
/// ```
///
/// ```
/// use fmm_uq::Precision;
///
/// let laboratories = [[10.1, 10.2], [10.4, 10.3], [9.9, 10.1], [10.2, 10.2]];
/// let found = Precision::of(&laboratories)?;
/// assert!(found.repeatability() < found.reproducibility());
/// // No group stands out by its mean, nor by its spread.
/// assert!(found.grubbs().is_some_and(|farthest| farthest.p_value > 0.05));
/// assert!(found.h().iter().all(|h| h.abs() < found.h_limit(0.95).unwrap()));
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
///
/// # References
/// - ISO 5725-2:1994, *Accuracy (trueness and precision) of measurement methods and results, Part 2*, clauses 7.3 (h,
///   k, the tests of Cochran and Grubbs) and 7.4.
/// - P.-T. Wilrich, AStA Advances in Statistical Analysis 97 (2013) 1, <https://doi.org/10.1007/s10182-011-0185-y>
///   (source of its tables of limits).
#[derive(Debug, Clone, PartialEq)]
pub struct Precision {
    analysis: AnalysisOfVariance,
}

/// The group that stands out most, and how likely one does as much by chance.
///
/// ```
/// let laboratories = [[10.1, 10.2], [10.0, 10.1], [10.2, 10.0], [10.1, 10.1], [12.0, 12.1]];
/// let found = fmm_uq::Precision::of(&laboratories)?;
/// assert!(found.grubbs().is_some_and(|farthest| farthest.group == 4 && farthest.p_value < 0.01));
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Index of the group, counted from 0.
    pub group: usize,
    /// The statistic (1).
    pub statistic: f64,
    /// Probability of one as large if all groups were alike (1), at most.
    pub p_value: f64,
}

impl Precision {
    /// Precision of at least two groups.
    ///
    /// # Errors
    /// Those of [`AnalysisOfVariance::of`].
    pub fn of<G: AsRef<[f64]>>(groups: &[G]) -> Result<Self, UncertaintyError> {
        Ok(Self { analysis: AnalysisOfVariance::of(groups)? })
    }

    /// The analysis of variance behind it.
    pub fn analysis(&self) -> &AnalysisOfVariance {
        &self.analysis
    }

    /// General mean m (unit of the observations).
    pub fn mean(&self) -> f64 {
        self.analysis.mean()
    }

    /// s_r, standard deviation of repeatability (unit of the observations).
    pub fn repeatability(&self) -> f64 {
        self.analysis.residual_standard_deviation()
    }

    /// s_L, standard deviation between groups (unit of the observations); 0 where the groups differ no more than by
    /// chance within them; [`Precision::between_variance`] is then negative.
    pub fn between(&self) -> f64 {
        self.between_variance().max(0.0).sqrt()
    }

    /// (s_d² − s_r²)/n̄, the variance between groups as it is estimated without bias (unit of the observations
    /// squared). Negative where the means of the groups lie closer together than chance within them lets expect: then
    /// [`Precision::between`] is 0.
    pub fn between_variance(&self) -> f64 {
        let counts = || self.analysis.counts.iter().map(|count| *count as f64);
        let (all, squares): (f64, f64) = (counts().sum(), counts().map(|count| count * count).sum());
        let mean_count = (all - squares / all) / (self.analysis.counts.len() - 1) as f64;
        let (between, within) = self.analysis.mean_squares();
        (between - within) / mean_count
    }

    /// s_R, standard deviation of reproducibility (unit of the observations).
    pub fn reproducibility(&self) -> f64 {
        self.repeatability().hypot(self.between())
    }

    /// h, Mandel's statistic of the mean of each group (1): its distance from the mean of the means in their standard
    /// deviations; 0 if all are equal.
    pub fn h(&self) -> Vec<f64> {
        let (mean, deviation, means) = self.spread_of_means();
        means.iter().map(|of_group| if deviation > 0.0 { (of_group - mean) / deviation } else { 0.0 }).collect()
    }

    /// The |h| that one group exceeds by chance with probability 1 − `level` (1), whatever the spread.
    ///
    /// ```text
    /// h = (p − 1) t/√(p (t² + p − 2)),   t = t_level(p − 2)
    /// ```
    ///
    /// ```
    /// let laboratories: Vec<[f64; 2]> = (0..8).map(|i| [f64::from(i % 3), f64::from(i % 2)]).collect();
    /// let found = fmm_uq::Precision::of(&laboratories)?;
    /// assert!((found.h_limit(0.95)? - 1.75).abs() < 0.005 && (found.h_limit(0.99)? - 2.06).abs() < 0.005);
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless 0 < level < 1; [`UncertaintyError::NoAnswer`] for two groups, whose h
    /// are ±1/√2 always.
    pub fn h_limit(&self, level: f64) -> Result<f64, UncertaintyError> {
        let groups = self.analysis.counts.len();
        if groups < 3 {
            return Err(too_few_groups(groups, 3));
        }
        let count = groups as f64;
        let t = coverage_factor(level, count - 2.0).ok_or_else(|| UncertaintyError::level(level))?;
        // The quotient first: t of a level near 1 has no square in f64.
        Ok((count - 1.0) / (count * (1.0 + (count - 2.0) / t / t)).sqrt())
    }

    /// k, Mandel's statistic of the spread within each group (1): its standard deviation over that of all. `None`
    /// for a group of one observation.
    pub fn k(&self) -> Vec<Option<f64>> {
        let variances = self.variances();
        let seen = variances.iter().flatten().count() as f64;
        let mean = variances.iter().flatten().sum::<f64>() / seen;
        let ratio = |variance: f64| if mean > 0.0 { (variance / mean).sqrt() } else { 1.0 };
        variances.into_iter().map(|variance| variance.map(ratio)).collect()
    }

    /// The k that one group of `observations` exceeds by chance with probability 1 − `level` (1), if all groups have as
    /// many.
    ///
    /// ```text
    /// k²/p is beta distributed, α = (n − 1)/2, β = (p − 1)(n − 1)/2
    /// ```
    ///
    /// ```
    /// let laboratories: Vec<[f64; 2]> = (0..8).map(|i| [f64::from(i % 3), f64::from(i % 2)]).collect();
    /// let found = fmm_uq::Precision::of(&laboratories)?;
    /// assert!((found.k_limit(2, 0.95)? - 1.88).abs() < 0.005 && (found.k_limit(2, 0.99)? - 2.26).abs() < 0.005);
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless 0 < level < 1 and there are two or more; [`UncertaintyError::NoAnswer`] if
    /// fewer than two groups have a spread.
    pub fn k_limit(&self, observations: usize, level: f64) -> Result<f64, UncertaintyError> {
        if observations < 2 {
            return Err(UncertaintyError::too_few_observations(observations, 2));
        }
        let groups = self.variances().iter().flatten().count();
        if groups < 2 {
            return Err(too_few_groups(groups, 2));
        }
        let (count, freedom) = (groups as f64, (observations - 1) as f64);
        let share = Distribution::beta(0.5 * freedom, 0.5 * freedom * (count - 1.0), 0.0, 1.0)?;
        Ok((count * share.quantile(level)?).sqrt())
    }

    /// Cochran's test of the group with the largest spread, C = s_max²/Σ s²; `None` if fewer than two groups have a
    /// spread. The number of observations is taken as their mean where they differ.
    ///
    /// ```text
    /// p value = p P(F(ν, (p − 1) ν) > C (p − 1)/(1 − C)),   ν = n − 1
    /// ```
    ///
    /// It is an upper bound, exact where C > 1/2: two groups cannot both have more.
    pub fn cochran(&self) -> Option<Outlier> {
        let variances = self.variances();
        let all: f64 = variances.iter().flatten().sum();
        let seen: Vec<(usize, f64)> =
            variances.iter().enumerate().filter_map(|(group, variance)| Some((group, (*variance)?))).collect();
        let (group, largest) = seen.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
        if seen.len() < 2 || !(all > 0.0) {
            return None;
        }
        let others = (seen.len() - 1) as f64;
        let freedom = self.analysis.degrees_of_freedom().1 / seen.len() as f64;
        let statistic = largest / all;
        let f = statistic * others / (1.0 - statistic);
        let p_value = (seen.len() as f64 * tail_of_f(f, freedom, others * freedom)).min(1.0);
        Some(Outlier { group, statistic, p_value })
    }

    /// Grubbs' test of the mean that lies farthest from the others, G = |ȳ_i − ȳ|/s; `None` for fewer than three
    /// groups, or if all are equal.
    ///
    /// ```text
    /// p value = 2 p P(T(p − 2) > t),   G = (p − 1) t/√(p (t² + p − 2))
    /// ```
    ///
    /// It is an upper bound, exact where two means cannot both lie as far out.
    pub fn grubbs(&self) -> Option<Outlier> {
        let (mean, deviation, means) = self.spread_of_means();
        let distance = |group: &usize| (means[*group] - mean).abs();
        let group = (0..means.len()).max_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let count = means.len() as f64;
        if means.len() < 3 || !(deviation > 0.0) {
            return None;
        }
        let statistic = distance(&group) / deviation;
        // G² = (p − 1)² t²/(p (p − 2 + t²)).
        let share = count * statistic * statistic / (count - 1.0).powi(2);
        let t = if share < 1.0 { ((count - 2.0) * share / (1.0 - share)).sqrt() } else { f64::INFINITY };
        let tail = StudentsT::new(0.0, 1.0, count - 2.0).map_or(1.0, |student| student.sf(t));
        Some(Outlier { group, statistic, p_value: (2.0 * count * tail).min(1.0) })
    }

    /// s_i², `None` for a group of one observation.
    fn variances(&self) -> Vec<Option<f64>> {
        let of_group = |(count, squares): (&usize, &f64)| (*count > 1).then(|| squares / (*count - 1) as f64);
        self.analysis.counts.iter().zip(&self.analysis.squares).map(of_group).collect()
    }

    /// Mean and standard deviation of the means of the groups, and these, all about the first observation.
    fn spread_of_means(&self) -> (f64, f64, &[f64]) {
        let means = self.analysis.means.as_slice();
        let moments = Moments::of_values(means);
        (moments.mean(), moments.standard_deviation().unwrap_or(0.0), means)
    }
}

/// Error of too few groups for a limit of their spread by chance.
fn too_few_groups(found: usize, needed: usize) -> UncertaintyError {
    UncertaintyError::no_answer(format!(
        "{found} groups differ in one way only; a limit by chance needs {needed} or more of them"
    ))
}
