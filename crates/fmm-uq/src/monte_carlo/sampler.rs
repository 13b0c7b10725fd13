//! Values of all inputs at once, correlated as they are.

use std::sync::Arc;

use rand::Rng;
use rand_distr::{ChiSquared, Distribution as _, StandardNormal};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::distributions::Shape;
use crate::distributions::gamma::gamma_quantile;
use crate::inputs::factor::correlation_root;
use crate::random::ziggurat::Ziggurat;
use crate::{Distribution, Inputs};

/// Sampler of the inputs of a trial: independent inputs one by one, the others through a common set of normal scores.
#[derive(Debug, Clone)]
pub(crate) struct Sampler {
    width: usize,
    independent: Vec<Independent>,
    dependent: Vec<Margin>,
    root: Vec<Vec<f64>>,
    ensembles: Vec<(f64, ChiSquared<f64>)>,
}

/// One of the independent inputs.
#[derive(Debug, Clone)]
struct Independent {
    input: usize,
    distribution: Distribution,
    /// For a normal or t-distributed input: its standardised distribution, its mean and its scale.
    bell: Option<(Arc<Ziggurat>, (f64, f64))>,
}

/// One of the dependent inputs.
#[derive(Debug, Clone)]
struct Margin {
    input: usize,
    kind: MarginKind,
}

#[derive(Debug, Clone)]
enum MarginKind {
    Normal { mean: f64, standard_deviation: f64 },
    Ensemble { mean: f64, scale: f64, ensemble: usize },
    Copula(Distribution),
}

impl Independent {
    fn new(input: usize, distribution: &Distribution) -> Self {
        let bell = match distribution.shape {
            Shape::Normal { mean, standard_deviation } => Some((Ziggurat::normal(), (mean, standard_deviation))),
            Shape::StudentT { mean, scale, degrees_of_freedom, .. } => {
                Ziggurat::student_t(degrees_of_freedom).map(|unit| (unit, (mean, scale)))
            }
            _ => None,
        };
        Self { input, distribution: distribution.clone(), bell }
    }
}

impl Sampler {
    pub(crate) fn new(inputs: &Inputs) -> Self {
        let all = inputs.as_slice();
        // A chi-squared distribution exists for every ν ≥ 1, so that no ensemble is lost here.
        let chi =
            |e: &crate::inputs::Ensemble| ChiSquared::new(e.degrees_of_freedom).map(|c| (e.degrees_of_freedom, c));
        let ensembles: Vec<_> = inputs.ensembles().iter().filter_map(|e| chi(e).ok()).collect();
        let ensemble_of = |i: usize| inputs.ensembles().iter().position(|e| e.members.contains(&i));
        let correlated = |i: usize| inputs.correlated_pairs().any(|(a, b)| a == i || b == i);
        let (mut independent, mut dependent) = (Vec::new(), Vec::new());
        for (input, quantity) in all.iter().enumerate() {
            let distribution = quantity.distribution();
            let (mean, scale) = (quantity.value(), quantity.standard_uncertainty());
            let varies = !matches!(distribution.shape, Shape::Constant(_));
            let kind = match (ensemble_of(input), &distribution.shape) {
                (Some(ensemble), _) => MarginKind::Ensemble { mean, scale, ensemble },
                (None, Shape::Normal { .. }) => MarginKind::Normal { mean, standard_deviation: scale },
                (None, _) => MarginKind::Copula(distribution.clone()),
            };
            if varies && (correlated(input) || ensemble_of(input).is_some()) {
                dependent.push(Margin { input, kind });
            } else {
                independent.push(Independent::new(input, distribution));
            }
        }
        let members: Vec<usize> = dependent.iter().map(|margin| margin.input).collect();
        let root = correlation_root(inputs, &members);
        Self { width: all.len(), independent, dependent, root, ensembles }
    }

    /// Number of inputs.
    pub(crate) const fn width(&self) -> usize {
        self.width
    }

    /// Fills whole rows of one value for each input.
    ///
    /// The order of draws belongs to the results: independent inputs one after the other, each for all rows, then the
    /// dependent ones row by row.
    pub(crate) fn fill<R: Rng + ?Sized>(&self, rng: &mut R, rows: &mut [f64]) {
        for Independent { input, distribution, bell } in &self.independent {
            match bell {
                Some((unit, place)) => unit.fill(rng, *place, &mut rows[*input..], self.width),
                None => distribution.fill(rng, &mut rows[*input..], self.width),
            }
        }
        if self.dependent.is_empty() {
            return;
        }
        let mut scores = vec![0.0; self.dependent.len()];
        let mut stretches = vec![1.0; self.ensembles.len()];
        for row in rows.chunks_exact_mut(self.width) {
            for score in &mut scores {
                *score = StandardNormal.sample(rng);
            }
            for (stretch, (nu, chi)) in stretches.iter_mut().zip(&self.ensembles) {
                *stretch = (nu / chi.sample(rng)).sqrt();
            }
            self.combine(&scores, &stretches, row);
        }
    }

    /// Number of uniform numbers that a row takes by [`Sampler::map`].
    pub(crate) fn dimensions(&self) -> usize {
        self.independent.len() + self.dependent.len() + self.ensembles.len()
    }

    /// One row from uniform numbers in (0, 1), by quantiles.
    pub(crate) fn map(&self, uniform: &[f64], row: &mut [f64]) {
        let (alone, rest) = uniform.split_at(self.independent.len());
        for (Independent { input, distribution, .. }, &u) in self.independent.iter().zip(alone) {
            row[*input] = distribution.quantile_at(u);
        }
        if self.dependent.is_empty() {
            return;
        }
        let (normal, chi) = rest.split_at(self.dependent.len());
        let scores: Vec<f64> = normal.iter().map(|&u| Normal::standard().inverse_cdf(u)).collect();
        // Chi-squared is twice a gamma variate of half the degrees of freedom.
        let stretch = |(&(nu, _), &u): (&(f64, ChiSquared<f64>), &f64)| (0.5 * nu / gamma_quantile(0.5 * nu, u)).sqrt();
        let stretches: Vec<f64> = self.ensembles.iter().zip(chi).map(stretch).collect();
        self.combine(&scores, &stretches, row);
    }

    fn combine(&self, scores: &[f64], stretches: &[f64], row: &mut [f64]) {
        for ((margin, root), at) in self.dependent.iter().zip(&self.root).zip(1..) {
            let z: f64 = root[..at].iter().zip(scores).map(|(l, score)| l * score).sum();
            row[margin.input] = match &margin.kind {
                MarginKind::Normal { mean, standard_deviation } => mean + standard_deviation * z,
                MarginKind::Ensemble { mean, scale, ensemble } => mean + scale * (z * stretches[*ensemble]),
                MarginKind::Copula(distribution) => {
                    let probability = Normal::standard().cdf(z);
                    // Beyond eight standard deviations the probability rounds to 1, which has no quantile.
                    distribution.quantile_at(probability.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0))
                }
            };
        }
    }
}
