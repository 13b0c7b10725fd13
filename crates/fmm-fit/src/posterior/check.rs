//! Check of a sampled posterior by random-walk steps, which need no gradient.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::algebra::definite::{add_square, factor};
use crate::posterior::coordinates::Whitening;
use crate::posterior::marginal::Marginal;
use crate::posterior::prior::standard_normal;
use crate::posterior::result::Posterior;
use crate::posterior::target::Target;
use crate::problem::residuals::Residuals;

/// Standard errors by which moments differ that disagree (1); in 1000 comparisons 0.06 do by chance.
const DISAGREEMENT: f64 = 4.0;

/// The agreement of a posterior with random-walk Metropolis chains of the same density.
///
/// Kinks and jumps of the residuals, as at the stop of a motion, are nothing to a method that only compares densities.
/// The two must agree in means and standard deviations within their Monte Carlo errors.
///
/// # References
/// N. Metropolis et al., J. Chem. Phys. 21 (1953) 1087, <https://doi.org/10.1063/1.1699114>; A. Gelman, G. O. Roberts,
/// W. R. Gilks, "Efficient Metropolis jumping rules", Bayesian Statistics 5 (1996) 599 (steps of 2.38/√p).
#[derive(Debug, Clone, PartialEq)]
pub struct GradientFreeCheck {
    acceptance: f64,
    marginals: Vec<Marginal>,
    disagreements: Vec<Disagreement>,
}

/// A moment in which the two methods disagree, in the unit of the parameter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Disagreement {
    /// Name of the parameter.
    pub parameter: String,
    /// True for the standard deviation, false for the mean.
    pub is_deviation: bool,
    /// The moment by the sampler with gradients.
    pub with_gradient: f64,
    /// The moment by random-walk steps.
    pub without_gradient: f64,
    /// Standard error of the difference.
    pub standard_error: f64,
}

impl GradientFreeCheck {
    pub(super) fn of(posterior: &Posterior, walks: &[Walked]) -> Self {
        let count = posterior.parameters().len();
        let free = posterior.free();
        let marginals: Vec<Marginal> = free
            .iter()
            .filter_map(|&j| {
                let draws = walks.iter().flat_map(|walk| walk.values.iter().skip(j).step_by(count).copied());
                Marginal::new(posterior.parameters()[j].clone(), draws.collect(), walks.len())
            })
            .collect();
        let mut disagreements = Vec::new();
        for walked in &marginals {
            let name = walked.parameter().name();
            let Some(sampled) = posterior.marginal(name) else { continue };
            let moments = [
                (false, sampled.mean(), walked.mean(), sampled.error_of_mean().hypot(walked.error_of_mean())),
                (
                    true,
                    sampled.standard_deviation(),
                    walked.standard_deviation(),
                    sampled.error_of_deviation().hypot(walked.error_of_deviation()),
                ),
            ];
            for (is_deviation, with_gradient, without_gradient, standard_error) in moments {
                if (with_gradient - without_gradient).abs() > DISAGREEMENT * standard_error {
                    let parameter = name.to_owned();
                    let disagreement =
                        Disagreement { parameter, is_deviation, with_gradient, without_gradient, standard_error };
                    disagreements.push(disagreement);
                }
            }
        }
        let acceptance = walks.iter().map(|walk| walk.acceptance).sum::<f64>() / walks.len() as f64;
        Self { acceptance, marginals, disagreements }
    }

    /// Share of steps that were accepted (1).
    pub fn acceptance(&self) -> f64 {
        self.acceptance
    }

    /// Marginal of each free parameter by the random walks.
    pub fn marginals(&self) -> &[Marginal] {
        &self.marginals
    }

    /// The moments that differ by more than four standard errors; empty if the two methods agree.
    pub fn disagreements(&self) -> &[Disagreement] {
        &self.disagreements
    }
}

/// Steps in whitened coordinates, as long and as correlated as the draws of another sampler.
#[derive(Debug)]
pub(super) struct Walk {
    /// Factor of the covariance of a step, lower half.
    factor: Vec<f64>,
}

/// Result of one random walk.
#[derive(Debug)]
pub(super) struct Walked {
    /// All parameters of each step of the second half, one step after the other.
    values: Vec<f64>,
    acceptance: f64,
}

impl Walk {
    /// By the covariance of `positions`, of `order` coordinates each.
    pub(super) fn of(positions: &[f64], order: usize) -> Self {
        let count = (positions.len() / order) as f64;
        let mut mean = vec![0.0; order];
        for z in positions.chunks_exact(order) {
            mean.iter_mut().zip(z).for_each(|(mean, z)| *mean += z / count);
        }
        let mut matrix = vec![0.0; order * order];
        let step = 2.38 * 2.38 / order as f64;
        for z in positions.chunks_exact(order) {
            let away: Vec<f64> = z.iter().zip(&mean).map(|(z, mean)| z - mean).collect();
            add_square(&mut matrix, &away, step / count);
        }
        if !factor(&mut matrix, order, |_| 0.0) {
            // Chains that never moved; the check will then disagree.
            matrix.fill(0.0);
            (0..order).for_each(|j| matrix[j * order + j] = step.sqrt());
        }
        Self { factor: matrix }
    }

    /// Takes `steps` steps from a `start` with its ln p, and forgets the first half.
    pub(super) fn run<P: Residuals + ?Sized>(
        &self,
        target: &mut Target<'_, P>,
        whitening: &Whitening,
        (mut z, mut density): (Vec<f64>, f64),
        steps: usize,
        random: &mut ChaCha8Rng,
    ) -> Walked {
        let order = z.len();
        let mut values = target.values().to_vec();
        let mut walked = Walked { values: Vec::new(), acceptance: 0.0 };
        let (mut trial, mut psi) = (vec![0.0; order], Vec::new());
        for step in 0..steps {
            let noise: Vec<f64> = z.iter().map(|_| standard_normal(random)).collect();
            for i in 0..order {
                let along: f64 = (0..=i).map(|k| self.factor[i * order + k] * noise[k]).sum();
                trial[i] = z[i] + along;
            }
            whitening.coordinates(&trial, &mut psi);
            let threshold = random.random::<f64>().ln();
            if let Some(next) = target.log_density(&psi).filter(|next| next - density > threshold) {
                density = next;
                z.copy_from_slice(&trial);
                values.copy_from_slice(target.values());
                walked.acceptance += 1.0 / steps as f64;
            }
            if step >= steps / 2 {
                walked.values.extend_from_slice(&values);
            }
        }
        walked
    }
}
