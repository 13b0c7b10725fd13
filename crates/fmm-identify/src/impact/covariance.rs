//! Covariance of the estimates of blows: by noise, and by everything that is held.

use std::ops::Range;

use fmm_fit::{EvaluationError, Fit, PropagatedCovariance, Residuals, Sensitivity, autocorrelation_time};

use crate::impact::lines::Scratch;
use crate::impact::parameters::LOAD;
use crate::impact::{ImpactDomain, ImpactProblem, remainder};
use crate::residuals::correlation::{are_correlated, correlated_covariance};

/// What rounding makes of a noise-free velocity, relative to the largest.
const ROUNDING: f64 = 1e-9;

/// Covariance of the estimates of a fit of blows, by origin.
pub(crate) struct ImpactCovariance {
    count: usize,
    /// By the noise of the velocity.
    random: Random,
    /// How the estimates follow what was held, and its covariance.
    sensitivity: Option<Sensitivity>,
    inputs: Vec<f64>,
    propagated: Option<PropagatedCovariance>,
    /// Reason why the sensitivities of the estimates to fixed inputs are not known.
    pub(crate) unpropagated: Option<String>,
    /// Root mean square of the residuals, and of what remains of them when everything uncertain is allowed for (m/s).
    pub(crate) residual: f64,
    pub(crate) remainder: f64,
    /// Standard deviation of the noise (m/s).
    pub(crate) noise: f64,
}

/// Covariance of the estimates by the noise of the velocity.
struct Random {
    elements: Vec<Option<f64>>,
    degrees_of_freedom: f64,
    /// Factor by which correlated residuals widen the largest uncertainty over that of independent ones.
    inflation: f64,
}

