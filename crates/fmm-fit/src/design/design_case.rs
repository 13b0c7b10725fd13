//! Candidate measurements at one guess of the parameters, and what they shall determine.

use std::fmt;
use std::sync::Arc;

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

/// Uncertainty of something that is no combination of parameters, as a number of a distribution that is not normal.
pub trait DesignUncertainty: fmt::Debug + Send + Sync {
    /// ln u after all measurements with this `information`; a number also where it is nothing.
    fn logarithm(&self, information: &Information) -> f64;
}

/// Prior information, the information of each candidate and what is asked for, all at one
/// guess of the parameters. Of a linear model there is one case; of others, several stand for what is not known yet.
#[derive(Debug, Clone)]
pub struct DesignCase {
    pub(crate) known: Information,
    pub(crate) candidates: Vec<Information>,
    asked: Asked,
}

/// Numbers that are to become certain.
#[derive(Debug, Clone)]
enum Asked {
    Combinations {
        combinations: Vec<Vec<f64>>,
        /// Addition to the diagonal, by which an undetermined combination is very uncertain.
        ridge: Vec<f64>,
    },
    Other(Arc<dyn DesignUncertainty>),
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
        require_alike(&known, &candidates)?;
        if combinations.is_empty() {
            return Err(mismatch("combinations of a design", 0, 1));
        }
        combinations.iter().try_for_each(|combination| known.require(combination))?;
        let mean = |j: usize| candidates.iter().map(|one| one.element(j, j)).sum::<f64>() / candidates.len() as f64;
        let least = |j: usize| RIDGE * (mean(j) + known.element(j, j));
        let ridge = (0..order).map(|j| Some(least(j)).filter(|ridge| *ridge > 0.0).unwrap_or(1.0)).collect();
        Ok(Self { known, candidates, asked: Asked::Combinations { combinations, ridge } })
    }

    /// The same for one `uncertainty` that is no combination of parameters, by which any criterion goes.
    ///
    /// # Errors
    /// [`FitError::Count`] if information is not of the same number of parameters, or without candidates.
    pub fn of_uncertainty(
        known: Information,
        candidates: Vec<Information>,
        uncertainty: Arc<dyn DesignUncertainty>,
    ) -> Result<Self, FitError> {
        require_alike(&known, &candidates)?;
        Ok(Self { known, candidates, asked: Asked::Other(uncertainty) })
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

    /// Logarithm of the mean standard uncertainty of what is asked for, by `criterion`, that an information leaves.
    pub(crate) fn score(&self, information: &[f64], criterion: DesignCriterion) -> f64 {
        let order = self.known.order();
        let (combinations, ridge) = match &self.asked {
            Asked::Combinations { combinations, ridge } => (combinations, ridge),
            Asked::Other(uncertainty) => {
                return uncertainty.logarithm(&Information::of_elements(order, information.to_vec()));
            }
        };
        let mut factored = information.to_vec();
        let scales: Vec<f64> = (0..order).map(|j| (information[j * (order + 1)] + ridge[j]).sqrt().recip()).collect();
        for i in 0..order {
            factored[i * (order + 1)] += ridge[i];
            for j in 0..order {
                factored[i * order + j] *= scales[i] * scales[j];
            }
        }
        // Rounding of the scaled matrix, which is positive definite without it.
        (0..order).for_each(|j| factored[j * (order + 1)] += f64::EPSILON * order as f64);
        if !factor(&mut factored, order, |_| 0.0) {
            return f64::INFINITY;
        }
        let scaled: Vec<Vec<f64>> = combinations
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

/// Refuses a design without candidates, or with some of other parameters.
fn require_alike(known: &Information, candidates: &[Information]) -> Result<(), FitError> {
    if candidates.is_empty() {
        return Err(mismatch("candidates of a design", 0, 1));
    }
    let order = known.order();
    match candidates.iter().find(|candidate| candidate.order() != order) {
        Some(other) => Err(mismatch("parameters of a candidate", other.order(), order)),
        None => Ok(()),
    }
}
