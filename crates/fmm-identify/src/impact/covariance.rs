//! How uncertain what was found in blows is: by noise, and by everything that was held.

use std::ops::Range;

use fmm_fit::{
    Block, CorrelatedCovariance, EvaluationError, Fit, PropagatedCovariance, Residuals, Sensitivity,
    autocorrelation_time,
};
use fmm_sim::Simulated;

use crate::impact::lines::Scratch;
use crate::impact::parameters::LOAD;
use crate::impact::{ImpactDomain, ImpactProblem};

/// Neighbouring samples that tell more than this of each other are not independent,
const INDEPENDENT: f64 = 3.0;
/// windows of this many correlation times lose little of the correlation,
const WINDOW: f64 = 5.0;
/// and with this many of them the covariance is known to about a third.
const FEWEST_WINDOWS: usize = 8;
/// What rounding makes of a noise-free velocity, relative to the largest.
const ROUNDING: f64 = 1e-9;

/// Covariance of the estimates of a fit of blows, by origin.
pub(crate) struct ImpactCovariance {
    count: usize,
    degrees_of_freedom: f64,
    /// By the noise of the velocity.
    random: Vec<Option<f64>>,
    /// How the estimates follow what was held, and its covariance.
    sensitivity: Option<Sensitivity>,
    inputs: Vec<f64>,
    propagated: Option<PropagatedCovariance>,
    /// Why it is not known how the estimates follow what was held.
    pub(crate) unpropagated: Option<String>,
    /// Root mean square of the residuals, and what noise and the uncertainty of the impulses make of them (m/s).
    pub(crate) residual: f64,
    pub(crate) expected: f64,
    /// Factor by which correlated residuals widen the largest uncertainty over that of independent ones.
    pub(crate) inflation: f64,
}

impl ImpactCovariance {
    /// Of a `fit` of `problem`, whose forces share a calibration of relative uncertainty `calibration`.
    pub(crate) fn of<F: Simulated>(
        problem: ImpactProblem<'_, F>,
        fit: &Fit,
        calibration: f64,
    ) -> Result<Self, EvaluationError> {
        let count = fit.values().len();
        let residual = (fit.sum_of_squares() / fit.residuals().len() as f64).sqrt();
        let (random, inflation) = random(&problem, fit)?;
        let problem = problem.with_derivatives_by_inputs();
        let expected = expected_residual(&problem, fit)?;
        let inputs = input_covariance(&problem, calibration);
        let mut covariance = Self {
            count,
            degrees_of_freedom: fit.degrees_of_freedom() as f64,
            random,
            sensitivity: None,
            propagated: None,
            unpropagated: None,
            residual,
            expected,
            inflation,
            inputs,
        };
        if covariance.inputs.iter().any(|element| *element > 0.0) {
            let sensitivity = Sensitivity::first_order(&problem, fit);
            let propagated = sensitivity.and_then(|sensitivity| {
                let propagated = sensitivity.propagate(&covariance.inputs)?;
                Ok((sensitivity, propagated))
            });
            match propagated {
                Ok((sensitivity, propagated)) => {
                    (covariance.sensitivity, covariance.propagated) = (Some(sensitivity), Some(propagated));
                }
                Err(error) => covariance.unpropagated = Some(error.to_string()),
            }
        }
        Ok(covariance)
    }

    fn is_known(&self) -> bool {
        self.unpropagated.is_none()
    }

    /// Variance of the estimate of parameter `index`: by noise, and in all.
    fn variances(&self, index: usize) -> Option<(f64, f64)> {
        let random = self.random[index * self.count + index].filter(|_| self.is_known())?;
        let inputs = self.propagated.as_ref().and_then(|propagated| propagated.covariance(index, index));
        Some((random, random + inputs.unwrap_or(0.0)))
    }

    /// Standard uncertainty of parameter `index`.
    pub(crate) fn uncertainty(&self, index: usize) -> Option<f64> {
        self.variances(index).map(|(_, variance)| variance.sqrt())
    }

    /// Degrees of freedom of [`uncertainty`](Self::uncertainty) by Welch and Satterthwaite, that of the inputs being known
    /// (JCGM 100:2008, G.4.1).
    pub(crate) fn degrees_of_freedom(&self, index: usize) -> f64 {
        let ratio = self.variances(index).map_or(1.0, |(random, all)| if random > 0.0 { all / random } else { 1.0 });
        self.degrees_of_freedom * ratio * ratio
    }

