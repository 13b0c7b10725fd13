//! Correlated residuals, against quadrature.

use fmm_fit::posterior::Sampler;
use fmm_fit::{Block, Derivatives, EvaluationError, Parameter, Residuals};

use crate::problems::{assert_moments, fitted, moments_by_quadrature};

/// One level under two series of autoregressive noise.
struct Level {
    data: Vec<f64>,
    blocks: [Block; 2],
    parameters: [Parameter; 1],
}

impl Residuals for Level {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.data.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        residuals.iter_mut().zip(&self.data).for_each(|(r, y)| *r = p[0] - y);
        if let Some(jacobian) = jacobian {
            jacobian.fill(1.0);
        }
        Ok(())
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::Free
    }
    fn blocks(&self) -> &[Block] {
        &self.blocks
    }
}

/// ln p(μ, ρ) = −n/2 ln Q + b/2 ln(1 − ρ²), with the determinant and the form of an autoregressive covariance written
/// out.
#[test]
fn level_and_correlation_are_those_of_quadrature() {
    let lengths = [40, 25];
    let mut data = Vec::new();
    for length in lengths {
        let mut noise = 0.0;
        for i in 0..length {
            noise = 0.6 * noise + (f64::from(i * i) * 0.618_033_988_75 + f64::from(length) * 0.3).fract() - 0.5;
            data.push(3.0 + noise);
        }
    }
    let problem = Level {
        data: data.clone(),
        blocks: lengths.map(|rows| Block::new(rows as usize, [0])),
        parameters: [Parameter::from("level")],
    };
    let log_density = |[level, rho]: [f64; 2]| {
        let form = |series: &[f64]| {
            let first = (1.0 - rho * rho) * (series[0] - level).powi(2);
            let innovation = |pair: &[f64]| (pair[1] - level - rho * (pair[0] - level)).powi(2);
            first + series.windows(2).map(innovation).sum::<f64>()
        };
        let all = form(&data[..40]) + form(&data[40..]);
        -0.5 * data.len() as f64 * all.ln() + (1.0 - rho * rho).ln()
    };
    let exact = moments_by_quadrature([(1.5, 4.5), (-0.999, 0.999)], log_density);
    let fit = fitted(&problem, &[2.0]);
    let posterior = Sampler::default().with_correlated_residuals().with_draws(4000).sample(&problem, &fit).unwrap();
    assert!(posterior.warnings().is_empty(), "{posterior}");
    assert_moments(posterior.marginal("level").unwrap(), exact[0]);
    assert_moments(posterior.marginal("residual_correlation").unwrap(), exact[1]);
    let independent = Sampler::default().sample(&problem, &fit).unwrap();
    let [with, without] = [&posterior, &independent].map(|p| p.marginal("level").unwrap().standard_deviation());
    assert!((with - without).abs() > 0.1 * without, "correlation counts: {with} and {without}");
}
