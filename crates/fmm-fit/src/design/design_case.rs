//! Candidate measurements at one guess of the parameters, and the combinations that they shall determine.

use crate::algebra::definite::{factor, solve};
use crate::design::information::{Information, mismatch};
use crate::error::FitError;

/// The uncertainty to be made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DesignCriterion {
    /// D: the generalised variance of the combinations that are asked for, det(G M⁻¹ Gᵀ). It does not depend on their
    /// units.
    Determinant,
    /// A: the mean of their variances, tr(G M⁻¹ Gᵀ)/q. Of one combination it is its variance, the criterion called c.
    MeanVariance,
}

/// Prior information, the information of each candidate and the combinations of interest, all at one
/// guess of the parameters. Of a linear model there is one case; of others, several stand for what is not known yet.
#[derive(Debug, Clone)]
pub struct DesignCase {
    pub(crate) known: Information,
    pub(crate) candidates: Vec<Information>,
    combinations: Vec<Vec<f64>>,
    /// Addition to the diagonal, by which an undetermined combination is very uncertain.
    ridge: Vec<f64>,
}

/// The share of the information of a mean candidate that stands for what is not determined.
const RIDGE: f64 = 1e-10;

impl DesignCase {
    /// The information that is `known` before, that of each of the `candidates`, and the `combinations` gᵀθ that are
    /// asked for.
    ///
    /// # Errors
    /// [`FitError::Count`] if they are not of the same number of parameters, or without candidates or
    /// combinations.
    pub fn new(
        known: Information,
        candidates: Vec<Information>,
        combinations: Vec<Vec<f64>>,
    ) -> Result<Self, FitError> {
        let order = known.order();
        if candidates.is_empty() || combinations.is_empty() {
            let what = if candidates.is_empty() { "candidates" } else { "combinations" };
            return Err(mismatch(&format!("{what} of a design"), 0, 1));
        }
        if let Some(other) = candidates.iter().find(|candidate| candidate.order() != order) {
            return Err(mismatch("parameters of a candidate", other.order(), order));
        }
        combinations.iter().try_for_each(|combination| known.require(combination))?;
        let mean = |j: usize| candidates.iter().map(|one| one.element(j, j)).sum::<f64>() / candidates.len() as f64;
        let least = |j: usize| RIDGE * (mean(j) + known.element(j, j));
        let ridge = (0..order).map(|j| Some(least(j)).filter(|ridge| *ridge > 0.0).unwrap_or(1.0)).collect();
        Ok(Self { known, candidates, combinations, ridge })
    }

    /// All parameters by themselves, of the information that is `known` before and that of each of the `candidates`.
    ///
    /// # Errors
    /// The same as of [`new`](Self::new).
    pub fn of_all(known: Information, candidates: Vec<Information>) -> Result<Self, FitError> {
        let order = known.order();
        let unit = |j: usize| (0..order).map(|i| f64::from(i == j)).collect();
        Self::new(known, candidates, (0..order).map(unit).collect())
    }

    /// Logarithm of the mean standard uncertainty of the combinations, by `criterion`, that an information leaves.
    pub(crate) fn score(&self, information: &[f64], criterion: DesignCriterion) -> f64 {
        let order = self.ridge.len();
        let mut factored = information.to_vec();
        let scales: Vec<f64> =
            (0..order).map(|j| (information[j * (order + 1)] + self.ridge[j]).sqrt().recip()).collect();
        for i in 0..order {
            factored[i * (order + 1)] += self.ridge[i];
            for j in 0..order {
                factored[i * order + j] *= scales[i] * scales[j];
            }
        }
        // Rounding of the scaled matrix, which is positive definite without it.
        (0..order).for_each(|j| factored[j * (order + 1)] += f64::EPSILON * order as f64);
        if !factor(&mut factored, order, |_| 0.0) {
            return f64::INFINITY;
        }
        let scaled: Vec<Vec<f64>> = self
            .combinations
            .iter()
            .map(|combination| combination.iter().zip(&scales).map(|(g, scale)| g * scale).collect())
            .collect();
        let solved: Vec<Vec<f64>> = scaled
            .iter()
            .map(|combination: &Vec<f64>| {
                let mut image = combination.clone();
                solve(&factored, &mut image);
                image
            })
            .collect();
        let count = scaled.len();
        let product = |i: usize, j: usize| -> f64 { scaled[i].iter().zip(&solved[j]).map(|(a, b)| a * b).sum() };
        match criterion {
            DesignCriterion::MeanVariance => 0.5 * ((0..count).map(|i| product(i, i)).sum::<f64>() / count as f64).ln(),
            DesignCriterion::Determinant => {
                let mut covariance: Vec<f64> = (0..count * count).map(|at| product(at / count, at % count)).collect();
                if !factor(&mut covariance, count, |_| 0.0) {
                    return f64::INFINITY;
                }
                (0..count).map(|i| covariance[i * (count + 1)].ln()).sum::<f64>() / count as f64
            }
        }
    }
}