    /// Standard uncertainty of the product of the normal load and parameter `index`, of `values`, if the load was held.
    pub(crate) fn uncertainty_times_load(&self, index: usize, values: &[f64]) -> Option<f64> {
        let (random, _) = self.variances(index)?;
        let load = values[LOAD];
        let mut variance = load * load * random;
        if let Some(sensitivity) = &self.sensitivity {
            let inputs = sensitivity.inputs();
            let slope = |input: usize| {
                let by_load = if input == LOAD { values[index] } else { 0.0 };
                Some(load * sensitivity.coefficient(index, input)? + by_load)
            };
            let slopes = inputs.iter().map(|&input| slope(input)).collect::<Option<Vec<f64>>>()?;
            for (row, a) in self.inputs.chunks_exact(inputs.len().max(1)).zip(&slopes) {
                variance += row.iter().zip(&slopes).map(|(element, b)| a * element * b).sum::<f64>();
            }
        }
        Some(variance.max(0.0).sqrt())
    }
}

/// The fitted covariance as noise alone makes it, and the widening for correlation.
fn random<F: Simulated>(problem: &ImpactProblem<'_, F>, fit: &Fit) -> Result<(Vec<Option<f64>>, f64), EvaluationError> {
    let count = fit.values().len();
    let independent = |i: usize, j: usize| fit.relaxed_covariance(i, j).or_else(|| fit.covariance(i, j));
    match problem.domain() {
        ImpactDomain::Both => return Ok((of_both(problem, fit)?, 1.0)),
        ImpactDomain::Mobility => (),
        ImpactDomain::Time => {
            let speed = problem.trials().iter().map(|trial| trial.summary().speed).fold(0.0, f64::max);
            let deviation = fit.residual_standard_deviation().unwrap_or(0.0);
            let time = autocorrelation_time(fit.residuals()).unwrap_or(1.0);
            if deviation > ROUNDING * speed && time > INDEPENDENT {
                let series = series(problem.blocks());
                let longest = series.iter().map(Range::len).min().unwrap_or(0) / FEWEST_WINDOWS;
                let span = ((WINDOW * time) as usize).min(longest).max(1);
                if let Some(correlated) = CorrelatedCovariance::of(problem, fit, span, &series)? {
                    let ratio = |i: usize| Some((correlated.covariance(i, i)? / independent(i, i)?).max(1.0).sqrt());
                    let ratios: Vec<f64> = (0..count).map(|i| ratio(i).unwrap_or(1.0)).collect();
                    let widened =
                        |e: usize| Some(independent(e / count, e % count)? * ratios[e / count] * ratios[e % count]);
                    let widest = ratios.iter().copied().fold(1.0, f64::max);
                    return Ok(((0..count * count).map(widened).collect(), widest));
                }
            }
        }
    }
    Ok(((0..count * count).map(|element| independent(element / count, element % count)).collect(), 1.0))
}

/// The residuals of each trial.
fn series(blocks: &[Block]) -> Vec<Range<usize>> {
    let ends = blocks.iter().scan(0, |end, block| {
        *end += block.rows();
        Some(*end - block.rows()..*end)
    });
    ends.collect()
}

