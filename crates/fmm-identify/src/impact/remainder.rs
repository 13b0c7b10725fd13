//! Remainder of the residuals after everything uncertain that is held has been allowed for.

use std::ops::Range;

use fmm_fit::{EvaluationError, Fit, Residuals};

use crate::estimators::banded::BandedFactor;
use crate::impact::ImpactProblem;
use crate::impact::lines::Scratch;

/// Root mean square (m/s) of what remains of the residuals r of `fit` when what is held moves as far as its covariance
/// C = Σ aₖ aₖᵀ explains, and what is found follows:
///
/// ```text
/// min over x of |r + Z x|² + σ² xᵀx,    Z = (1 − P) J_held A:    x = −(σ² 1 + ZᵀZ)⁻¹ Zᵀr                    (1)
/// ```
///
/// J_held are the derivatives by what is held, P projects on those by what was found, and σ is the noise. If noise and
/// C are all that is wrong, (1) is about σ² times the number of residuals, however far the held values are off within
/// C; what a law leaves out stays in it. A slow misfit of a long record shows in the lines of the band rather than in
/// all samples, so that the larger of the two is taken.
///
/// `problem` must give derivatives by what is held, and `inputs` is C, by rows.
pub(crate) fn of(problem: &ImpactProblem<'_>, fit: &Fit, inputs: &[f64]) -> Result<f64, EvaluationError> {
    let mut remaining = fit.residuals().to_vec();
    // σ² xᵀx
    let penalty = allow_for(problem, fit, inputs, &mut remaining)?;
    let squares = |part: &[f64]| part.iter().map(|r| r * r).sum::<f64>();
    let all = ((squares(&remaining) + penalty) / problem.len() as f64).sqrt();
    let (mut sum, mut count) = (0.0, 0usize);
    let (mut scratch, mut lines) = (Scratch::default(), Vec::new());
    let mut rest = remaining.as_slice();
    for trial in 0..problem.trials().len() {
        let (samples, own_lines) = problem.rows(trial);
        let (own, others) = rest.split_at(samples + own_lines);
        rest = others;
        if own_lines > 0 {
            sum += squares(&own[samples..]);
            count += own_lines;
        } else {
            lines.resize(problem.lines(trial).rows(), 0.0);
            problem.lines(trial).transform(problem.trials()[trial].begin(), own, &mut scratch, &mut lines)?;
            sum += squares(&lines);
            count += lines.len();
        }
    }
    Ok(all.max((sum / count as f64).sqrt()))
}

/// Adds Z x of (1) to the residuals, and gives σ² xᵀx.
fn allow_for(
    problem: &ImpactProblem<'_>,
    fit: &Fit,
    inputs: &[f64],
    residuals: &mut [f64],
) -> Result<f64, EvaluationError> {
    let layout = problem.layout();
    let count = layout.all.len();
    let held: Vec<usize> = (0..count).filter(|index| layout.is_held(*index)).collect();
    let sources = sources(inputs, &held, count);
    if sources.is_empty() {
        return Ok(0.0);
    }
    let derivatives = Derivatives::of(problem, fit)?;
    let (normal, gradient) = derivatives.products(problem, fit.residuals());
    let found: Vec<usize> = (0..count).filter(|&index| fit.unit_covariance(index, index).is_some()).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // How everything moves with one standard uncertainty of a source: what is held by aₖ, and what is found after it.
    let seen_by = |a: &[f64], j: usize| (0..count).map(|i| a[i] * normal[i * count + j]).sum::<f64>();
    let moves: Vec<Vec<f64>> = sources
        .into_iter()
        .map(|source| {
            let seen: Vec<(usize, f64)> = found.iter().map(|&j| (j, seen_by(&source, j))).collect();
            let mut moved = source;
            for &i in &found {
                let terms = seen.iter().map(|&(j, seen)| fit.unit_covariance(i, j).unwrap_or(0.0) * seen);
                moved[i] -= terms.sum::<f64>();
            }
            moved
        })
        .collect();
    // A record that is counted twice says twice as much of the same.
    let variance = problem.repeats() * problem.noise().powi(2);
    let seen: Vec<Vec<f64>> = moves.iter().map(|a| (0..count).map(|j| seen_by(a, j)).collect()).collect();
    let element = |k: usize, l: usize| f64::from(u8::from(k == l)) + dot(&seen[k], &moves[l]) / variance;
    let Some(factor) = BandedFactor::of(moves.len(), moves.len() - 1, element) else { return Ok(0.0) };
    let right: Vec<f64> = moves.iter().map(|a| dot(a, &gradient) / variance).collect();
    let white = factor.whiten(&right);
    let mut unit = vec![0.0; moves.len()];
    let (mut shift, mut penalty) = (vec![0.0; count], 0.0);
    for (k, moved) in moves.iter().enumerate() {
        unit.fill(0.0);
        unit[k] = 1.0;
        let x = -dot(&factor.whiten(&unit), &white);
        penalty += variance * x * x;
        shift.iter_mut().zip(moved).for_each(|(shift, a)| *shift += x * a);
    }
    derivatives.add_change(problem, &shift, residuals);
    Ok(penalty)
}

/// Vectors aₖ over all `count` parameters with Σ aₖ aₖᵀ = C, the covariance `inputs` of those `held`: one for each that
/// has an uncertainty, by Cholesky's factor.
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

/// J, block by block, by all parameters, held or not.
struct Derivatives(Vec<f64>);

impl Derivatives {
    fn of(problem: &ImpactProblem<'_>, fit: &Fit) -> Result<Self, EvaluationError> {
        let elements = problem.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
        let mut jacobian = vec![0.0; elements];
        problem.evaluate(fit.values(), &mut vec![0.0; problem.len()], Some(&mut jacobian))?;
        Ok(Self(jacobian))
    }

    /// For each block its rows, and its columns with their parameters.
    fn blocks<'a>(
        &'a self,
        problem: &'a ImpactProblem<'_>,
    ) -> impl Iterator<Item = (Range<usize>, Vec<(usize, &'a [f64])>)> {
        let (mut rest, mut row) = (self.0.as_slice(), 0);
        problem.blocks().iter().map(move |block| {
            let (columns, further) = rest.split_at(block.rows() * block.parameters().len());
            rest = further;
            row += block.rows();
            let columns = block.parameters().iter().copied().zip(columns.chunks_exact(block.rows().max(1)));
            (row - block.rows()..row, columns.collect())
        })
    }

    /// JᵀJ by rows and Jᵀr.
    fn products(&self, problem: &ImpactProblem<'_>, residuals: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let count = problem.layout().all.len();
        let (mut normal, mut gradient) = (vec![0.0; count * count], vec![0.0; count]);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for (rows, columns) in self.blocks(problem) {
            for &(i, a) in &columns {
                gradient[i] += dot(a, &residuals[rows.clone()]);
                for &(j, b) in &columns {
                    normal[i * count + j] += dot(a, b);
                }
            }
        }
        (normal, gradient)
    }

    /// Adds J d to the residuals, for a change d of the parameters.
    fn add_change(&self, problem: &ImpactProblem<'_>, change: &[f64], residuals: &mut [f64]) {
        for (rows, columns) in self.blocks(problem) {
            for (j, column) in columns.into_iter().filter(|(j, _)| change[*j] != 0.0) {
                let own = residuals[rows.clone()].iter_mut().zip(column);
                own.for_each(|(residual, derivative)| *residual += change[j] * derivative);
            }
        }
    }
}
