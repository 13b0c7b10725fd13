//! Analysis of variance of one factor.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::error::UncertaintyError;
use crate::moments::Moments;

/// Analysis of variance of observations in groups, of equal or unequal numbers.
///
/// ```text
/// SS_b = Σ n_i (ȳ_i − ȳ)²,   ν_b = p − 1            between p groups of n_i observations
/// SS_w = Σ Σ (y_ij − ȳ_i)²,   ν_w = N − p           within
/// F = (SS_b/ν_b)/(SS_w/ν_w)
/// ```
///
/// Sums are taken of differences from the first observation and corrected for their rounding, so that a large constant
/// in all observations costs no digits that they have: of the eleven sets of NIST, each comes out to the digits that it
/// keeps when its printed observations become `f64`, as exact fractions show.
///
/// ```
/// use fmm_uq::AnalysisOfVariance;
///
/// let runs = [vec![10.1, 10.3, 10.2], vec![10.6, 10.5, 10.7], vec![10.2, 10.2, 10.1]];
/// let found = AnalysisOfVariance::of(&runs)?;
/// assert!(found.f() > 10.0 && found.p_value() < 0.01);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AnalysisOfVariance {
    pub(super) counts: Vec<usize>,
    /// About the first observation, so that a constant in all costs those who compare them no digits.
    pub(super) means: Vec<f64>,
    /// Σ (y − ȳ_i)² of each group.
    pub(super) squares: Vec<f64>,
    reference: f64,
    /// About the first observation.
    mean: f64,
    between: f64,
}

impl AnalysisOfVariance {
    /// Analysis of at least two groups, each with one observation or more, and one of them with two or more.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] if no group has two, for fewer than two groups or an empty one, or if an
    /// observation or the squares are not finite;
    /// [`UncertaintyError::NoAnswer`] if the observations differ by so little that their squares are lost.
    pub fn of<G: AsRef<[f64]>>(groups: &[G]) -> Result<Self, UncertaintyError> {
        if groups.len() < 2 || groups.iter().any(|group| group.as_ref().is_empty()) {
            return Err(UncertaintyError::invalid(format!(
                "two groups or more are needed, each with an observation at least, but {} were given, or one is empty",
                groups.len()
            )));
        }
        let all = || groups.iter().flat_map(|group| group.as_ref().iter().copied());
        if let Some((index, value)) = all().enumerate().find(|(_, value)| !value.is_finite()) {
            return Err(UncertaintyError::observation_not_finite(index, value));
        }
        let count = all().count();
        if count <= groups.len() {
            return Err(UncertaintyError::too_few_observations(count, groups.len() + 1));
        }
        let reference = groups[0].as_ref()[0];
        let about = |group: &G| group.as_ref().iter().map(|value| value - reference).collect::<Vec<f64>>();
        let groups: Vec<Vec<f64>> = groups.iter().map(about).collect();
        let moments: Vec<Moments> = groups.iter().map(|group| Moments::of_values(group)).collect();
        let means: Vec<f64> = moments.iter().map(Moments::mean).collect();
        let squares: Vec<f64> = moments.iter().map(Moments::sum_of_squares).collect();
        let all = groups.concat();
        let in_all = Moments::of_values(&all);
        let parts = groups.iter().zip(&means);
        let between: f64 = parts.map(|(group, mean)| group.len() as f64 * (mean - in_all.mean()).powi(2)).sum();
        if !(between + squares.iter().sum::<f64>()).is_finite() {
            return Err(UncertaintyError::observation_not_finite(0, reference));
        }
        in_all.require_squares(&all, "the observations")?;
        let mean = in_all.mean();
        Ok(Self { counts: groups.iter().map(Vec::len).collect(), means, squares, reference, mean, between })
    }

    /// N, number of observations.
    pub fn observations(&self) -> usize {
        self.counts.iter().sum()
    }

    /// ȳ_i, mean of each group (unit of the observations).
    pub fn means(&self) -> impl Iterator<Item = f64> {
        self.means.iter().map(|mean| self.reference + mean)
    }

    /// ȳ, mean of all observations (their unit).
    pub fn mean(&self) -> f64 {
        self.reference + self.mean
    }

    /// SS_b (unit of the observations squared).
    pub fn between(&self) -> f64 {
        self.between
    }

    /// SS_w (unit of the observations squared).
    pub fn within(&self) -> f64 {
        self.squares.iter().sum()
    }

    /// ν_b and ν_w (1).
    pub fn degrees_of_freedom(&self) -> (f64, f64) {
        ((self.counts.len() - 1) as f64, (self.observations() - self.counts.len()) as f64)
    }

    /// SS_b/ν_b and SS_w/ν_w (unit of the observations squared).
    pub fn mean_squares(&self) -> (f64, f64) {
        let (between, within) = self.degrees_of_freedom();
        (self.between / between, self.within() / within)
    }

    /// F (1); infinite if nothing differs within the groups but something between them, and 0 if nothing differs at
    /// all.
    pub fn f(&self) -> f64 {
        let (between, within) = self.mean_squares();
        if between == 0.0 { 0.0 } else { between / within }
    }

    /// R², share of all squares that lies between the groups (1); 0 if nothing differs.
    pub fn r_squared(&self) -> f64 {
        let all = self.between + self.within();
        if all > 0.0 { self.between / all } else { 0.0 }
    }

    /// s, standard deviation within the groups (unit of the observations).
    pub fn residual_standard_deviation(&self) -> f64 {
        self.mean_squares().1.sqrt()
    }

    /// Probability of an F as large if all groups had one mean (1).
    pub fn p_value(&self) -> f64 {
        let (between, within) = self.degrees_of_freedom();
        tail_of_f(self.f(), between, within)
    }
}

/// The probability with which F of these degrees of freedom exceeds `f`.
pub(super) fn tail_of_f(f: f64, between: f64, within: f64) -> f64 {
    if f.is_infinite() {
        return 0.0;
    }
    FisherSnedecor::new(between, within).map_or(1.0, |distribution| distribution.sf(f.max(0.0)))
}
