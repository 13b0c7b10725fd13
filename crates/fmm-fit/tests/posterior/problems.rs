//! Linear problems, and moments by quadrature.

use fmm_fit::posterior::Marginal;
use fmm_fit::{Derivatives, EvaluationError, Fit, Options, Parameter, Residuals, solve};

/// Residuals Σⱼ aᵢⱼ θⱼ − yᵢ.
pub(crate) struct Linear {
    pub(crate) columns: Vec<Vec<f64>>,
    pub(crate) data: Vec<f64>,
    pub(crate) parameters: Vec<Parameter>,
}

impl Residuals for Linear {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.data.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        for (i, r) in residuals.iter_mut().enumerate() {
            *r = self.columns.iter().zip(p).map(|(column, p)| column[i] * p).sum::<f64>() - self.data[i];
        }
        if let Some(jacobian) = jacobian {
            jacobian.copy_from_slice(&self.columns.concat());
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
}

/// NIST's Norris data (StRD, linear regression, lower level of difficulty), thinned to every third point.
pub(crate) fn line() -> Linear {
    let x = [0.2, 118.2, 228.1, 0.3, 997.0, 9.2, 116.7, 118.1, 557.6, 883.8, 0.4, 668.8];
    let y = [0.1, 118.1, 228.1, 0.3, 998.5, 9.2, 116.9, 117.4, 558.2, 887.6, 0.3, 669.9];
    Linear {
        columns: vec![vec![1.0; x.len()], x.to_vec()],
        data: y.to_vec(),
        parameters: vec![Parameter::from("intercept"), Parameter::from("slope")],
    }
}

pub(crate) fn fitted<P: Residuals>(problem: &P, start: &[f64]) -> Fit {
    let fit = solve(problem, start, &Options::default()).unwrap();
    assert!(fit.outcome().is_success(), "{fit}");
    fit
}

/// Means and standard deviations of two variables whose log density is given, by the midpoint rule on a grid over the
/// box `ranges`; a density that is smooth inside, and zero or cut at the edges, is integrated to far more digits than a
/// sampler has.
pub(crate) fn moments_by_quadrature(ranges: [(f64, f64); 2], log_density: impl Fn([f64; 2]) -> f64) -> [(f64, f64); 2] {
    const POINTS: usize = 400;
    let at = |(low, high): (f64, f64), i: usize| low + (high - low) * (i as f64 + 0.5) / POINTS as f64;
    let mut points = Vec::with_capacity(POINTS * POINTS);
    for i in 0..POINTS {
        for j in 0..POINTS {
            let point = [at(ranges[0], i), at(ranges[1], j)];
            points.push((point, log_density(point)));
        }
    }
    let largest = points.iter().map(|(_, density)| *density).fold(f64::NEG_INFINITY, f64::max);
    let mut sums = [0.0; 5];
    for ([x, y], density) in points {
        let weight = (density - largest).exp();
        for (sum, term) in sums.iter_mut().zip([1.0, x, y, x * x, y * y]) {
            *sum += weight * term;
        }
    }
    let moments = |first: f64, second: f64| {
        let mean = first / sums[0];
        (mean, (second / sums[0] - mean * mean).sqrt())
    };
    [moments(sums[1], sums[3]), moments(sums[2], sums[4])]
}

/// Fails unless mean and standard deviation are within four Monte Carlo standard errors, which one right result in 16
/// 000 exceeds.
pub(crate) fn assert_moments(marginal: &Marginal, (mean, deviation): (f64, f64)) {
    let name = marginal.parameter().name();
    let (by_draws, error) = (marginal.mean(), marginal.error_of_mean());
    assert!((by_draws - mean).abs() < 4.0 * error, "mean of {name}: {by_draws} ± {error} for {mean}");
    let (by_draws, error) = (marginal.standard_deviation(), marginal.error_of_deviation());
    assert!((by_draws - deviation).abs() < 4.0 * error, "deviation of {name}: {by_draws} ± {error} for {deviation}");
}