impl ImpactCovariance {
    /// Of a `fit` of `problem`, whose forces share a calibration of relative uncertainty `calibration`.
    pub(crate) fn of(problem: ImpactProblem<'_>, fit: &Fit, calibration: f64) -> Result<Self, EvaluationError> {
        let count = fit.values().len();
        let measured = &fit.residuals()[..problem.measured()];
        let residual = (measured.iter().map(|r| r * r).sum::<f64>() / measured.len() as f64).sqrt();
        let random = Random::of(&problem, fit)?;
        let problem = problem.with_derivatives_by_inputs();
        let inputs = input_covariance(&problem, calibration);
        let remainder = remainder::of(&problem, fit, &inputs)?;
        let mut covariance = Self {
            count,
            random,
            sensitivity: None,
            propagated: None,
            unpropagated: None,
            residual,
            remainder,
            noise: problem.noise(),
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
    pub(crate) fn variances(&self, index: usize) -> Option<(f64, f64)> {
        let random = self.random.elements[index * self.count + index].filter(|_| self.is_known())?;
        let inputs = self.propagated.as_ref().and_then(|propagated| propagated.covariance(index, index));
        Some((random, random + inputs.unwrap_or(0.0)))
    }

    /// Degrees of freedom of the variances by noise.
    pub(crate) fn degrees_of_freedom(&self) -> f64 {
        self.random.degrees_of_freedom
    }

    /// Factor by which correlated residuals widen the largest uncertainty over that of independent ones.
    pub(crate) fn inflation(&self) -> f64 {
        self.random.inflation
    }

    /// Variance of the product of the normal load and parameter `index`, of `values`, if the load was held: by noise,
    /// and in all.
    pub(crate) fn variances_times_load(&self, index: usize, values: &[f64]) -> Option<(f64, f64)> {
        let load = values[LOAD];
        let random = load * load * self.variances(index)?.0;
        let mut variance = random;
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
        Some((random, variance.max(random)))
    }
}

impl Random {
    /// The fitted covariance as noise alone makes it, widened where neighbouring samples are alike.
    fn of(problem: &ImpactProblem<'_>, fit: &Fit) -> Result<Self, EvaluationError> {
        let count = fit.values().len();
        let independent = |i: usize, j: usize| fit.relaxed_covariance(i, j).or_else(|| fit.covariance(i, j));
        let mut random = Self {
            elements: (0..count * count).map(|element| independent(element / count, element % count)).collect(),
            degrees_of_freedom: fit.degrees_of_freedom() as f64,
            inflation: 1.0,
        };
        match problem.domain() {
            ImpactDomain::Both => random.elements = of_both(problem, fit)?,
            ImpactDomain::Mobility => (),
            ImpactDomain::Time => {
                let speed = problem.trials().iter().map(|trial| trial.summary().speed).fold(0.0, f64::max);
                let deviation = fit.residual_standard_deviation().unwrap_or(0.0);
                let time = autocorrelation_time(&fit.residuals()[..problem.measured()]).unwrap_or(1.0);
                if !(deviation > ROUNDING * speed && are_correlated(time)) {
                    return Ok(random);
                }
                let Some(correlated) = correlated_covariance(problem, fit, time, &series(problem))? else {
                    return Ok(random);
                };
                let ratio = |i: usize| Some((correlated.covariance(i, i)? / independent(i, i)?).max(1.0).sqrt());
                let ratios: Vec<f64> = (0..count).map(|i| ratio(i).unwrap_or(1.0)).collect();
                for (index, element) in random.elements.iter_mut().enumerate() {
                    *element = element.map(|covariance| covariance * ratios[index / count] * ratios[index % count]);
                }
                random.degrees_of_freedom = correlated.degrees_of_freedom().min(random.degrees_of_freedom);
                random.inflation = ratios.iter().copied().fold(1.0, f64::max);
            }
        }
        Ok(random)
    }
}

/// The residuals of each trial.
fn series(problem: &ImpactProblem<'_>) -> Vec<Range<usize>> {
    let of_trials = problem.blocks().iter().take(problem.trials().len());
    let ends = of_trials.scan(0, |end, block| {
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
/// that holds all that a parameter changes has L = BT and LᵀL = TᵀT, and V is that of the samples alone. σ² is the
/// larger of what samples and lines show, as a misfit shows least diluted in the lines. What is known of the pulses is
/// counted twice like the record, of which it is independent.
fn of_both(problem: &ImpactProblem<'_>, fit: &Fit) -> Result<Vec<Option<f64>>, EvaluationError> {
    let count = fit.values().len();
    let elements = problem.blocks().iter().map(|block| block.rows() * block.parameters().len()).sum();
    let mut jacobian = vec![0.0; elements];
    problem.evaluate(fit.values(), &mut vec![0.0; problem.len()], Some(&mut jacobian))?;
    let mut middle = vec![0.0; count * count];
    let mut scratch = Scratch::default();
    let (mut rest, mut row) = (jacobian.as_slice(), 0);
    // Sum of squares and number of samples and of lines.
    let mut sums = [(0.0, 0.0); 2];
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for (trial, block) in problem.blocks().iter().enumerate().take(problem.trials().len()) {
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
    let known = &problem.blocks()[problem.trials().len()..];
    for (block, columns) in known.iter().zip([rest]) {
        let columns = || block.parameters().iter().zip(columns.chunks_exact(block.rows().max(1)));
        for (&i, a) in columns() {
            for (&j, b) in columns() {
                middle[i * count + j] += problem.repeats() * dot(a, b);
            }
        }
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

/// Covariance of what is held, in the order of the parameters.
fn input_covariance(problem: &ImpactProblem<'_>, calibration: f64) -> Vec<f64> {
    let layout = problem.layout();
    let held: Vec<usize> = (0..layout.all.len()).filter(|index| layout.is_held(*index)).collect();
    // A calibration is common to all impulses that are held but not those whose gain is free.
    let is_calibrated = |index: usize| layout.is_impulse_error(index) && layout.uncertainties[index] > 0.0;
    let element = |&a: &usize, &b: &usize| {
        let own = if a == b { layout.uncertainties[a].powi(2) } else { 0.0 };
        own + if is_calibrated(a) && is_calibrated(b) { calibration * calibration } else { 0.0 }
    };
    held.iter().flat_map(|a| held.iter().map(move |b| element(a, b))).collect()
}
