//! Values of all inputs at once, correlated as they are.

use std::sync::Arc;

use rand::Rng;
use rand_distr::{ChiSquared, Distribution as _, StandardNormal};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::distributions::{Distribution, Ziggurat};
use crate::inputs::{Ensemble, Inputs};

/// Rows whose dependent inputs are computed together.
const TOGETHER: usize = 8;

/// Sampler of the inputs of a trial: independent inputs one by one, the others through a common set of normal scores.
#[derive(Debug, Clone)]
pub(crate) struct Sampler {
    width: usize,
    independent: Vec<Independent>,
    dependent: Vec<Margin>,
    root: Vec<Vec<f64>>,
    /// Place of the first number of each row of the root that is not zero.
    begins: Vec<usize>,
    ensembles: Vec<(f64, ChiSquared<f64>)>,
}

/// One of the independent inputs.
#[derive(Debug, Clone)]
struct Independent {
    input: usize,
    distribution: Distribution,
    /// Standardised distribution, mean and scale of a normal or t-distributed input.
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
        let unit = if distribution.is_normal() {
            Some(Ziggurat::normal())
        } else if distribution.is_normal_or_t() {
            Ziggurat::student_t(distribution.degrees_of_freedom())
        } else {
            None
        };
        let bell = unit.map(|unit| (unit, (distribution.mean(), distribution.standard_uncertainty())));
        Self { input, distribution: distribution.clone(), bell }
    }
}

impl Sampler {
    pub(crate) fn new(inputs: &Inputs) -> Self {
        let all = inputs.as_slice();
        // A chi-squared distribution exists for every ν ≥ 1, so that no ensemble is lost here.
        let chi = |e: &Ensemble| ChiSquared::new(e.degrees_of_freedom).map(|c| (e.degrees_of_freedom, c));
        let ensembles: Vec<_> = inputs.ensembles().iter().filter_map(|e| chi(e).ok()).collect();
        let ensemble_of = |i: usize| inputs.ensembles().iter().position(|e| e.members.contains(&i));
        let correlated = |i: usize| inputs.correlated_pairs().any(|(a, b)| a == i || b == i);
        let (mut independent, mut dependent) = (Vec::new(), Vec::new());
        for (input, quantity) in all.iter().enumerate() {
            let distribution = quantity.distribution();
            let (mean, scale) = (quantity.value(), quantity.standard_uncertainty());
            let kind = match ensemble_of(input) {
                Some(ensemble) => MarginKind::Ensemble { mean, scale, ensemble },
                None if distribution.is_normal() => MarginKind::Normal { mean, standard_deviation: scale },
                None => MarginKind::Copula(distribution.clone()),
            };
            if !distribution.is_constant() && (correlated(input) || ensemble_of(input).is_some()) {
                dependent.push(Margin { input, kind });
            } else {
                independent.push(Independent::new(input, distribution));
            }
        }
        let members: Vec<usize> = dependent.iter().map(|margin| margin.input).collect();
        let root = inputs.correlation_root(&members);
        let begins = root.iter().map(|row| row.iter().position(|l| *l != 0.0).unwrap_or(0)).collect();
        Self { width: all.len(), independent, dependent, root, begins, ensembles }
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
        let mut scores = vec![[0.0; TOGETHER]; self.dependent.len()];
        let mut stretches = vec![[1.0; TOGETHER]; self.ensembles.len()];
        for rows in rows.chunks_mut(self.width * TOGETHER) {
            for row in 0..rows.len() / self.width {
                for score in &mut scores {
                    score[row] = StandardNormal.sample(rng);
                }
                for (stretch, (nu, chi)) in stretches.iter_mut().zip(&self.ensembles) {
                    stretch[row] = (nu / chi.sample(rng)).sqrt();
                }
            }
            self.combine(&scores, &stretches, rows);
        }
    }

    /// Writes the dependent inputs of up to [`TOGETHER`] rows. A sum of products waits for each of its terms, those of
    /// several rows do not wait for each other.
    fn combine(&self, scores: &[[f64; TOGETHER]], stretches: &[[f64; TOGETHER]], rows: &mut [f64]) {
        for (place, (margin, root)) in self.dependent.iter().zip(&self.root).enumerate() {
            // Inputs that are correlated in groups have no part in other groups.
            let members = self.begins[place]..=place;
            let mut sums = [-0.0; TOGETHER];
            for (l, scores) in root[members.clone()].iter().zip(&scores[members]) {
                for (sum, score) in sums.iter_mut().zip(scores) {
                    *sum += l * score;
                }
            }
            for ((number, row), z) in rows.chunks_exact_mut(self.width).enumerate().zip(sums) {
                row[margin.input] = Self::value(&margin.kind, z, |ensemble| stretches[ensemble][number]);
            }
        }
    }

    /// The value of an input of this `kind` at the normal score `z`, `stretch` giving that of its ensemble.
    fn value(kind: &MarginKind, z: f64, stretch: impl Fn(usize) -> f64) -> f64 {
        match kind {
            MarginKind::Normal { mean, standard_deviation } => mean + standard_deviation * z,
            MarginKind::Ensemble { mean, scale, ensemble } => mean + scale * (z * stretch(*ensemble)),
            MarginKind::Copula(distribution) => {
                let probability = Normal::standard().cdf(z);
                // Beyond eight standard deviations the probability rounds to 1, which has no quantile.
                distribution.quantile_at(probability.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0))
            }
        }
    }
}
