//! Repeatability and reproducibility.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::groups::analysis_of_variance::{sum, tail_of_f};
use crate::{AnalysisOfVariance, UncertaintyError};

/// Precision of a method by observations in groups (laboratories, operators, days, releases), after ISO 5725-2:1994.
///
/// ```text
/// s_r² = Σ (n_i − 1) s_i²/Σ (n_i − 1)                    repeatability                      (7.4.5.1)
/// s_L² = (s_d² − s_r²)/n̄,   s_d² = Σ n_i (ȳ_i − ȳ)²/(p − 1)
/// n̄ = (Σ n_i − Σ n_i²/Σ n_i)/(p − 1)                     between groups, 0 if negative      (7.4.5.2)
/// s_R² = s_r² + s_L²                                     reproducibility                    (7.4.5.5)
/// ```
///
/// ```
/// use fmm_uq::Precision;
///
/// let laboratories = [vec![4.44, 4.39], vec![4.03, 4.23], vec![3.70, 3.70], vec![4.10, 4.10]];
/// let found = Precision::of(&laboratories)?;
/// assert!(found.repeatability() < found.reproducibility());
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Precision {
    analysis: AnalysisOfVariance,
}

/// The group that stands out most, and how likely one does as much by chance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Which group, counted from 0.
    pub group: usize,
    /// The statistic (1).
    pub statistic: f64,
    /// Probability of one as large if all groups were alike (1), at most.
    pub p_value: f64,
}

impl Precision {
    /// Of at least two groups.
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

    /// s_L, standard deviation between groups (unit of the observations); 0 where the groups differ no more than observations within
    /// them make them.
    pub fn between(&self) -> f64 {
        let counts = || self.analysis.counts.iter().map(|count| *count as f64);
        let (all, squares): (f64, f64) = (counts().sum(), counts().map(|count| count * count).sum());
        let mean_count = (all - squares / all) / (self.analysis.counts.len() - 1) as f64;
        let (between, within) = self.analysis.mean_squares();
        ((between - within) / mean_count).max(0.0).sqrt()
    }

    /// s_R, standard deviation of reproducibility (unit of the observations).
    pub fn reproducibility(&self) -> f64 {
        self.repeatability().hypot(self.between())
    }

    /// h, Mandel's statistic of the mean of each group (1): its distance from the mean of the means in their standard deviations
    /// (7.3.1.2); 0 if all are equal.
    pub fn h(&self) -> Vec<f64> {
        let (mean, deviation, means) = self.spread_of_means();
        means.iter().map(|of_group| if deviation > 0.0 { (of_group - mean) / deviation } else { 0.0 }).collect()
    }

    /// k, Mandel's statistic of the spread within each group (1): its standard deviation over that of all (7.3.1.4). `None` for a group of
    /// one observation.
    pub fn k(&self) -> Vec<Option<f64>> {
        let variances = self.variances();
        let seen = variances.iter().flatten().count() as f64;
        let mean = variances.iter().flatten().sum::<f64>() / seen;
        let ratio = |variance: f64| if mean > 0.0 { (variance / mean).sqrt() } else { 1.0 };
        variances.into_iter().map(|variance| variance.map(ratio)).collect()
    }

    /// Cochran's test of the group with the largest spread, C = s_max²/Σ s² (7.3.3); `None` if fewer than two groups have a spread. The
    /// number of observations is taken as their mean where they differ.
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

    /// Grubbs' test of the mean that lies farthest from the others, G = |ȳ_i − ȳ|/s (7.3.4); `None` for fewer than three groups, or if all
    /// are equal.
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

    /// Mean and standard deviation of the means of the groups, and these.
    fn spread_of_means(&self) -> (f64, f64, Vec<f64>) {
        let means: Vec<f64> = self.analysis.means().collect();
        let mean = sum(means.iter().copied()) / means.len() as f64;
        let squares = sum(means.iter().map(|value| (value - mean).powi(2)));
        (mean, (squares / (means.len() - 1) as f64).sqrt(), means)
    }
}