/// Covariance of the estimates of a fit to samples and lines of the same record.
///
/// ```text
/// δθ = (JᵀJ)⁻¹ (Tᵀe + Lᵀ B e),   J = [T; L],   B Bᵀ = 1:     V = σ² (JᵀJ)⁻¹ (TᵀT + LᵀBT + TᵀBᵀL + LᵀL) (JᵀJ)⁻¹
/// ```
///
/// T and L are the derivatives of samples and lines, and B makes lines of samples; e is white noise. A band
/// that holds all that a parameter changes has L = BT and LᵀL = TᵀT, and V is that of the samples alone. σ² is the larger of what
/// samples and lines show, as a misfit shows least diluted in the lines.
fn of_both<F: Simulated>(problem: &ImpactProblem<'_, F>, fit: &Fit) -> Result<Vec<Option<f64>>, EvaluationError> {
    let count = fit.values().len();
    let elements = problem.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
    let mut jacobian = vec![0.0; elements];
    problem.jacobian(fit.values(), &mut jacobian)?;
    let mut middle = vec![0.0; count * count];
    let mut scratch = Scratch::default();
    let (mut rest, mut row) = (jacobian.as_slice(), 0);
    // Sum of squares and number of samples and of lines.
    let mut sums = [(0.0, 0.0); 2];
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for (trial, block) in problem.blocks().iter().enumerate() {
        let (samples, lines) = problem.rows(trial);
        let (columns, further) = rest.split_at(block.rows() * block.parameters().len());
        let of_samples = columns.chunks_exact(block.rows());
        let seen = of_samples.map(|column| {
            let mut rows = vec![0.0; lines];
            let begin = problem.trials()[trial].begin();
            problem.lines(trial).transform(begin, &column[..samples], &mut scratch, &mut rows)?;
            Ok::<_, EvaluationError>((column, rows))
        });
        let seen = seen.collect::<Result<Vec<_>, _>>()?;
        for ((a, b_a), &i) in seen.iter().zip(block.parameters()) {
            for ((b, b_b), &j) in seen.iter().zip(block.parameters()) {
                middle[i * count + j] += dot(a, b) + dot(&a[samples..], b_b) + dot(b_a, &b[samples..]);
            }
        }
        let own = &fit.residuals()[row..row + block.rows()];
        for ((sum, number), part) in sums.iter_mut().zip([&own[..samples], &own[samples..]]) {
            (*sum, *number) = (*sum + dot(part, part), *number + part.len() as f64);
        }
        row += block.rows();
        rest = further;
    }
    let rank = fit.rank() as f64;
    let variance = sums.map(|(sum, number)| sum / (number - rank).max(1.0)).into_iter().fold(0.0, f64::max);
    let unit = |i: usize, j: usize| fit.unit_covariance(i, j);
    let product = |element: usize| {
        let (i, j) = (element / count, element % count);
        // None where an estimate is not determined.
        unit(i, j)?;
        let mut sum = 0.0;
        for a in 0..count {
            let Some(left) = unit(i, a) else { continue };
            for b in 0..count {
                sum += left * middle[a * count + b] * unit(b, j).unwrap_or(0.0);
            }
        }
        Some(variance * sum)
    };
    Ok((0..count * count).map(product).collect())
}

/// Root mean square of the residuals (m/s) that the noise of the velocity and the uncertainty of each impulse bring about.
fn expected_residual<F: Simulated>(problem: &ImpactProblem<'_, F>, fit: &Fit) -> Result<f64, EvaluationError> {
    let elements = problem.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
    let mut jacobian = vec![0.0; elements];
    problem.jacobian(fit.values(), &mut jacobian)?;
    let (mut sum, mut rest) = (0.0, jacobian.as_slice());
    for (trial, block) in problem.blocks().iter().enumerate() {
        let (columns, further) = rest.split_at(block.rows() * block.parameters().len());
        let index = problem.layout().gain(trial);
        let known = problem.known(index).filter(|_| problem.layout().is_held(index));
        let u = known.map_or(0.0, |known| known.uncertainty());
        let of_gain = &columns[(block.parameters().len() - 2) * block.rows()..][..block.rows()];
        let noise = problem.trials()[trial].summary().velocity_noise;
        sum += block.rows() as f64 * noise * noise + of_gain.iter().map(|d| (d * u).powi(2)).sum::<f64>();
        rest = further;
    }
    let speed = problem.trials().iter().map(|trial| trial.summary().speed).fold(0.0, f64::max);
    Ok((sum / problem.len() as f64).sqrt().max(ROUNDING * speed))
}

/// Covariance of what is held, in the order of the parameters.
fn input_covariance<F: Simulated>(problem: &ImpactProblem<'_, F>, calibration: f64) -> Vec<f64> {
    let layout = problem.layout();
    let held: Vec<usize> = (0..layout.all.len()).filter(|index| layout.is_held(*index)).collect();
    let is_gain = |index: usize| index >= layout.shared && (index - layout.shared).is_multiple_of(2);
    let element = |&a: &usize, &b: &usize| {
        let own = if a == b { layout.uncertainties[a].powi(2) } else { 0.0 };
        own + if is_gain(a) && is_gain(b) { calibration * calibration } else { 0.0 }
    };
    held.iter().flat_map(|a| held.iter().map(move |b| element(a, b))).collect()
}
