//! Check of a sampled posterior by random-walk steps, which need no gradient.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::algebra::definite::{add_square, factor};
use crate::posterior::coordinates::Whitening;
use crate::posterior::marginal::Marginal;
use crate::posterior::prior::standard_normal;
use crate::posterior::result::Posterior;
use crate::posterior::target::Target;
use crate::posterior::warning::PosteriorWarning;
use crate::problem::residuals::Residuals;

/// Standard errors by which moments differ that disagree (1); in 1000 comparisons 0.06 do by chance.
const DISAGREEMENT: f64 = 4.0;

/// Moments in which a posterior and random-walk Metropolis chains of the same density disagree.
///
/// Kinks and jumps of the residuals, as at the stop of a motion, are nothing to a method that only compares densities.
/// The two must agree in means and standard deviations within their Monte Carlo errors.
///
/// # References
/// N. Metropolis et al., J. Chem. Phys. 21 (1953) 1087, <https://doi.org/10.1063/1.1699114>; A. Gelman, G. O. Roberts,
/// W. R. Gilks, "Efficient Metropolis jumping rules", Bayesian Statistics 5 (1996) 599 (steps of 2.38/√p).
pub(super) fn disagreements(posterior: &Posterior, walks: &[Vec<f64>]) -> Vec<PosteriorWarning> {
    let (parameters, mut found) = (posterior.parameters(), Vec::new());
    for &j in posterior.free() {
        let draws = walks.iter().flat_map(|walk| walk.iter().skip(j).step_by(parameters.len()).copied());
        let name = parameters[j].name();
        let walked = Marginal::new(parameters[j].clone(), draws.collect(), walks.len());
        let Some((walked, sampled)) = walked.zip(posterior.marginal(name)) else { continue };
        let moments = [
            (false, [sampled, &walked].map(Marginal::mean), [sampled, &walked].map(Marginal::error_of_mean)),
            (
                true,
                [sampled, &walked].map(Marginal::standard_deviation),
                [sampled, &walked].map(Marginal::error_of_deviation),
            ),
        ];
        for (is_deviation, [with_gradient, without_gradient], errors) in moments {
            let standard_error = errors[0].hypot(errors[1]);
            if (with_gradient - without_gradient).abs() > DISAGREEMENT * standard_error {
                let parameter = name.to_owned();
                found.push(PosteriorWarning::Disagrees {
                    parameter,
                    is_deviation,
                    with_gradient,
                    without_gradient,
                    standard_error,
                });
            }
        }
    }
    found
}

/// Steps in whitened coordinates, as long and as correlated as the draws of another sampler.
#[derive(Debug)]
pub(super) struct Walk {
    /// Factor of the covariance of a step, lower half.
    factor: Vec<f64>,
}

impl Walk {
    /// Scales by the covariance of `positions`, of `order` coordinates each.
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

    /// Takes `steps` steps from a `start` with its ln p: all parameters of each step of the second half, one step after
    /// the other.
    pub(super) fn run<P: Residuals + ?Sized>(
        &self,
        target: &mut Target<'_, P>,
        whitening: &Whitening,
        (mut z, mut density): (Vec<f64>, f64),
        steps: usize,
        random: &mut ChaCha8Rng,
    ) -> Vec<f64> {
        let order = z.len();
        let mut values = target.values().to_vec();
        let mut walked = Vec::new();
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
            }
            if step >= steps / 2 {
                walked.extend_from_slice(&values);
            }
        }
        walked
    }
}
