//! What remains of the residuals when everything that is held is allowed to be as uncertain as it is.

use fmm_fit::{EvaluationError, Fit, Residuals};

use crate::banded::BandedFactor;
use crate::impact::ImpactProblem;

/// Root mean square (m/s) of what remains of the residuals r of `fit` when what is held moves as far as its covariance C =
/// Σ aₖ aₖᵀ explains, and what is found follows:
///
/// ```text
/// min over x of |r + Z x|² + σ² xᵀx = rᵀr − (Zᵀr)ᵀ (σ² 1 + ZᵀZ)⁻¹ Zᵀr,    Z = (1 − P) J_held A                (1)
/// ```
///
/// J_held are the derivatives by what is held, P projects on those by what was found, and σ is the noise. If noise and C are all
/// that is wrong, (1) is about σ² times the number of residuals, however far the held values are off within C; what a law leaves
/// out stays in it.
///
/// `problem` must give derivatives by what is held, and `inputs` is C, by rows.
pub(crate) fn of(problem: &ImpactProblem<'_>, fit: &Fit, inputs: &[f64]) -> Result<f64, EvaluationError> {
    let repeats = problem.repeats();
    let mean = |sum: f64| (sum.max(0.0) / problem.len() as f64).sqrt();
    let whole = fit.sum_of_squares();
    let layout = problem.layout();
    let held: Vec<usize> = (0..layout.all.len()).filter(|index| layout.is_held(*index)).collect();
    let sources = sources(inputs, &held, layout.all.len());
    if sources.is_empty() {
        return Ok(mean(whole));
    }
    let (normal, gradient) = products(problem, fit)?;
    let count = layout.all.len();
    let found: Vec<usize> = (0..count).filter(|&index| fit.unit_covariance(index, index).is_some()).collect();
    let times = |source: &[f64], j: usize| (0..count).map(|i| source[i] * normal[i * count + j]).sum::<f64>();
    // J_foundᵀ J_held aₖ, and what the found parameters make of it.
    let seen: Vec<Vec<f64>> = sources.iter().map(|a| found.iter().map(|&j| times(a, j)).collect()).collect();
    let following: Vec<Vec<f64>> = seen
        .iter()
        .map(|seen| {
            let moved = |&i: &usize| {
                found.iter().zip(seen).map(|(&j, seen)| fit.unit_covariance(i, j).unwrap_or(0.0) * seen).sum::<f64>()
            };
            found.iter().map(moved).collect()
        })
        .collect();
    // A record that is counted twice says twice as much of the same.
    let variance = repeats * problem.noise().powi(2);
    let element = |k: usize, l: usize| {
        let direct: f64 = (0..count).map(|j| times(&sources[k], j) * sources[l][j]).sum();
        let followed: f64 = seen[k].iter().zip(&following[l]).map(|(a, b)| a * b).sum();
        f64::from(u8::from(k == l)) + (direct - followed) / variance
    };
    let Some(factor) = BandedFactor::of(sources.len(), sources.len() - 1, element) else { return Ok(mean(whole)) };
    let right: Vec<f64> = sources
        .iter()
        .zip(&following)
        .map(|(source, following)| {
            let direct: f64 = source.iter().zip(&gradient).map(|(a, g)| a * g).sum();
            direct - found.iter().zip(following).map(|(&j, a)| a * gradient[j]).sum::<f64>()
        })
        .collect();
    let explained: f64 = factor.whiten(&right).iter().map(|part| part * part).sum();
    Ok(mean(whole - explained / variance))
}

/// Vectors aₖ over all `count` parameters with Σ aₖ aₖᵀ = C, the covariance `inputs` of those `held`: one for each that has an
/// uncertainty, by Cholesky's factor.
fn sources(inputs: &[f64], held: &[usize], count: usize) -> Vec<Vec<f64>> {
    let width = held.len();
    let uncertain: Vec<usize> = (0..width).filter(|&place| inputs[place * width + place] > 0.0).collect();
    let mut sources: Vec<Vec<f64>> = Vec::with_capacity(uncertain.len());
    for (number, &place) in uncertain.iter().enumerate() {
        let mut source = vec![0.0; count];
        let rest = |other: usize| {
            let known: f64 = sources[..number].iter().map(|a| a[held[place]] * a[held[other]]).sum();
            inputs[place * width + other] - known
        };
        let diagonal = rest(place);
        if diagonal > 0.0 {
            uncertain[number..].iter().for_each(|&other| source[held[other]] = rest(other) / diagonal.sqrt());
        }
        sources.push(source);
    }
    sources
}

/// JᵀJ by rows and Jᵀr over all parameters, held or not.
fn products(problem: &ImpactProblem<'_>, fit: &Fit) -> Result<(Vec<f64>, Vec<f64>), EvaluationError> {
    let count = fit.values().len();
    let elements = problem.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
    let mut jacobian = vec![0.0; elements];
    problem.jacobian(fit.values(), &mut jacobian)?;
    let (mut normal, mut gradient) = (vec![0.0; count * count], vec![0.0; count]);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut rest, mut residuals) = (jacobian.as_slice(), fit.residuals());
    for block in problem.blocks() {
        let (columns, further) = rest.split_at(block.rows() * block.parameters().len());
        let (own, others) = residuals.split_at(block.rows());
        let columns: Vec<(usize, &[f64])> =
            block.parameters().iter().copied().zip(columns.chunks_exact(block.rows())).collect();
        for &(i, a) in &columns {
            gradient[i] += dot(a, own);
            for &(j, b) in &columns {
                normal[i * count + j] += dot(a, b);
            }
        }
        (rest, residuals) = (further, others);
    }
    Ok((normal, gradient))
}
